// Puts text together, and finds the word that may have been meant.
#include "base/text.h"

#include "base/printable.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_FIRST_CAPACITY = 256, TEXT_WORD_MAX = 64, TEXT_BEGUN_MIN = 3 };

void text_init(Text *text)
{
    text->data = calloc(1, TEXT_FIRST_CAPACITY);
    assert(text->data != NULL);
    text->length = 0;
    text->capacity = TEXT_FIRST_CAPACITY;
}

void text_finish(Text *text)
{
    if (text == NULL) {
        return;
    }
    free(text->data);
    *text = (Text){0};
}

static void text_reserve(Text *text, size_t extra)
{
    size_t capacity = text->capacity;
    while (text->length + extra + 1 > capacity) {
        capacity *= 2;
    }
    if (capacity != text->capacity) {
        text->data = realloc(text->data, capacity);
        assert(text->data != NULL);
        text->capacity = capacity;
    }
}

void text_append(Text *text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    text_append_list(text, format, arguments);
    va_end(arguments);
}

void text_append_list(Text *text, const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    const size_t room = text->capacity - text->length;
    const int needed = vsnprintf(text->data + text->length, room, format, arguments);
    assert(needed >= 0);
    if ((size_t)needed >= room) {
        text_reserve(text, (size_t)needed);
        vsnprintf(text->data + text->length, (size_t)needed + 1, format, again);
    }
    va_end(again);
    text->length += (size_t)needed;
}

void text_append_bytes(Text *text, const char *bytes, size_t count)
{
    text_reserve(text, count);
    memcpy(text->data + text->length, bytes, count);
    text->length += count;
    text->data[text->length] = '\0';
}

void text_append_shown(Text *text, const char *words)
{
    char *shown = printable_copy(words, false);
    text_append(text, "%s", shown);
    free(shown);
}

// The bytes of the mark at the start of a text; 0 where there is none.
static size_t mark_size(const char *at, const char *const *marks)
{
    for (; *marks != NULL; marks++) {
        const size_t size = strlen(*marks);
        if (size > 0 && strncmp(at, *marks, size) == 0) {
            return size;
        }
    }
    return 0;
}

void text_show(Text *text, const char *const *marks)
{
    if (printable_is_shown(text->data)) {
        return;
    }
    Text target;
    text_init(&target);
    for (size_t i = 0; i < text->length;) {
        const char *at = text->data + i;
        const PrintableCharacter character = printable_character(at, text->length - i);
        const size_t mark = mark_size(at, marks);
        const bool is_shown = mark > 0 || *at == '\n' || character.escape[0] == '\0';
        const size_t size = mark > 0 ? mark : character.size;
        text_append_bytes(&target, is_shown ? at : character.escape,
                          is_shown ? size : strlen(character.escape));
        i += size;
    }
    text_finish(text);
    *text = target;
}

enum { NUMBER_DIGITS = 17, NUMBER_SIZE = 40 }; // digits that read back any double

// The digits of a printed number as a whole number, from the first that is not 0; how many.
static uint64_t take_digits(const char *words, size_t *count)
{
    uint64_t digits = 0;
    *count = 0;
    for (const char *c = words; *c != '\0' && *c != 'e'; c++) {
        if (*c >= '1' || (*c == '0' && *count > 0)) {
            digits = 10 * digits + (uint64_t)(*c - '0');
            ++*count;
        }
    }
    return digits;
}

// Whether a number printed with 17 digits may read back with fewer, of which `unit` is the last:
// they leave it by no more than half the way to the next double, and a unit of the 17th for
// roundings.
static bool may_drop(uint64_t digits, double value, uint64_t unit)
{
    const double step = nextafter(fabs(value), INFINITY) - fabs(value);
    const double half = step / fabs(value) * (0.5 * (double)digits);
    const uint64_t tail = digits % unit;
    return (double)(tail < unit - tail ? tail : unit - tail) <= half + 1.0;
}

void text_append_number(Text *text, double value)
{
    if (value == rint(value) && fabs(value) < 1e15) {
        text_append(text, "%.0f", value);
        return;
    }
    char words[NUMBER_SIZE];
    char shorter[NUMBER_SIZE];
    size_t count;
    snprintf(words, sizeof words, "%.*g", NUMBER_DIGITS, value);
    const uint64_t digits = take_digits(words, &count);
    for (int fewer = 15; fewer < NUMBER_DIGITS; fewer++) {
        // one with fewer digits than 17 has lost zeros at its end
        if (count < NUMBER_DIGITS || may_drop(digits, value, fewer == 15 ? 100 : 10)) {
            snprintf(shorter, sizeof shorter, "%.*g", fewer, value);
            if (strtod(shorter, NULL) == value) {
                text_append(text, "%s", shorter);
                return;
            }
        }
    }
    text_append(text, "%s", words);
}

void text_copy(char *target, size_t size, const char *source)
{
    snprintf(target, size, "%s", source);
}

static size_t smallest(size_t a, size_t b, size_t c)
{
    const size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

size_t text_distance(const char *a, const char *b)
{
    size_t row[3][TEXT_WORD_MAX + 1];
    const size_t rows = strlen(a) < TEXT_WORD_MAX ? strlen(a) : TEXT_WORD_MAX;
    const size_t columns = strlen(b) < TEXT_WORD_MAX ? strlen(b) : TEXT_WORD_MAX;
    for (size_t j = 0; j <= columns; j++) {
        row[0][j] = j;
    }
    for (size_t i = 1; i <= rows; i++) {
        size_t *now = row[i % 3];
        const size_t *last = row[(i + 2) % 3];
        const size_t *before = row[(i + 1) % 3];
        now[0] = i;
        for (size_t j = 1; j <= columns; j++) {
            const size_t same = a[i - 1] == b[j - 1] ? 0 : 1;
            now[j] = smallest(last[j] + 1, now[j - 1] + 1, last[j - 1] + same);
            // two neighbours swapped count as one slip of the finger
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
                before[j - 2] + 1 < now[j]) {
                now[j] = before[j - 2] + 1;
            }
        }
    }
    return row[rows % 3][columns];
}

const char *text_nearest(const char *word, const char *const *choices, size_t count)
{
    const char *best = NULL;
    const size_t letters = strlen(word);
    size_t best_distance = SIZE_MAX;
    for (size_t i = 0; i < count; i++) {
        const size_t distance = text_distance(word, choices[i]);
        // of two letters the third was left out
        const bool is_short = letters == 2 && strlen(choices[i]) == 3 && distance == 1;
        if ((distance <= letters / 3 || is_short) && distance < best_distance) {
            best_distance = distance;
            best = choices[i];
        }
    }
    // a word that was begun
    for (size_t i = 0; i < count && best == NULL; i++) {
        const bool is_begun = strlen(word) >= TEXT_BEGUN_MIN;
        best = is_begun && strncmp(word, choices[i], strlen(word)) == 0 ? choices[i] : NULL;
    }
    return best;
}
