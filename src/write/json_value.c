// How does text of a user's stand in JSON?
#include "write/json_value.h"

#include "base/printable.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

json_t *json_value_text(const char *text)
{
    json_t *value = json_string(text);
    if (value == NULL) {
        char *shown = printable_copy(text, true);
        value = json_string(shown);
        free(shown);
    }
    return value;
}

json_t *json_value_not_certified(const char *message)
{
    char words[2304];
    snprintf(words, sizeof words, "could not be certified: %s", message);
    return json_value_text(message[0] != '\0' ? words : "");
}

// \u202e; beyond U+FFFF two of them.
static void append_escape(Text *text, unsigned code)
{
    if (code > 0xffff) {
        const unsigned beyond = code - 0x10000;
        text_append(text, "\\u%04x\\u%04x", 0xd800u + (beyond >> 10), 0xdc00u + (beyond & 0x3ffu));
    } else {
        text_append(text, "\\u%04x", code);
    }
}

void json_value_write(const json_t *value, size_t flags, Text *text)
{
    char *words = json_dumps(value, flags);
    assert(words != NULL);
    size_t size = strlen(words);
    // what the library writes as it is stands in strings alone, but for its own line breaks
    for (const char *at = words; size > 0;) {
        const PrintableCharacter character = printable_character(at, size);
        if (character.escape[0] != '\0' && *at != '\n') {
            append_escape(text, character.code);
        } else {
            text_append_bytes(text, at, character.size);
        }
        at += character.size;
        size -= character.size;
    }
    free(words);
}
