// The factors from SI to the units that people read.
#include "write/units.h"

#include <stdbool.h>
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
        {"deg", &UNITS_DEG},   {"rpm", &UNITS_RPM}, {"mm", &UNITS_MM},       {"mm/s", &UNITS_MM},
        {"um", &UNITS_UM},     {"ms", &UNITS_MS},   {"us", &UNITS_US},       {"%", &UNITS_PERCENT},
        {"mrad", &UNITS_MRAD}, {"MPa", &UNITS_MPA}, {"MPa m/s", &UNITS_MPA},
    };
    for (size_t i = 0; unit != NULL && i < sizeof UNITS / sizeof *UNITS; i++) {
        if (strcmp(unit, UNITS[i].word) == 0) {
            return *UNITS[i].per_si;
        }
    }
    return 1.0;
}

static const char *const PREFIXES[] = {"p", "n", "u", "m", "", "k", "M", "G", "T"};

enum {
    NO_PREFIX = 4,
    PREFIX_MOST = sizeof PREFIXES / sizeof *PREFIXES - 1,
    DIGITS_MOST = 3,
    DECIMALS_MOST = 2, // of what is far smaller than its prefix
};

// Of the first digit of a number, as it is rounded to three: 2 of 999, 3 of 999.7; 0 of 0.
static int first_place(double value)
{
    char digits[32];
    snprintf(digits, sizeof digits, "%.2e", fabs(value));
    const double rounded = strtod(digits, NULL);
    return rounded == 0.0 ? 0 : (int)floor(log10(rounded) + 1e-9);
}

// Of the last digit that an interval leaves: that of the first digit of its half width.
static int last_place(double value, double low, double high)
{
    const double half = fmax(value - low, high - value);
    const int first = first_place(value);
    const int least = first - DIGITS_MOST + 1;
    if (!(half > 0.0) || !isfinite(half)) {
        return least;
    }
    const int last = (int)floor(log10(half) + 1e-9);
    return last < least ? least : last > first && value != 0.0 ? first : last;
}

// As printf rounds it.
static double rounded_to(double value, int place)
{
    char digits[32];
    snprintf(digits, sizeof digits, "%.16e", value);
    const int first = value == 0.0 ? place : atoi(strchr(digits, 'e') + 1);
    if (first < place) {
        return round(value * pow(10.0, -place)) * pow(10.0, place);
    }
    snprintf(digits, sizeof digits, "%.*e", first - place, value);
    return strtod(digits, NULL);
}

static int prefix_of(double value, int place)
{
    const int prefix = NO_PREFIX + (int)floor(first_place(rounded_to(value, place)) / 3.0);
    return prefix < 0 ? 0 : prefix > PREFIX_MOST ? PREFIX_MOST : prefix;
}

const char *units_prefix(double size, double *factor)
{
    const int prefix =
        size != 0.0 ? prefix_of(size, first_place(size) - DIGITS_MOST + 1) : NO_PREFIX;
    *factor = pow(10.0, -3 * (prefix - NO_PREFIX));
    return PREFIXES[prefix];
}

// To the digit at a place, in units of a prefix.
static void append_to(Text *text, double value, int place, int prefix)
{
    const int power = 3 * (prefix - NO_PREFIX);
    const double shown = rounded_to(value, place) / pow(10.0, power);
    const int decimals = power > place ? power - place : 0;
    text_append(text, "%.*f", decimals < DECIMALS_MOST ? decimals : DECIMALS_MOST,
                shown == 0.0 ? 0.0 : shown);
}

void units_append(Text *text, double value, const char *unit)
{
    if (!isfinite(value)) {
        text_append(text, "-");
        return;
    }
    units_append_within(text, value, value, value, unit);
}

void units_append_within(Text *text, double value, double low, double high, const char *unit)
{
    if (isinf(high)) {
        text_append(text, "at least ");
        units_append(text, low, unit);
        return;
    }
    const int place = last_place(value, low, high);
    const int prefix = prefix_of(value, place);
    append_to(text, value, place, prefix);
    text_append(text, " %s%s", PREFIXES[prefix], unit);
}

// Both ends to a place, rounded away from what is between them by more than rounding adds to a
// number of whole digits.
static void append_ends(Text *text, double low, double high, int place, int prefix)
{
    const double digit = pow(10.0, place);
    append_to(text, floor(low / digit + 1e-9) * digit, place, prefix);
    text_append(text, " to ");
    append_to(text, ceil(high / digit - 1e-9) * digit, place, prefix);
}

void units_append_interval(Text *text, double value, double low, double high, const char *unit)
{
    units_append_within(text, value, low, high, unit);
    if (isinf(high) || !(high > low)) {
        return;
    }
    const int place = last_place(value, low, high);
    text_append(text, " (");
    append_ends(text, low, high, place, prefix_of(value, place));
    text_append(text, ")");
}

// The last digit of what has a range: two digits of the value are shown however wide it is.
static int spread_place(double value, double low, double high)
{
    const int place = last_place(value, low, high);
    const int second = first_place(value) - 1;
    return place < second ? place : second;
}

void units_append_spread(Text *text, double value, double low, double high, const char *unit)
{
    const int place = spread_place(value, low, high);
    const int prefix = prefix_of(value, place);
    append_to(text, value, place, prefix);
    text_append(text, " %s%s", PREFIXES[prefix], unit);
}

void units_append_ends(Text *text, double value, double low, double high)
{
    const int place = spread_place(value, low, high);
    append_ends(text, low, high, place, prefix_of(value, place));
}

void units_append_beside(Text *text, double value, double low, double high, double beside,
                         double beside_low, double beside_high)
{
    const bool is_bounded = !isinf(beside_high);
    const double shown = is_bounded ? beside : beside_low;
    const int place =
        is_bounded ? last_place(beside, beside_low, beside_high) : last_place(shown, shown, shown);
    const bool is_known = !isinf(high);
    append_to(text, is_known ? value : low,
              is_known ? last_place(value, low, high) : last_place(low, low, low),
              prefix_of(shown, place));
}

void units_append_digits(Text *text, double value, double low, double high)
{
    append_to(text, value, last_place(value, low, high), NO_PREFIX);
}
