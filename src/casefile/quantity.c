// Reads a number with its unit.
//
//     number     = [+-] digits [. digits] [e [+-] digits]
//     quantity   = number unit
//     tolerated  = number [unit] (+- | +/- | PLUS-MINUS) number (unit | %)
//                | number [unit] +number/-number (unit | %)
#include "casefile/quantity.h"

#include "base/printable.h"
#include "base/text.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN_MAX = 40 }; // bytes of a wrong value that are quoted

static const double INTEGER_MAX = 9007199254740992.0; // 2^53: every whole number up to it is exact
static const double EXPONENT_MIN = 1.0;               // of a stiffness: a spring that softens
static const double EXPONENT_MAX = 3.0;               // or hardens more is a slip of the pen

__attribute__((format(printf, 2, 3))) static bool complain(Complaint *complaint, const char *format,
                                                           ...)
{
    va_list arguments;
    va_start(arguments, format);
    shorten_list(complaint->text, sizeof complaint->text, format, arguments);
    va_end(arguments);
    return false;
}

// The same, and a value of the dimension is allowed.
__attribute__((format(printf, 3, 4))) static bool
complain_of(Complaint *complaint, Dimension dimension, const char *format, ...)
{
    Text units;
    text_init(&units);
    units_list(dimension, &units);
    snprintf(complaint->allowed, sizeof complaint->allowed, "%s such as %s%s%s%s",
             units_dimension_name(dimension), units_example(dimension),
             units.length > 0 ? " (in " : "", units.data, units.length > 0 ? ")" : "");
    text_finish(&units);
    va_list arguments;
    va_start(arguments, format);
    shorten_list(complaint->text, sizeof complaint->text, format, arguments);
    va_end(arguments);
    return false;
}

// Takes a result over if it is one.
static bool take_finite(double value, const char *text, double *taken, Complaint *complaint)
{
    if (!isfinite(value)) {
        return complain(complaint, "'%.*s' is too large for a number", SHOWN_MAX, text);
    }
    *taken = value;
    return true;
}

static const char *skip_blanks(const char *text)
{
    return text + strspn(text, " \t");
}

static const char *skip_digits(const char *text)
{
    return text + strspn(text, "0123456789");
}

// The end of the number at the start of the text, or NULL where there is none.
static const char *number_end(const char *text)
{
    if (*text == '+' || *text == '-') {
        text++;
    }
    const char *whole = skip_digits(text);
    const char *end = whole;
    size_t digits = (size_t)(whole - text);
    if (*whole == '.') {
        end = skip_digits(whole + 1);
        digits += (size_t)(end - whole - 1);
    }
    if (digits == 0) {
        return NULL;
    }
    if (*end == 'e' || *end == 'E') {
        const char *power = end + 1;
        if (*power == '+' || *power == '-') {
            power++;
        }
        if (isdigit((unsigned char)*power)) {
            end = skip_digits(power);
        }
    }
    return end;
}

// Reads the number at *text and moves *text behind it and the blanks that follow.
static bool take_number(const char **text, Dimension dimension, double *value, Complaint *complaint)
{
    const char *start = skip_blanks(*text);
    const char *end = number_end(start);
    if (end == NULL) {
        return complain_of(complaint, dimension, "'%.*s' is not a number", SHOWN_MAX, start);
    }
    char *read_end;
    errno = 0;
    const double read = strtod(start, &read_end);
    // strtod also knows hexadecimal numbers; a case file does not
    if (read_end != end) {
        return complain_of(complaint, dimension, "'%.*s' is not a decimal number", SHOWN_MAX,
                           start);
    }
    if (errno == ERANGE || !isfinite(read)) {
        return complain_of(complaint, dimension, "'%.*s' is too large or too small for a number",
                           SHOWN_MAX, start);
    }
    *value = read;
    *text = skip_blanks(end);
    return true;
}

bool quantity_number(const char *text, double *value, Complaint *complaint)
{
    complaint->allowed[0] = '\0';
    double read = 0.0;
    if (!take_number(&text, DIMENSION_NONE, &read, complaint)) {
        return false;
    }
    if (*text != '\0') {
        return complain_of(complaint, DIMENSION_NONE, "expected a plain number; '%.*s' follows it",
                           SHOWN_MAX, text);
    }
    *value = read;
    return true;
}

bool quantity_integer(const char *text, size_t *value, Complaint *complaint)
{
    double read;
    if (!quantity_number(text, &read, complaint)) {
        return false;
    }
    if (!(read >= 0.0 && read <= INTEGER_MAX && read == floor(read))) {
        snprintf(complaint->allowed, sizeof complaint->allowed, "a whole number");
        return complain(complaint, "'%.*s' is not a whole number", SHOWN_MAX, text);
    }
    *value = (size_t)read;
    return true;
}

