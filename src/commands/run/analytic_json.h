// What the closed form says of a four-bar, as JSON.
#pragma once

#include "commands/run/run_report.h"

#include <jansson.h>

// New references. The report has a summary, or a stack-up.
json_t *analytic_json_kinematics(const RunReport *report);
json_t *analytic_json_forces(const RunReport *report);
json_t *analytic_json_stackup(const RunReport *report);
