// A regression check for people: a table a case, the worst first.
#pragma once

#include "base/text.h"
#include "commands/check/check_report.h"
#include "write/style.h"

// Appends the report.
void check_text_write(const CheckReport *report, const Style *style, Text *text);
