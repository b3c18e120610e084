// Is a line of a store one that this program could have written?
#pragma once

#include "model/linkage.h"

#include <jansson.h>

// Whether the line has the keys of its kind, each with a value of its type. Keys beyond them do no
// harm.
bool ladder_shape_is_right(const json_t *line, const Linkage *linkage);
