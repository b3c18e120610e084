// Has the units that a case file knows, with their sizes in SI.
#include "casefile/units.h"

#include <math.h>
#include <string.h>

typedef struct DimensionWords {
    const char *name;
    const char *example;
    const char *si;
} DimensionWords;

#define UNITS_WORDS(id, name, example, si) {name, example, si},
static const DimensionWords DIMENSIONS[] = {UNITS_DIMENSION_LIST(UNITS_WORDS)};

// clang-format off
// of two units equally near to a wrong one, the first is suggested
static const Unit UNITS[] = {
    {"mm",      DIMENSION_LENGTH,        1.0,    1e3},
    {"m",       DIMENSION_LENGTH,        1.0,    1.0},
    {"um",      DIMENSION_LENGTH,        1.0,    1e6},
    {"micron",  DIMENSION_LENGTH,        1.0,    1e6},
    {"cm",      DIMENSION_LENGTH,        1.0,    1e2},
    {"in",      DIMENSION_LENGTH,        25.4,   1e3},
    {"kg",      DIMENSION_MASS,          1.0,    1.0},
    {"g",       DIMENSION_MASS,          1.0,    1e3},
    {"kg mm^2", DIMENSION_INERTIA,       1.0,    1e6},
    {"kg m^2",  DIMENSION_INERTIA,       1.0,    1.0},
    {"g mm^2",  DIMENSION_INERTIA,       1.0,    1e9},
    {"rpm",     DIMENSION_ANGULAR_SPEED, M_PI,   30.0},
    {"rad/s",   DIMENSION_ANGULAR_SPEED, 1.0,    1.0},
    {"deg/s",   DIMENSION_ANGULAR_SPEED, M_PI,   180.0},
    {"Hz",      DIMENSION_FREQUENCY,     1.0,    1.0},
    {"kHz",     DIMENSION_FREQUENCY,     1e3,    1.0},
    {"rpm",     DIMENSION_FREQUENCY,     1.0,    60.0},
    {"deg",     DIMENSION_ANGLE,         M_PI,   180.0},
    {"rad",     DIMENSION_ANGLE,         1.0,    1.0},
    {"mrad",    DIMENSION_ANGLE,         1.0,    1e3},
    {"s",       DIMENSION_TIME,          1.0,    1.0},
    {"ms",      DIMENSION_TIME,          1.0,    1e3},
    {"us",      DIMENSION_TIME,          1.0,    1e6},
    {"ns",      DIMENSION_TIME,          1.0,    1e9},
    {"m/s^2",   DIMENSION_ACCELERATION,  1.0,    1.0},
    {"mm/s^2",  DIMENSION_ACCELERATION,  1.0,    1e3},
    {"m/s",     DIMENSION_SPEED,         1.0,    1.0},
    {"mm/s",    DIMENSION_SPEED,         1.0,    1e3},
    {"Pa",      DIMENSION_PRESSURE,      1.0,    1.0},
    {"MPa",     DIMENSION_PRESSURE,      1e6,    1.0},
    {"Pa m/s",  DIMENSION_PRESSURE_SPEED, 1.0,   1.0},
    {"MPa m/s", DIMENSION_PRESSURE_SPEED, 1e6,   1.0},
    {"GPa",     DIMENSION_PRESSURE,      1e9,    1.0},
    {"N/mm^2",  DIMENSION_PRESSURE,      1e6,    1.0},
    {"kPa",     DIMENSION_PRESSURE,      1e3,    1.0},
    {"bar",     DIMENSION_PRESSURE,      1e5,    1.0},
    {"m^2",     DIMENSION_AREA,          1.0,    1.0},
    {"cm^2",    DIMENSION_AREA,          1.0,    1e4},
    {"mm^2",    DIMENSION_AREA,          1.0,    1e6},
    {"N s/m",   DIMENSION_DAMPING,       1.0,    1.0},
    {"N s/mm",  DIMENSION_DAMPING,       1e3,    1.0},
    {"s/m",     DIMENSION_DISSIPATION,   1.0,    1.0},
    {"s/mm",    DIMENSION_DISSIPATION,   1e3,    1.0},
    {"GB",      DIMENSION_MEMORY,        1e9,    1.0},
    {"MB",      DIMENSION_MEMORY,        1e6,    1.0},
    {"kB",      DIMENSION_MEMORY,        1e3,    1.0},
    {"B",       DIMENSION_MEMORY,        1.0,    1.0},
    {"N",       DIMENSION_FORCE,         1.0,    1.0},
    {"kN",      DIMENSION_FORCE,         1e3,    1.0},
    {"MN",      DIMENSION_FORCE,         1e6,    1.0},
    {"mN",      DIMENSION_FORCE,         1.0,    1e3},
    {"N s",     DIMENSION_IMPULSE,       1.0,    1.0},
    {"mN s",    DIMENSION_IMPULSE,       1.0,    1e3},
    {"N m s",   DIMENSION_ANGULAR_IMPULSE, 1.0,  1.0},
    {"mN m s",  DIMENSION_ANGULAR_IMPULSE, 1.0,  1e3},
    {"J",       DIMENSION_ENERGY,        1.0,    1.0},
    {"kJ",      DIMENSION_ENERGY,        1e3,    1.0},
    {"mJ",      DIMENSION_ENERGY,        1.0,    1e3},
    {"rad/s^2", DIMENSION_ANGULAR_ACCELERATION, 1.0, 1.0},
    {"deg/s^2", DIMENSION_ANGULAR_ACCELERATION, M_PI, 180.0},
    {"N/m",     DIMENSION_SPRING,        1.0,    1.0},
    {"N/mm",    DIMENSION_SPRING,        1e3,    1.0},
    {"kN/m",    DIMENSION_SPRING,        1e3,    1.0},
    {"N m",     DIMENSION_TORQUE,        1.0,    1.0},
    {"kN m",    DIMENSION_TORQUE,        1e3,    1.0},
    {"mN m",    DIMENSION_TORQUE,        1.0,    1e3},
    {"N mm",    DIMENSION_TORQUE,        1.0,    1e3},
    {"N m/rad", DIMENSION_TORSION_SPRING, 1.0,   1.0},
    {"N mm/rad", DIMENSION_TORSION_SPRING, 1.0,  1e3},
    {"N m/deg", DIMENSION_TORSION_SPRING, 180.0, M_PI},
    {"N m s/rad", DIMENSION_TORSION_DAMPING, 1.0, 1.0},
    {"N mm s/rad", DIMENSION_TORSION_DAMPING, 1.0, 1e3},
    {"s/rad", DIMENSION_TORSION_DISSIPATION, 1.0, 1.0},
    {"s/deg", DIMENSION_TORSION_DISSIPATION, 180.0, M_PI},
    {"N/m^n",   DIMENSION_STIFFNESS,     1.0,    1.0},
    {"N/mm^n",  DIMENSION_STIFFNESS,     1.0,    1.0},
    {"N/m",     DIMENSION_STIFFNESS,     1.0,    1.0},
    {"N/mm",    DIMENSION_STIFFNESS,     1e3,    1.0},
};
// clang-format on

