// Where in the text does a message point, and how is that shown?
//
//     cases/x.yaml:7:46: the pin (10.02 mm) must be smaller than the hole (10.015 mm)
//         crank-coupler: {hole: 10.015 mm, pin: 10.02 mm, width: 13 mm}
//                                               ^~~~~~~~
//     allowed: a pin below 10.015 mm
#include "casefile/source.h"

#include "base/shorten.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum {
    MESSAGE_SIZE = 512,
    WINDOW_WIDTH = 70, // characters of a line that are shown
    WINDOW_LEAD = 44,  // of these, so many in front of a caret that would stand outside
};

// One place: the line it is on, and where that line is in the text.
typedef struct Place {
    size_t line;       // from 1
    size_t column;     // from 1, in characters
    size_t line_start; // bytes
    size_t line_end;   // bytes, without the break
} Place;

static bool is_break(const Source *source, size_t byte)
{
    const char c = source->text[byte];
    if (c == '\n') {
        return true;
    }
    // a lone return ends a line too; in CR LF the line feed does
    return c == '\r' && !(byte + 1 < source->size && source->text[byte + 1] == '\n');
}

static bool starts_character(char byte)
{
    return ((unsigned char)byte & 0xc0u) != 0x80u;
}

static Place find_place(const Source *source, size_t character)
{
    Place place = {.line = 1, .column = 1};
    size_t byte = 0;
    for (size_t i = 0; i < character && byte < source->size; i++) {
        place.column++;
        if (is_break(source, byte)) {
            place.line++;
            place.column = 1;
            place.line_start = byte + 1;
        }
        do {
            byte++;
        } while (byte < source->size && !starts_character(source->text[byte]));
    }
    place.line_end = place.line_start;
    while (place.line_end < source->size && source->text[place.line_end] != '\n' &&
           source->text[place.line_end] != '\r') {
        place.line_end++;
    }
    return place;
}

// Appends the part of the line around the caret and the caret below it.
static void append_line(const Source *source, Place place, size_t length, Text *text)
{
    const size_t first = place.column > WINDOW_WIDTH - 16 ? place.column - WINDOW_LEAD : 1;
    text_append(text, "\n    %s", first > 1 ? "..." : "");
    size_t column = 0;
    for (size_t byte = place.line_start; byte < place.line_end; byte++) {
        const char c = source->text[byte];
        column += starts_character(c) ? 1 : 0;
        if (column >= first && column < first + WINDOW_WIDTH) {
            // a tab takes one place, so that the caret below stands right
            text_append(text, "%c", c == '\t' ? ' ' : c);
        }
    }
    const size_t indent = place.column - first + (first > 1 ? 3 : 0);
    text_append(text, "%s\n    %*s^", column >= first + WINDOW_WIDTH ? "..." : "", (int)indent, "");
    // the tail ends where the line does
    const size_t last = column < first + WINDOW_WIDTH ? column : first + WINDOW_WIDTH - 1;
    for (size_t i = 1; i < length && place.column + i <= last; i++) {
        text_append(text, "~");
    }
}

// A message may quote a value and cut it inside a character: what is no text becomes '?'.
static void mend(char *message)
{
    for (char *c = message; *c != '\0'; c++) {
        size_t size = 0;
        while (size < 4 && c[size] != '\0') {
            size++;
        }
        const size_t good = source_text_length(c, size);
        if (good == 0) {
            *c = '?';
        } else if (((unsigned char)*c & 0x80u) != 0) {
            do {
                c++;
            } while (!starts_character(*c) && *c != '\0');
            c--;
        }
    }
}

bool source_error(const Source *source, Span span, const char *allowed, Err *err,
                  const char *format, ...)
{
    char message[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    shorten_list(message, sizeof message, format, arguments);
    va_end(arguments);
    mend(message);

    const Place place = find_place(source, span.start + source->shift);
    Text text;
    text_init(&text);
    if (source->is_option) {
        text_append(&text, "%s: %s", source->name, message);
    } else {
        text_append(&text, "%s:%zu:%zu: %s", source->name, place.line, place.column, message);
    }
    if (place.line_end > place.line_start) {
        append_line(source, place, span.end > span.start ? span.end - span.start : 1, &text);
    }
    if (allowed != NULL && allowed[0] != '\0') {
        text_append(&text, "\nallowed: %s", allowed);
    }
    err_set(err, source->is_option ? ERR_USAGE : ERR_CASE, "%s", text.data);
    text_finish(&text);
    return false;
}

// The bytes of the character at the start, or 0 where it is none (overlong, cut, a surrogate, or
// beyond Unicode's end).
static size_t character_size(const unsigned char *text, size_t size)
{
    static const unsigned SMALLEST[5] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned first = text[0];
    if (first < 0x80) {
        return 1;
    }
    const size_t length = first < 0xc0 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
    if (length == 0 || first > 0xf4 || length > size) {
        return 0;
    }
    unsigned code = first & (0x7fu >> length);
    for (size_t i = 1; i < length; i++) {
        if ((text[i] & 0xc0u) != 0x80u) {
            return 0;
        }
        code = code << 6 | (text[i] & 0x3fu);
    }
    const bool is_surrogate = code >= 0xd800 && code < 0xe000;
    const bool is_no_character = is_surrogate || code == 0xfffe || code == 0xffff;
    return code < SMALLEST[length] || is_no_character || code > 0x10ffff ? 0 : length;
}

size_t source_text_length(const char *text, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)text;
    size_t length = 0;
    while (length < size) {
        const unsigned char c = bytes[length];
        const bool is_control = (c < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7f;
        // U+0080 to U+009F are controls as well, and a terminal obeys them
        const bool is_high_control = c == 0xc2 && length + 1 < size && bytes[length + 1] < 0xa0;
        const size_t step = character_size(bytes + length, size - length);
        if (is_control || is_high_control || step == 0) {
            break;
        }
        length += step;
    }
    return length;
}

size_t source_count(const char *text, size_t size)
{
    size_t count = 0;
    for (size_t i = 0; i < size; i++) {
        count += starts_character(text[i]) ? 1 : 0;
    }
    return count;
}

size_t source_line(const Source *source, size_t character)
{
    return find_place(source, character + source->shift).line;
}

bool source_is_one_line(const char *text, size_t size)
{
    return source_text_length(text, size) == size && strpbrk(text, "\t\n\r") == NULL;
}
