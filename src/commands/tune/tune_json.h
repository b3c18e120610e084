// A search for the cheapest setting, for other programs.
#pragma once

#include "commands/tune/tune_report.h"

#include <jansson.h>

// New reference.
json_t *tune_json_build(const TuneReport *report);
