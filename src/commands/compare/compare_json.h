// A comparison as one JSON object, for other programs.
#pragma once

#include "commands/compare/compare_report.h"

#include <jansson.h>

// The whole object; the caller owns the reference. Keys as docs/output.md lists them. A point that
// failed has a status and a message and no numbers.
json_t *compare_json_build(const CompareReport *report);
