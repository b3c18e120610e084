// The factors from SI to the units that people read.
#include "write/units.h"

#include <stddef.h>
#include <string.h>

double units_per_si(const char *unit)
{
    static const struct {
        const char *word;
        const double *per_si;
    } UNITS[] = {
        {"deg", &UNITS_DEG}, {"rpm", &UNITS_RPM},   {"mm", &UNITS_MM},
        {"mm/s", &UNITS_MM}, {"um", &UNITS_UM},     {"ms", &UNITS_MS},
        {"us", &UNITS_US},   {"%", &UNITS_PERCENT}, {"mrad", &UNITS_MRAD},
    };
    for (size_t i = 0; unit != NULL && i < sizeof UNITS / sizeof *UNITS; i++) {
        if (strcmp(unit, UNITS[i].word) == 0) {
            return *UNITS[i].per_si;
        }
    }
    return 1.0;
}
