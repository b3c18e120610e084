// Breaks the lines of a text on a page of given width.
#include "base/text.h"

#include <stdbool.h>
#include <string.h>

enum {
    FOLD_CODE = 4,       // an indentation that is no prose's
    FOLD_LABEL_MAX = 24, // characters in front of the words of "  name   words"
    UNIT_MAX = 3,        // letters
    FOLD_ROOM_MIN = 20,  // characters a line has for words, whatever it is indented by
};

size_t text_width(const char *text, size_t size)
{
    size_t width = 0;
    for (size_t i = 0; i < size && text[i] != '\0'; i++) {
        if (text[i] == '\x1b') {
            i += strcspn(text + i, "m");
            continue;
        }
        width += ((unsigned char)text[i] & 0xc0u) != 0x80u ? 1 : 0;
    }
    return width;
}

// The columns in front of what follows a line's first part.
static size_t find_hang(const char *line, size_t indent, size_t length, size_t width)
{
    size_t hang = indent;
    for (size_t i = indent; i + 2 < length && i < FOLD_LABEL_MAX; i++) {
        if (line[i] == ' ' && line[i + 1] == ' ') {
            const size_t words = i + strspn(line + i, " ");
            hang = words < length ? text_width(line, words) : hang;
            break;
        }
    }
    return hang + FOLD_ROOM_MIN > width ? indent : hang;
}

// The bytes that a line takes of a stretch, up to a blank; the whole where no blank is early
// enough.
static size_t find_break(const char *line, size_t length, size_t first, size_t room)
{
    size_t last = 0;
    size_t in_unit = 0; // in front of a unit, where no other blank will do
    for (size_t i = first; i < length; i++) {
        if (line[i] != ' ') {
            continue;
        }
        if (text_width(line, i) > room) {
            return last > 0 ? last : in_unit > 0 ? in_unit : i;
        }
        // a number stays with its unit
        const bool is_number = i > first && line[i - 1] >= '0' && line[i - 1] <= '9' &&
                               strcspn(line + i + 1, " ,;:\n") <= UNIT_MAX;
        last = is_number ? last : i;
        in_unit = is_number ? i : in_unit;
    }
    return last > 0 ? last : in_unit > 0 ? in_unit : length;
}

static void fold_line(const char *line, size_t length, size_t width, Text *target)
{
    const size_t indent = strspn(line, " ");
    const size_t hang = find_hang(line, indent, length, width);
    size_t moved = 0; // columns in front of the stretch
    size_t first = hang > indent ? hang : indent;
    while (moved + text_width(line, length) > width) {
        const size_t size = find_break(line, length, first, width - moved);
        text_append(target, "%*s%.*s\n", (int)moved, "", (int)size, line);
        const size_t skipped = size < length ? size + 1 : size;
        line += skipped;
        length -= skipped;
        moved = hang;
        first = 1;
        if (length == 0) {
            return;
        }
    }
    text_append(target, "%*s%.*s\n", (int)moved, "", (int)length, line);
}

// Whether a line is a row of a table, or code: it has more than one gap between its words.
static bool is_set_out(const char *line, size_t length)
{
    const size_t indent = strspn(line, " ");
    size_t gaps = 0;
    for (size_t i = indent; i + 1 < length; i++) {
        gaps += line[i] == ' ' && line[i + 1] == ' ' && line[i - 1] != ' ' ? 1 : 0;
    }
    return indent >= FOLD_CODE || gaps > 1;
}

void text_fold(Text *text, size_t width)
{
    if (width == 0) {
        return;
    }
    Text target;
    text_init(&target);
    const char *line = text->data;
    while (*line != '\0') {
        const size_t length = strcspn(line, "\n");
        if (is_set_out(line, length) || text_width(line, length) <= width) {
            text_append_bytes(&target, line, length);
            text_append_bytes(&target, "\n", 1);
        } else {
            fold_line(line, length, width, &target);
        }
        line += length + (line[length] == '\n' ? 1 : 0);
    }
    // a last line without its end stays without one
    const bool has_end = text->length > 0 && text->data[text->length - 1] == '\n';
    if (!has_end && target.length > 0) {
        target.data[--target.length] = '\0';
    }
    text_finish(text);
    *text = target;
}

void text_fold_behind(Text *text, size_t start, size_t width)
{
    Text words;
    text_init(&words);
    text_append_bytes(&words, text->data + start, text->length - start);
    text_fold(&words, width);
    text->length = start;
    text->data[start] = '\0';
    text_append_bytes(text, words.data, words.length);
    text_finish(&words);
}
