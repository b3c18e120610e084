// What the closed form says of a four-bar, for people: kinematics, forces, tolerance stack-up.
#pragma once

#include "base/text.h"
#include "commands/run/run_report.h"
#include "write/style.h"

// Each writes nothing where the report has nothing to say of it.
void analytic_text_kinematics(const RunReport *report, const Style *style, Text *text);
void analytic_text_forces(const RunReport *report, const Style *style, Text *text);
void analytic_text_stackup(const RunReport *report, const Style *style, Text *text);
