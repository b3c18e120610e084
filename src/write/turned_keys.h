// Keys of JSON of what turns: torques, angles and inertias where others have forces, lengths and
// masses.
#pragma once

#include <jansson.h>

// The key of what turns for one of what pushes, by the unit that it ends in: force_max_N_m for
// force_max_N. Keys without such a unit stay. The buffer is filled.
enum { TURNED_KEY_SIZE = 64 };
void turned_key(const char *key, char turned[TURNED_KEY_SIZE]);

// The same value with such keys in all its objects, in their order; a new reference, for the one
// given, which is taken.
json_t *turned_keys(json_t *value);
