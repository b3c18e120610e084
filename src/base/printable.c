// Makes text that may be shown as it is.
//
// Escaped are the categories Cc, Cf (but for the signs of Arabic, Syriac and Kaithi that have a
// picture), Zl and Zp of Unicode 15, and what is no character.
#include "base/printable.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct CodeRange {
    unsigned first;
    unsigned last;
} CodeRange;

static const CodeRange HIDDEN[] = {
    {0x00, 0x1f},       {0x7f, 0x9f},       {0xad, 0xad},       {0x61c, 0x61c},
    {0x180e, 0x180e},   {0x200b, 0x200f},   {0x2028, 0x202e},   {0x2060, 0x206f},
    {0xfdd0, 0xfdef},   {0xfeff, 0xfeff},   {0xfff0, 0xfffb},   {0xfffe, 0xffff},
    {0x1bca0, 0x1bca3}, {0x1d173, 0x1d17a}, {0xe0000, 0xe0fff}, {0x110000, 0xffffffff},
};

static bool is_hidden(unsigned code)
{
    if (code >= ' ' && code <= '~') {
        return false;
    }
    for (size_t i = 0; i < sizeof HIDDEN / sizeof *HIDDEN; i++) {
        if (code >= HIDDEN[i].first && code <= HIDDEN[i].last) {
            return true;
        }
    }
    return false;
}

// The bytes of the character at the start, or 0 where it is none (overlong, cut, a surrogate, or
// beyond Unicode's end).
static size_t decode(const unsigned char *text, size_t size, unsigned *code)
{
    static const unsigned SMALLEST[5] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned first = text[0];
    *code = first;
    if (first < 0x80) {
        return 1;
    }
    const size_t length = first < 0xc0 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
    if (length == 0 || first > 0xf4 || length > size) {
        return 0;
    }
    unsigned read = first & (0x7fu >> length);
    for (size_t i = 1; i < length; i++) {
        if ((text[i] & 0xc0u) != 0x80u) {
            return 0;
        }
        read = read << 6 | (text[i] & 0x3fu);
    }
    const bool is_surrogate = read >= 0xd800 && read < 0xe000;
    if (read < SMALLEST[length] || is_surrogate || read > 0x10ffff) {
        return 0;
    }
    *code = read;
    return length;
}

static void write_escape(PrintableCharacter *character)
{
    const unsigned code = character->code;
    char *escape = character->escape;
    if (character->is_text && (code == '\n' || code == '\t' || code == '\r')) {
        snprintf(escape, PRINTABLE_ESCAPE_SIZE, "\\%c",
                 code == '\n'   ? 'n'
                 : code == '\t' ? 't'
                                : 'r');
    } else if (!character->is_text || code < 0x80) {
        snprintf(escape, PRINTABLE_ESCAPE_SIZE, "\\x%02x", code & 0xffu);
    } else {
        snprintf(escape, PRINTABLE_ESCAPE_SIZE, code > 0xffff ? "\\U%08x" : "\\u%04x", code);
    }
}

PrintableCharacter printable_character(const char *text, size_t size)
{
    PrintableCharacter character = {.size = 1};
    const size_t length = decode((const unsigned char *)text, size, &character.code);
    character.is_text = length > 0;
    character.size = length > 0 ? length : 1;
    if (!character.is_text || is_hidden(character.code)) {
        write_escape(&character);
    }
    return character;
}

bool printable_is_shown(const char *text)
{
    size_t size = strlen(text);
    while (size > 0) {
        const PrintableCharacter character = printable_character(text, size);
        if (character.escape[0] != '\0') {
            return false;
        }
        text += character.size;
        size -= character.size;
    }
    return true;
}

// Whether a character begins at an invalid byte: what follows was cut off.
static bool is_cut(const PrintableCharacter *character)
{
    return !character->is_text && character->code >= 0xc2 && character->code <= 0xf4;
}

// The copy; where `marks` is given, a line break stays where it has another byte there, and what
// is left of a character that a message has cut is a question mark.
static char *copy(const char *text, bool keeps_lines, const char *marks)
{
    const size_t size = strlen(text);
    char *target = malloc(size * PRINTABLE_ESCAPE_SIZE + 1);
    assert(target != NULL);
    size_t length = 0;
    for (size_t i = 0; i < size;) {
        PrintableCharacter character = printable_character(text + i, size - i);
        if (marks != NULL && is_cut(&character)) {
            while (i + character.size < size && (text[i + character.size] & 0xc0) == 0x80) {
                character.size++;
            }
            strcpy(character.escape, "?");
        }
        const bool is_line =
            text[i] == '\n' && (keeps_lines || (marks != NULL && marks[i] != '\n'));
        const bool is_shown = is_line || character.escape[0] == '\0';
        const size_t count = is_shown ? character.size : strlen(character.escape);
        memcpy(target + length, is_shown ? text + i : character.escape, count);
        length += count;
        i += character.size;
    }
    target[length] = '\0';
    return target;
}

char *printable_copy(const char *text, bool keeps_lines)
{
    return copy(text, keeps_lines, NULL);
}

static char *put_together(const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, again);
    va_end(again);
    assert(length >= 0);
    char *text = malloc((size_t)length + 1);
    assert(text != NULL);
    vsnprintf(text, (size_t)length + 1, format, arguments);
    return text;
}

char *printable_format(const char *format, va_list arguments)
{
    // once more with another byte for the format's own line breaks: they are where the two differ
    char *marked = strdup(format);
    assert(marked != NULL);
    for (char *c = marked; *c != '\0'; c++) {
        *c = *c == '\n' ? '\r' : *c;
    }
    va_list again;
    va_copy(again, arguments);
    char *text = put_together(format, arguments);
    char *marks = put_together(marked, again);
    va_end(again);
    char *shown = copy(text, false, marks);
    free(marked);
    free(marks);
    free(text);
    return shown;
}

static const char MORE[] = " ...";

void shorten_copy(char *target, size_t size, const char *source)
{
    if (strlen(source) < size || size <= sizeof MORE) {
        snprintf(target, size, "%s", source);
        return;
    }
    const size_t room = size - sizeof MORE;
    size_t length = room;
    while (length > 0 && source[length] != ' ') {
        length--;
    }
    if (length < room / 2) {
        // between two characters, which may have several bytes
        length = room;
        while (length > 0 && ((unsigned char)source[length] & 0xc0u) == 0x80u) {
            length--;
        }
    }
    snprintf(target, size, "%.*s%s", (int)length, source, MORE);
}

void shorten_list(char *target, size_t size, const char *format, va_list arguments)
{
    char *text = printable_format(format, arguments);
    shorten_copy(target, size, text);
    free(text);
}
