// What a start of a check measured, and what it was held against, as lines of a journal.
#pragma once

#include "commands/check/check_measure.h"

#include <jansson.h>

// New reference: {"start": [member, share, shake], "metrics": [...]}. The measure is complete.
json_t *measure_json_build(CheckStart start, const CheckMeasure *measure);

// Whether a line is of that start; it then fills the measure. False also where it is damaged.
bool measure_json_take(const json_t *line, CheckStart start, CheckMeasure *measure);

// The same of a plan, with the reason why it has no truth, which is empty where it has one and cut
// where it does not fit.
json_t *measure_json_plan(const CheckPlan *plan, const char *no_truth);
bool measure_json_take_plan(const json_t *line, CheckPlan *plan, char *no_truth, size_t size);
