// The runs of a case as one JSON object, for other programs.
#pragma once

#include "commands/run/run_report.h"

#include <jansson.h>

// The whole object; the caller owns the reference. Keys as docs/output.md lists them. A run that
// failed has a status and a message and no numbers. A number that is not finite becomes null.
json_t *run_json_build(const RunReport *report);
