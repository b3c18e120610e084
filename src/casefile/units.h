// The units a case file may use, and the one place where they become SI.
#pragma once

#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

enum { UNITS_NAME_SIZE = 32 };

typedef enum Dimension {
    DIMENSION_NONE, // a plain number
    DIMENSION_LENGTH,
    DIMENSION_MASS,
    DIMENSION_INERTIA,
    DIMENSION_ANGULAR_SPEED,
    DIMENSION_ANGLE,
    DIMENSION_TIME,
    DIMENSION_ACCELERATION,
    DIMENSION_SPEED,
    DIMENSION_PRESSURE,
    DIMENSION_DAMPING,
    DIMENSION_MEMORY,
    DIMENSION_FORCE,
    DIMENSION_IMPULSE,
    DIMENSION_ANGULAR_IMPULSE,
    DIMENSION_ENERGY,
    DIMENSION_ANGULAR_ACCELERATION,
    DIMENSION_SPRING, // of a spring along a line
    DIMENSION_TORQUE,
    DIMENSION_TORSION_SPRING,
    DIMENSION_TORSION_DAMPING,
    DIMENSION_STIFFNESS, // N/m^n; read by quantity_stiffness, listed here for its words only
    DIMENSION_COUNT,
} Dimension;

// One unit: a value in it times numerator / denominator is the value in SI. Kept as a fraction so
// that 279.4 mm becomes the number nearest to 0.2794 and not its neighbour.
typedef struct Unit {
    const char *name;
    Dimension dimension;
    double numerator;
    double denominator;
} Unit;

// "a length", "an inertia": with its article.
const char *units_dimension_name(Dimension dimension);

// A value as a case would give it, such as "254 mm".
const char *units_example(Dimension dimension);

// The SI unit, such as "m"; empty for a plain number.
const char *units_si(Dimension dimension);

// Brings a unit into the table's spelling: blanks and dots to single spaces, the micro sign to u,
// a raised 2 to ^2. Cut where it is longer than the buffer of UNITS_NAME_SIZE.
void units_normalise(const char *text, char *name);

// The unit of that (normalised) name: of the dimension wanted if it has one, else of any other;
// NULL where no dimension knows it.
const Unit *units_find(Dimension wanted, const char *name);

// The unit of the dimension whose name is nearest, or NULL.
const char *units_nearest(Dimension dimension, const char *name);

// Appends the units of a dimension: "m, mm, um".
void units_list(Dimension dimension, Text *text);