enum { UNIT_COUNT = sizeof UNITS / sizeof UNITS[0] };

// Spellings that mean the same; the second is the table's.
static const char *const SPELLINGS[][2] = {
    {"\u00b5", "u"}, {"\u03bc", "u"}, {"\u00b2", "^2"}, {"\u00b7", " "}, {"*", " "}, {"\t", " "},
};

enum { SPELLING_COUNT = sizeof SPELLINGS / sizeof SPELLINGS[0] };

const char *units_dimension_name(Dimension dimension)
{
    return DIMENSIONS[dimension].name;
}

const char *units_example(Dimension dimension)
{
    return DIMENSIONS[dimension].example;
}

const char *units_si(Dimension dimension)
{
    return DIMENSIONS[dimension].si;
}

// What stands for the first character of the text, and how many bytes it replaces.
static const char *spell(const char *text, size_t *taken)
{
    for (size_t i = 0; i < SPELLING_COUNT; i++) {
        const size_t length = strlen(SPELLINGS[i][0]);
        if (strncmp(text, SPELLINGS[i][0], length) == 0) {
            *taken = length;
            return SPELLINGS[i][1];
        }
    }
    *taken = 1;
    return NULL;
}

void units_normalise(const char *text, char *name)
{
    size_t length = 0;
    while (*text != '\0' && length + 3 < UNITS_NAME_SIZE) {
        size_t taken;
        const char *spelled = spell(text, &taken);
        const char *piece = spelled != NULL ? spelled : text;
        const size_t piece_length = spelled != NULL ? strlen(spelled) : 1;
        // blanks at the front and behind another blank say nothing
        if (!(piece[0] == ' ' && (length == 0 || name[length - 1] == ' '))) {
            memcpy(name + length, piece, piece_length);
            length += piece_length;
        }
        text += taken;
    }
    while (length > 0 && name[length - 1] == ' ') {
        length--;
    }
    name[length] = '\0';
}

const Unit *units_find(Dimension wanted, const char *name)
{
    const Unit *found = NULL;
    for (size_t i = 0; i < UNIT_COUNT; i++) {
        if (strcmp(UNITS[i].name, name) != 0) {
            continue;
        }
        if (UNITS[i].dimension == wanted) {
            return &UNITS[i];
        }
        found = &UNITS[i];
    }
    return found;
}

const char *units_nearest(Dimension dimension, const char *name)
{
    const char *choices[UNIT_COUNT];
    size_t count = 0;
    for (size_t i = 0; i < UNIT_COUNT; i++) {
        if (UNITS[i].dimension == dimension) {
            choices[count++] = UNITS[i].name;
        }
    }
    // a unit is short: one slip is a third of three letters, and half of two
    const char *best = text_nearest(name, choices, count);
    for (size_t i = 0; i < count && best == NULL; i++) {
        if (strlen(name) > 1 && text_distance(name, choices[i]) == 1) {
            best = choices[i];
        }
    }
    return best;
}

void units_list(Dimension dimension, Text *text)
{
    const char *separator = "";
    for (size_t i = 0; i < UNIT_COUNT; i++) {
        if (UNITS[i].dimension == dimension) {
            text_append(text, "%s%s", separator, UNITS[i].name);
            separator = ", ";
        }
    }
}