// Finds the unit a text consists of.
static const Unit *read_unit(const char *text, Dimension dimension, Complaint *complaint)
{
    char name[UNITS_NAME_SIZE];
    units_normalise(text, name);
    const Unit *unit = units_find(dimension, name);
    if (unit != NULL && unit->dimension == dimension) {
        return unit;
    }
    const char *nearest = units_nearest(dimension, name);
    if (unit != NULL) {
        complain_of(complaint, dimension, "expected %s such as %s; '%s' is %s",
                    units_dimension_name(dimension), units_example(dimension), name,
                    units_dimension_name(unit->dimension));
    } else if (name[0] == ',') {
        complain_of(complaint, dimension, "a number has a decimal point, not a comma");
    } else {
        complain_of(complaint, dimension, "unknown unit '%s'%s%s%s", name,
                    nearest != NULL ? "; did you mean '" : "", nearest != NULL ? nearest : "",
                    nearest != NULL ? "'?" : "");
    }
    return NULL;
}

bool quantity_parse(const char *text, Dimension dimension, double *si, Complaint *complaint)
{
    const Unit *unit;
    return quantity_parse_unit(text, dimension, si, &unit, complaint);
}

bool quantity_parse_unit(const char *text, Dimension dimension, double *si, const Unit **unit,
                         Complaint *complaint)
{
    complaint->allowed[0] = '\0';
    if (dimension == DIMENSION_NONE) {
        *unit = NULL;
        return quantity_number(text, si, complaint);
    }
    const char *rest = text;
    double value;
    if (!take_number(&rest, dimension, &value, complaint)) {
        return false;
    }
    if (*rest == '\0' && value != 0.0) {
        return complain_of(complaint, dimension, "'%.*s' has no unit", SHOWN_MAX, text);
    }
    // 0 is the same in every unit
    const Unit *read = *rest == '\0' ? units_find(dimension, units_si(dimension))
                                     : read_unit(rest, dimension, complaint);
    if (read == NULL) {
        return false;
    }
    if (!take_finite(value * read->numerator / read->denominator, text, si, complaint)) {
        return false;
    }
    *unit = read;
    return true;
}

// The tolerance's sign in a text, or NULL; a plain + has two limits behind it.
static const char *find_sign(const char *text, size_t *size)
{
    static const char *const SIGNS[] = {"+-", "+/-", "\u00b1", "+"};
    for (size_t i = 0; i < sizeof SIGNS / sizeof SIGNS[0]; i++) {
        const char *found = strstr(text, SIGNS[i]);
        *size = strlen(SIGNS[i]);
        if (found != NULL) {
            return found;
        }
    }
    return NULL;
}

// Reads what stands behind the sign: `0.3 mm`, `1 %`, or `0.1/-0.2 mm` where it is not symmetric.
static bool cut_limits(const char *text, bool is_symmetric, Dimension dimension, QuantityCut *cut,
                       Complaint *complaint)
{
    if (!take_number(&text, dimension, &cut->upper, complaint)) {
        return false;
    }
    cut->lower = -cut->upper;
    if (!is_symmetric && *text != '/') {
        return complain(complaint, "a one-sided tolerance has two limits");
    }
    if (!is_symmetric) {
        text++;
        if (!take_number(&text, dimension, &cut->lower, complaint)) {
            return false;
        }
    }
    if (!(cut->upper >= 0.0 && cut->lower <= 0.0)) {
        return complain(complaint, "the upper limit must be 0 or above, the lower 0 or below");
    }
    if (*text == '\0' && dimension != DIMENSION_NONE) {
        return complain(complaint, "the tolerance has no unit");
    }
    cut->is_percent = strcmp(text, "%") == 0;
    text_copy(cut->limit_unit, sizeof cut->limit_unit, cut->is_percent ? "" : text);
    return true;
}

