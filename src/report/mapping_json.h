// A mapping as one JSON object, for other programs.
#pragma once

#include "report/mapping_report.h"

#include <jansson.h>

// New reference. Keys as docs/output.md lists them.
json_t *mapping_json_build(const MappingReport *report);
