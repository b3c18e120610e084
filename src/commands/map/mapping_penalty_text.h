// The paper's penalty parameter as rows of ODE, for people.
#pragma once

#include "base/text.h"
#include "commands/map/mapping_report.h"
#include "write/style.h"

void mapping_penalty_text_write(const MappingReport *report, const Style *style, Text *text);
