// A regression check for people: a table a case, the worst first.
#pragma once

#include "base/text.h"
#include "commands/check/check_report.h"
#include "write/style.h"

// Appends the report; `is_all` for every number, else the worst of each case.
void check_text_write(const CheckReport *report, bool is_all, const Style *style, Text *text);
