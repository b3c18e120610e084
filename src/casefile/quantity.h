// Numbers, and numbers with units, as a case file writes them.
#pragma once

#include "casefile/units.h"

#include <stdbool.h>
#include <stddef.h>

enum { QUANTITY_TEXT_SIZE = 256 };

// What is wrong with a value, and what would be right. It has no place yet: whoever knows the
// node adds file, line and column.
typedef struct Complaint {
    char text[QUANTITY_TEXT_SIZE];
    char allowed[QUANTITY_TEXT_SIZE]; // empty where the text says it already
} Complaint;

// A decimal number and nothing else: no unit, no hexadecimal, no nan, no inf. All functions here
// leave their results untouched on failure and then fill the complaint.
bool quantity_number(const char *text, double *value, Complaint *complaint);

// A whole number from 0 to 2^53; 1e6 is one.
bool quantity_integer(const char *text, size_t *value, Complaint *complaint);

// A number with a unit of the dimension, in SI. DIMENSION_NONE takes a plain number.
bool quantity_parse(const char *text, Dimension dimension, double *si, Complaint *complaint);

// The same, and the unit that it was written with, which lives forever; NULL for a plain number.
bool quantity_parse_unit(const char *text, Dimension dimension, double *si, const Unit **unit,
                         Complaint *complaint);

// A number that is written with a tolerance, in parts: `12.08 +- 0.02 mm` is 12.08 in mm, with
// limits of 0.02 and -0.02 in mm. A unit that is missing in front is that of the tolerance.
typedef struct QuantityCut {
    bool is_there;                       // it has a tolerance; else nothing below is set
    double nominal;                      // of its unit
    double lower;                        // of the unit of the limits, or in percent; 0 or below
    double upper;                        // 0 or above
    bool is_percent;                     // limits in percent of the number
    char unit[QUANTITY_TEXT_SIZE];       // as it is written; empty of a plain number
    char limit_unit[QUANTITY_TEXT_SIZE]; // likewise
} QuantityCut;

// Cuts the tolerance off a number of the dimension. Of the units it is looked alone whether they
// are there.
bool quantity_cut(const char *text, Dimension dimension, QuantityCut *cut, Complaint *complaint);

// A stiffness and the exponent n that its unit gives (1 to 3): in N/m^n or N/mm^n of
// DIMENSION_STIFFNESS, in N m/rad^n of DIMENSION_TORSION_SPRING.
bool quantity_stiffness(const char *text, Dimension dimension, double *stiffness, double *exponent,
                        Complaint *complaint);

// A time, or `1 revolution`, `2.5 revolutions`: then the number is that of turns.
bool quantity_span(const char *text, double *span, bool *is_in_turns, Complaint *complaint);
