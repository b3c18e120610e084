// The best constants at a step that cannot be changed.
#pragma once

#include "base/text.h"
#include "measure/held.h"
#include "write/style.h"

#include <jansson.h>

// Appends a table of the best constants and sentences on what they are worth.
void mapping_held_text(const MappingContact *contact, const Style *style, Text *text);

// One object, owned by the caller.
json_t *mapping_held_json(const MappingContact *contact);
