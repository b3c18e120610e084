// The values that JSON of this program is made of.
#pragma once

#include <jansson.h>
#include <math.h>
#include <stdio.h>

// JSON knows no infinity and no NaN: they become null.
static inline json_t *json_value_real(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

// Text that may not be UTF-8, such as a path: it becomes what can be read of it.
static inline json_t *json_value_text(const char *text)
{
    json_t *value = json_string(text);
    if (value == NULL) {
        char readable[4096];
        size_t length = 0;
        for (; text[length] != '\0' && length + 1 < sizeof readable; length++) {
            readable[length] = (unsigned char)text[length] < 0x80u ? text[length] : '?';
        }
        readable[length] = '\0';
        value = json_string(readable);
    }
    return value;
}

// Why a truth could not be certified, in words of its own; empty where it was.
static inline json_t *json_value_not_certified(const char *message)
{
    char words[2304];
    snprintf(words, sizeof words, "could not be certified: %s", message);
    return json_value_text(message[0] != '\0' ? words : "");
}

static inline void json_value_set(json_t *object, const char *key, double value)
{
    json_object_set_new(object, key, json_value_real(value));
}
