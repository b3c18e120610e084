// A regression check as one JSON object, for other programs.
#pragma once

#include "commands/check/check_report.h"

#include <jansson.h>

// The whole object; the caller owns the reference. Keys as docs/output.md lists them.
json_t *check_json_build(const CheckReport *report);
