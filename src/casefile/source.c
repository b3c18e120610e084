// Finds the place in a text that a message points at, and shows it.
//
//     cases/x.yaml:7:46: the pin (10.02 mm) must be smaller than the hole (10.015 mm)
//         crank-coupler: {hole: 10.015 mm, pin: 10.02 mm, width: 13 mm}
//                                               ^~~~~~~~
//     allowed: a pin below 10.015 mm
#include "casefile/source.h"

#include "base/printable.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum {
    MESSAGE_SIZE = 512,
    WINDOW_WIDTH = 70, // characters of a line that are shown
    WINDOW_LEAD = 44,  // of these, in front of a caret that would stand outside
};

// A line and column, and where that line is in the text.
typedef struct Location {
    size_t line;       // from 1
    size_t column;     // from 1, in characters
    size_t line_start; // bytes
    size_t line_end;   // bytes, without the break
} Location;

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

static Location find_location(const Source *source, size_t character)
{
    Location location = {.line = 1, .column = 1};
    size_t byte = 0;
    for (size_t i = 0; i < character && byte < source->size; i++) {
        location.column++;
        if (is_break(source, byte)) {
            location.line++;
            location.column = 1;
            location.line_start = byte + 1;
        }
        do {
            byte++;
        } while (byte < source->size && !starts_character(source->text[byte]));
    }
    location.line_end = location.line_start;
    while (location.line_end < source->size && source->text[location.line_end] != '\n' &&
           source->text[location.line_end] != '\r') {
        location.line_end++;
    }
    return location;
}

// Appends a character as it is shown, a tab as one blank; its columns.
static size_t append_shown(const PrintableCharacter *character, const char *at, Text *text)
{
    if (*at == '\t') {
        text_append(text, " ");
    } else if (character->escape[0] != '\0') {
        text_append(text, "%s", character->escape);
        return strlen(character->escape);
    } else {
        text_append(text, "%.*s", (int)character->size, at);
    }
    return 1;
}

// Appends the part of the line around the caret and the caret below it.
static void append_line(const Source *source, Location location, size_t length, Text *text)
{
    const size_t first = location.column > WINDOW_WIDTH - 16 ? location.column - WINDOW_LEAD : 1;
    text_append(text, "\n    %s", first > 1 ? "..." : "");
    size_t indent = first > 1 ? 3 : 0; // columns in front of the caret
    size_t tail = 0;                   // columns of what it points at
    size_t column = 0;
    for (size_t byte = location.line_start; byte < location.line_end;) {
        const char *at = source->text + byte;
        const PrintableCharacter character = printable_character(at, location.line_end - byte);
        byte += character.size;
        column++;
        if (column >= first && column < first + WINDOW_WIDTH) {
            const size_t width = append_shown(&character, at, text);
            indent += column < location.column ? width : 0;
            // the tail ends where the line does
            tail += column >= location.column && column < location.column + length ? width : 0;
        }
    }
    // behind the end of the line
    indent += location.column > column + 1 ? location.column - column - 1 : 0;
    text_append(text, "%s\n    %*s^", column >= first + WINDOW_WIDTH ? "..." : "", (int)indent, "");
    for (size_t i = 1; i < tail; i++) {
        text_append(text, "~");
    }
}

// Sets the error: the message with its position, the line, and what would be allowed.
static bool set_error(const Source *source, Span span, const char *allowed, Err *err,
                      const char *message)
{
    const Location location = find_location(source, span.start + source->shift);
    char *name = printable_copy(source->name, false);
    Text text;
    text_init(&text);
    if (source->is_option) {
        // a message that begins with the name of a key needs it once
        const bool is_said = strncmp(message, name, strlen(name)) == 0;
        text_append(&text, "%s%s%s", is_said ? "" : name, is_said ? "" : ": ", message);
    } else {
        text_append(&text, "%s:%zu:%zu: %s", name, location.line, location.column, message);
    }
    free(name);
    if (location.line_end > location.line_start) {
        append_line(source, location, span.end > span.start ? span.end - span.start : 1, &text);
    }
    if (allowed != NULL && allowed[0] != '\0') {
        text_append(&text, "\nallowed: %s", allowed);
    }
    err_set_lines(err, source->is_option ? ERR_USAGE : ERR_CASE, text.data);
    text_finish(&text);
    return false;
}

bool source_error(const Source *source, Span span, const char *allowed, Err *err,
                  const char *format, ...)
{
    char message[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    shorten_list(message, sizeof message, format, arguments);
    va_end(arguments);
    return set_error(source, span, allowed, err, message);
}

bool source_refuse(const Source *source, Span span, Err *err, const char *format, va_list arguments)
{
    static const char MARK[] = "\nallowed: ";
    char *words = printable_format(format, arguments);
    char *mark = strstr(words, MARK);
    if (mark != NULL) {
        *mark = '\0';
    }
    char message[MESSAGE_SIZE];
    shorten_copy(message, sizeof message, words);
    set_error(source, span, mark != NULL ? mark + strlen(MARK) : NULL, err, message);
    free(words);
    return false;
}

size_t source_text_length(const char *text, size_t size)
{
    size_t length = 0;
    while (length < size) {
        const PrintableCharacter character = printable_character(text + length, size - length);
        const unsigned code = character.code;
        const bool is_blank = code == '\t' || code == '\n' || code == '\r';
        // U+0080 to U+009F are controls as well, and a terminal obeys them
        const bool is_control = (code < 0x20 && !is_blank) || (code >= 0x7f && code < 0xa0);
        const bool is_no_character = code == 0xfffe || code == 0xffff;
        if (!character.is_text || is_control || is_no_character) {
            break;
        }
        length += character.size;
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
    return find_location(source, character + source->shift).line;
}

size_t source_line_next(SourceCount *count, const Source *source, size_t character)
{
    const size_t wanted = character + source->shift;
    if (count->source != source || wanted < count->character) {
        *count = (SourceCount){.source = source};
    }
    while (count->character < wanted && count->byte < source->size) {
        count->breaks += is_break(source, count->byte) ? 1 : 0;
        count->character++;
        do {
            count->byte++;
        } while (count->byte < source->size && !starts_character(source->text[count->byte]));
    }
    return count->breaks + 1;
}

bool source_is_one_line(const char *text, size_t size)
{
    return source_text_length(text, size) == size && strpbrk(text, "\t\n\r") == NULL;
}
