// Numbers of a case that have a tolerance or a fit.
#pragma once

#include "casefile/entries.h"
#include "casefile/quantity.h"

// Whether a key's number, or each number of its vector, may have a tolerance: those that a drawing,
// a data sheet or a measurement gives one for.
bool tolerance_is_of(const SchemaRow *row);

// A number with its tolerance, all in its unit.
typedef struct Tolerated {
    bool is_there; // it has one; else nothing below is set
    double nominal;
    double lower; // as deviations from it: 0 or below
    double upper; // 0 or above
    char unit[UNITS_NAME_SIZE];
} Tolerated;

// Reads the tolerance or fit of a row's value.
bool tolerance_read(const SchemaRow *row, const char *text, Tolerated *tolerated,
                    Complaint *complaint);

// The node of an entry's value without tolerances, for tolerance_plain_free.
typedef struct PlainNode {
    const Node *node; // the entry's own where none of its numbers has a tolerance
    Node scalar;
    Node items[3];
    char texts[3][QUANTITY_TEXT_SIZE];
} PlainNode;

// Takes the tolerances of an entry into the scenario, and finds what is left of its value. The row
// is the entry's as the value's unit asks for it. Fails on a wrong tolerance.
bool tolerance_take(const Entry *entry, const SchemaRow *row, Scenario *scenario, PlainNode *plain,
                    Err *err);
