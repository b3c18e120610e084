// Compares settings as baselines have them: texts with numbers in them.
#include "commands/check/setting_agrees.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double AGREES = 1e-12; // of the largest number: rounding of positions

// Reads a number where one can begin: not within a word, and none of the words that strtod takes
// for numbers. False where there is none; `end` is then as it was.
static bool read_number(const char *text, const char *at, double *number, const char **end)
{
    const bool is_within = at > text && isalnum((unsigned char)at[-1]);
    const char *digit = at + strspn(at, "+-.");
    if (is_within || !isdigit((unsigned char)*digit)) {
        return false;
    }
    // "--2" has a digit, and yet strtod finds no number at its start
    char *behind;
    const double read = strtod(at, &behind);
    if (behind == at || !isfinite(read)) {
        return false;
    }
    *number = read;
    *end = behind;
    return true;
}

// The largest number in a value.
static double largest_number(const char *value)
{
    double largest = 0.0;
    for (const char *at = value; *at != '\0';) {
        double number;
        const char *end = at + 1;
        if (read_number(value, at, &number, &end)) {
            largest = fmax(largest, fabs(number));
        }
        at = end;
    }
    return largest;
}

bool setting_agrees(const char *was, const char *now)
{
    const double near = AGREES * largest_number(was);
    const char *at_was = was;
    const char *at_now = now;
    while (*at_was != '\0' && *at_now != '\0') {
        double was_number;
        double now_number;
        const char *was_end;
        const char *now_end;
        if (read_number(was, at_was, &was_number, &was_end) &&
            read_number(now, at_now, &now_number, &now_end)) {
            if (!(fabs(was_number - now_number) <= near)) {
                return false;
            }
            at_was = was_end;
            at_now = now_end;
        } else if (*at_was++ != *at_now++) {
            return false;
        }
    }
    return *at_was == *at_now;
}
