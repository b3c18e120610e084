// Builds JSON values, and names the keys of what turns.
#include "write/json_value.h"
#include "base/printable.h"

#include <assert.h>
#include <stdio.h>
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

// The keys of what turns.

// The longest of those that one key may end in comes first.
static const struct {
    const char *pushes;
    const char *turns;
} UNITS[] = {
    {"_m_N_s", "_rad_N_m_s"}, {"_N_s_m", "_N_m_s_rad"}, {"_N_m", "_N_m_rad"}, {"_N_s", "_N_m_s"},
    {"_m_s", "_rad_s"},       {"_kg", "_kg_m2"},        {"_N", "_N_m"},       {"_m", "_rad"},
};

void turned_key(const char *key, char turned[TURNED_KEY_SIZE])
{
    const size_t length = strlen(key);
    for (size_t i = 0; i < sizeof UNITS / sizeof *UNITS; i++) {
        const size_t unit = strlen(UNITS[i].pushes);
        if (length > unit && strcmp(key + length - unit, UNITS[i].pushes) == 0) {
            snprintf(turned, TURNED_KEY_SIZE, "%.*s%s", (int)(length - unit), key, UNITS[i].turns);
            return;
        }
    }
    snprintf(turned, TURNED_KEY_SIZE, "%s", key);
}

json_t *torsional_keys(json_t *value)
{
    if (json_is_array(value)) {
        for (size_t i = 0; i < json_array_size(value); i++) {
            json_array_set_new(value, i, torsional_keys(json_incref(json_array_get(value, i))));
        }
        return value;
    }
    if (!json_is_object(value)) {
        return value;
    }
    json_t *made = json_object();
    const char *key;
    json_t *member;
    json_object_foreach(value, key, member)
    {
        char turned[TURNED_KEY_SIZE];
        turned_key(key, turned);
        json_object_set_new(made, turned, torsional_keys(json_incref(member)));
    }
    json_decref(value);
    return made;
}