bool quantity_cut(const char *text, Dimension dimension, QuantityCut *cut, Complaint *complaint)
{
    // the sign of a tolerance stands behind the first number; that number's own sign does not count
    const char *start = skip_blanks(text);
    const char *end = number_end(start);
    const char *behind = end != NULL ? skip_blanks(end) : NULL;
    size_t sign_size = 0;
    const char *sign = behind != NULL ? find_sign(behind, &sign_size) : NULL;
    QuantityCut read = {.is_there = sign != NULL};
    complaint->allowed[0] = '\0';
    if (sign == NULL) {
        cut->is_there = false;
        return true;
    }
    const bool is_symmetric = strncmp(sign, "+", sign_size) != 0;
    if (!take_number(&start, dimension, &read.nominal, complaint)) {
        return false;
    }
    snprintf(complaint->allowed, sizeof complaint->allowed,
             "a tolerance such as 108 +- 0.3 mm, 108 +0.1/-0.2 mm or 108 mm +- 1 %%");
    if (!cut_limits(sign + sign_size, is_symmetric, dimension, &read, complaint)) {
        return false;
    }
    size_t own = (size_t)(sign - behind);
    while (own > 0 && (behind[own - 1] == ' ' || behind[own - 1] == '\t')) {
        own--;
    }
    if (own == 0 && read.is_percent && dimension != DIMENSION_NONE) {
        return complain(complaint, "'%.*s' has no unit", SHOWN_MAX, text);
    }
    snprintf(read.unit, sizeof read.unit, "%.*s", (int)(own > 0 ? own : sizeof read.unit),
             own > 0 ? behind : read.limit_unit);
    *cut = read;
    return true;
}

// Takes a power off a unit whose last word has one: "N/m^1.5", "N m/rad^1.5". Inertias and
// pressures have powers of their own and stay as they are.
static bool take_power(char *name, Dimension dimension, double *exponent, Complaint *complaint)
{
    char *power = strchr(name, '^');
    const bool is_its = dimension == DIMENSION_STIFFNESS
                            ? strncmp(name, "N/m", 3) == 0 && strcmp(name, "N/mm^2") != 0
                            : strstr(name, "/rad^") != NULL || strstr(name, "/deg^") != NULL;
    *exponent = 1.0;
    if (power != NULL && is_its) {
        *power = '\0';
        if (!quantity_number(power + 1, exponent, complaint)) {
            return false;
        }
    }
    if (!(*exponent >= EXPONENT_MIN && *exponent <= EXPONENT_MAX)) {
        snprintf(complaint->allowed, sizeof complaint->allowed, "an exponent from %g to %g",
                 EXPONENT_MIN, EXPONENT_MAX);
        return complain(complaint, "the exponent of the unit is %g", *exponent);
    }
    return true;
}

bool quantity_stiffness(const char *text, Dimension dimension, double *stiffness, double *exponent,
                        Complaint *complaint)
{
    complaint->allowed[0] = '\0';
    const char *rest = text;
    double value;
    double read_exponent;
    if (!take_number(&rest, dimension, &value, complaint)) {
        return false;
    }
    if (*rest == '\0') {
        return complain_of(complaint, dimension, "'%.*s' has no unit", SHOWN_MAX, text);
    }
    char name[UNITS_NAME_SIZE];
    units_normalise(rest, name);
    if (!take_power(name, dimension, &read_exponent, complaint)) {
        return false;
    }
    const Unit *unit = read_unit(name, dimension, complaint);
    if (unit == NULL) {
        return false;
    }
    // of N/mm^n and N m/deg^n the length and the angle have the power, of N mm/rad^n neither
    const bool has_power = dimension == DIMENSION_STIFFNESS || strstr(name, "/deg") != NULL;
    const double factor = unit->numerator / unit->denominator;
    if (!take_finite(value * pow(factor, has_power ? read_exponent : 1.0), text, stiffness,
                     complaint)) {
        return false;
    }
    *exponent = read_exponent;
    return true;
}

static bool allow_span(Complaint *complaint)
{
    snprintf(complaint->allowed, sizeof complaint->allowed,
             "a time such as 60 ms, or 1 revolution");
    return false;
}

bool quantity_span(const char *text, double *span, bool *is_in_turns, Complaint *complaint)
{
    static const char *const TURNS[] = {"revolution", "revolutions"};
    complaint->allowed[0] = '\0';
    const char *rest = text;
    char name[UNITS_NAME_SIZE];
    double value;
    if (!take_number(&rest, DIMENSION_TIME, &value, complaint)) {
        return allow_span(complaint);
    }
    units_normalise(rest, name);
    for (int i = 0; i < 2; i++) {
        if (strcmp(name, TURNS[i]) == 0) {
            *span = value;
            *is_in_turns = true;
            return true;
        }
    }
    const char *nearest = name[0] != '\0' ? text_nearest(name, TURNS, 2) : NULL;
    if (nearest != NULL) {
        complain(complaint, "'%.*s' is no unit; did you mean '%s'?", SHOWN_MAX, name, nearest);
        return allow_span(complaint);
    }
    if (!quantity_parse(text, DIMENSION_TIME, span, complaint)) {
        return allow_span(complaint);
    }
    *is_in_turns = false;
    return true;
}
