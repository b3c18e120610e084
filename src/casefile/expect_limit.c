// Reads what a limit means.
//
//     limit = below X | above X | between X and Y | within P % of X | within D of X | equals N
//
//     below X           value < X
//     above X           value > X
//     between X and Y   X <= value <= Y
//     within P % of X   |value - X| <= P/100 |X|
//     within D of X     |value - X| <= D
//     equals N          value = N, of whole numbers
#include "casefile/expect_limit.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { PART_SIZE = 96 };

const char EXPECT_FORMS[] = "below X, above X, between X and Y, within P % of X, within D of X, "
                            "equals N";

// A limit being read; what is wrong with it is where `part` stands in the text.
typedef struct Reading {
    const char *text;
    const ExpectRow *row;
    Complaint *complaint;
    const char *part;
    size_t length;
} Reading;

__attribute__((format(printf, 3, 4))) static bool complain(Reading *reading, const char *allowed,
                                                           const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reading->complaint->text, sizeof reading->complaint->text, format, arguments);
    va_end(arguments);
    snprintf(reading->complaint->allowed, sizeof reading->complaint->allowed, "%s", allowed);
    return false;
}

// Points at a part of the text, without the blanks around it, and copies it.
static bool take_part(Reading *reading, const char *start, const char *end, char part[PART_SIZE])
{
    while (start < end && *start == ' ') {
        start++;
    }
    while (end > start && end[-1] == ' ') {
        end--;
    }
    const size_t length = (size_t)(end - start);
    reading->part = length > 0 ? start : reading->text;
    reading->length = length > 0 ? length : strlen(reading->text);
    if (length == 0 || length >= PART_SIZE) {
        return complain(reading, EXPECT_FORMS, "a value is %s in this limit",
                        length == 0 ? "missing" : "too long");
    }
    memcpy(part, start, length);
    part[length] = '\0';
    return true;
}

// One quantity of the number's dimension; the last one gives the unit of reports.
static bool read_value(Reading *reading, const char *start, const char *end,
                       Expectation *expectation, double *value)
{
    char part[PART_SIZE];
    const Unit *unit = NULL;
    if (!take_part(reading, start, end, part) ||
        !quantity_parse_unit(part, reading->row->dimension, value, &unit, reading->complaint)) {
        return false;
    }
    expectation->unit_si = unit != NULL ? unit->numerator / unit->denominator : 1.0;
    snprintf(expectation->unit, sizeof expectation->unit, "%s", unit != NULL ? unit->name : "");
    return true;
}

static bool read_between(Reading *reading, const char *rest, Expectation *expectation)
{
    const char *and = strstr(rest, " and ");
    if (and == NULL) {
        return complain(reading, EXPECT_FORMS, "between needs two values with 'and' between them");
    }
    if (!read_value(reading, rest, and, expectation, &expectation->low) ||
        !read_value(reading, and+5, rest + strlen(rest), expectation, &expectation->high)) {
        return false;
    }
    if (expectation->low > expectation->high) {
        reading->part = reading->text;
        reading->length = strlen(reading->text);
        return complain(reading, "the smaller value first", "no number is between these two");
    }
    return true;
}

// How far from the middle, as a share of it or in its unit.
static bool read_distance(Reading *reading, const char *rest, const char *end, double middle,
                          double *distance)
{
    char part[PART_SIZE];
    Expectation ignored = {0};
    if (!take_part(reading, rest, end, part)) {
        return false;
    }
    const size_t length = strlen(part);
    if (part[length - 1] != '%') {
        if (!read_value(reading, rest, end, &ignored, distance)) {
            return false;
        }
    } else {
        part[length - 1] = '\0';
        double percent;
        if (!quantity_number(part, &percent, reading->complaint)) {
            return false;
        }
        *distance = 0.01 * percent * fabs(middle);
    }
    return *distance >= 0.0 ||
           complain(reading, "a distance of 0 or more", "nothing is within a distance below 0");
}

static bool read_within(Reading *reading, const char *rest, Expectation *expectation)
{
    const char *of = strstr(rest, " of ");
    if (of == NULL) {
        return complain(reading, EXPECT_FORMS, "within needs a distance, 'of' and a value");
    }
    double middle;
    double distance;
    if (!read_value(reading, of + 4, rest + strlen(rest), expectation, &middle) ||
        !read_distance(reading, rest, of, middle, &distance)) {
        return false;
    }
    expectation->low = middle - distance;
    expectation->high = middle + distance;
    return true;
}

static bool read_equals(Reading *reading, const char *rest, Expectation *expectation)
{
    if (!reading->row->is_count) {
        return complain(reading, EXPECT_FORMS, "equals is for whole numbers, and %s is none",
                        reading->row->name);
    }
    char part[PART_SIZE];
    size_t count;
    if (!take_part(reading, rest, rest + strlen(rest), part) ||
        !quantity_integer(part, &count, reading->complaint)) {
        return false;
    }
    expectation->low = (double)count;
    expectation->high = (double)count;
    expectation->unit_si = 1.0;
    return true;
}

static bool read_form(Reading *reading, Expectation *expectation)
{
    static const char *const WORDS[] = {"below", "above", "between", "within", "equals"};
    const char *text = reading->text + strspn(reading->text, " ");
    const size_t length = strcspn(text, " ");
    const char *rest = text + length;
    int form = 0;
    while (form < 5 && (strlen(WORDS[form]) != length || strncmp(text, WORDS[form], length) != 0)) {
        form++;
    }
    switch (form) {
    case 0:
        expectation->is_open = true;
        return read_value(reading, rest, rest + strlen(rest), expectation, &expectation->high);
    case 1:
        expectation->is_open = true;
        return read_value(reading, rest, rest + strlen(rest), expectation, &expectation->low);
    case 2:
        return read_between(reading, rest, expectation);
    case 3:
        return read_within(reading, rest, expectation);
    case 4:
        return read_equals(reading, rest, expectation);
    default:
        return complain(reading, EXPECT_FORMS, "'%.40s' is no limit", reading->text);
    }
}

bool expect_limit_read(const char *text, const ExpectRow *row, Expectation *expectation,
                       Complaint *complaint, size_t *start, size_t *length)
{
    Reading reading = {
        .text = text, .row = row, .complaint = complaint, .part = text, .length = strlen(text)};
    Expectation read = *expectation;
    read.low = -INFINITY;
    read.high = INFINITY;
    read.is_open = false;
    if (!read_form(&reading, &read)) {
        *start = (size_t)(reading.part - text);
        *length = reading.length;
        return false;
    }
    text_copy(read.words, sizeof read.words, text);
    *expectation = read;
    return true;
}
