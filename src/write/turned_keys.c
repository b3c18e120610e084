// What are the keys of what turns called?
#include "write/turned_keys.h"

#include <stdio.h>
#include <string.h>

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

json_t *turned_keys(json_t *value)
{
    if (json_is_array(value)) {
        for (size_t i = 0; i < json_array_size(value); i++) {
            json_array_set_new(value, i, turned_keys(json_incref(json_array_get(value, i))));
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
        json_object_set_new(made, turned, turned_keys(json_incref(member)));
    }
    json_decref(value);
    return made;
}
