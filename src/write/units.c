// The factors from SI to the units that people read.
#include "write/units.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
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

void units_append(Text *text, double value, const char *unit)
{
    static const char *const PREFIXES[] = {"p", "n", "u", "m", "", "k", "M", "G", "T"};
    enum { NONE = 4, MOST = sizeof PREFIXES / sizeof *PREFIXES - 1 };
    if (!isfinite(value)) {
        text_append(text, "-");
        return;
    }
    // as it is rounded: 999.7 is 1.00 k
    char digits[32];
    snprintf(digits, sizeof digits, "%.2e", value);
    const double rounded = strtod(digits, NULL);
    const int exponent = rounded == 0.0 ? 0 : (int)floor(log10(fabs(rounded)) + 1e-9);
    int prefix = NONE + (int)floor(exponent / 3.0);
    prefix = prefix < 0 ? 0 : prefix > MOST ? MOST : prefix;
    const double shown = rounded / pow(10.0, 3.0 * (prefix - NONE));
    const int before = fabs(shown) >= 100.0 ? 3 : fabs(shown) >= 10.0 ? 2 : 1;
    text_append(text, "%.*f %s%s", 3 - before, shown, PREFIXES[prefix], unit);
}
