// A regression check as JUnit XML, which CI systems show: a suite a case, a test a number.
#pragma once

#include "base/text.h"
#include "commands/check/check_report.h"

// Appends the whole document.
void check_junit_write(const CheckReport *report, Text *text);
