// What `jointplay paper --json` prints.
#pragma once

#include "commands/paper/paper.h"

#include <jansson.h>

// One object; the caller owns it and gives it up with json_decref. Units stand in the keys.
json_t *paper_json_make(const void *result);
