// The runs of a case as one JSON object, for other programs.
#pragma once

#include "report/run_report.h"

#include <jansson.h>

// Numbers are written with 17 significant digits; compact lines are for nobody.
enum { RUN_JSON_FLAGS = JSON_REAL_PRECISION(17) | JSON_INDENT(2) };

// The whole object; the caller owns the reference. Keys as docs/output.md lists them. A run that
// failed has a status and a message and no numbers. A number that is not finite becomes null.
json_t *run_json_build(const RunReport *report);
