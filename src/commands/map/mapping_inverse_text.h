// What an ERP and a CFM stand for: for people, and as one JSON object.
#pragma once

#include "base/text.h"
#include "commands/map/mapping_inverse.h"
#include "write/style.h"

#include <jansson.h>

void mapping_inverse_text(const Inverse *inverse, const Style *style, Text *text);

// New reference. Keys as docs/output.md lists them.
json_t *mapping_inverse_json(const Inverse *inverse);
