// The units a case file may use, and the one place where they become SI.
#pragma once

#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

enum { UNITS_NAME_SIZE = 32 };

// What a number of a case can be: a line a dimension, its enumerator, its name with its article, a
// value as a case would give it, and the SI unit, which units.c has with others in its table.
//
// A spring is one along a line; a stiffness is of any law, N/m^n, is read by quantity_stiffness and
// listed for its words only.
// clang-format off
#define UNITS_DIMENSION_LIST(member) \
    member(DIMENSION_NONE, "a plain number", "0.9", "") \
    member(DIMENSION_LENGTH, "a length", "254 mm", "m") \
    member(DIMENSION_MASS, "a mass", "0.29 kg", "kg") \
    member(DIMENSION_INERTIA, "a moment of inertia", "173.92 kg mm^2", "kg m^2") \
    member(DIMENSION_ANGULAR_SPEED, "an angular speed", "1000 rpm", "rad/s") \
    member(DIMENSION_FREQUENCY, "a frequency", "50 Hz", "Hz") \
    member(DIMENSION_ANGLE, "an angle", "30 deg", "rad") \
    member(DIMENSION_TIME, "a time", "1 us", "s") \
    member(DIMENSION_ACCELERATION, "an acceleration", "9.80665 m/s^2", "m/s^2") \
    member(DIMENSION_SPEED, "a speed", "1 mm/s", "m/s") \
    member(DIMENSION_PRESSURE, "a pressure", "207 GPa", "Pa") \
    member(DIMENSION_PRESSURE_SPEED, "a pressure times a speed", "0.5 MPa m/s", "Pa m/s") \
    member(DIMENSION_AREA, "an area", "12.6 cm^2", "m^2") \
    member(DIMENSION_DAMPING, "a damping coefficient", "973.33 N s/mm", "N s/m") \
    member(DIMENSION_DISSIPATION, "a dissipation", "0.3 s/m", "s/m") \
    member(DIMENSION_MEMORY, "an amount of memory", "2 GB", "B") \
    member(DIMENSION_FORCE, "a force", "1.2 kN", "N") \
    member(DIMENSION_IMPULSE, "an impulse", "0.2 N s", "N s") \
    member(DIMENSION_ANGULAR_IMPULSE, "an angular impulse", "0.01 N m s", "N m s") \
    member(DIMENSION_ENERGY, "an energy", "0.5 J", "J") \
    member(DIMENSION_ANGULAR_ACCELERATION, "an angular acceleration", "7574 rad/s^2", "rad/s^2") \
    member(DIMENSION_SPRING, "a stiffness", "4.5 N/mm", "N/m") \
    member(DIMENSION_TORQUE, "a torque", "0.1 N m", "N m") \
    member(DIMENSION_TORSION_SPRING, "a torsional stiffness", "0.5 N m/rad", "N m/rad") \
    member(DIMENSION_TORSION_DAMPING, "a torsional damping", "1 N mm s/rad", "N m s/rad") \
    member(DIMENSION_TORSION_DISSIPATION, "a dissipation of an angle", "0.3 s/rad", "s/rad") \
    member(DIMENSION_STIFFNESS, "a stiffness", "6.6e10 N/m^1.5", "N/m^n")
// clang-format on
#define UNITS_DIMENSION(id, ...) id,
typedef enum Dimension { UNITS_DIMENSION_LIST(UNITS_DIMENSION) DIMENSION_COUNT } Dimension;

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
