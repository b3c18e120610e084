// What `jointplay compare` prints for people.
#pragma once

#include "base/text.h"
#include "commands/compare/compare_report.h"
#include "write/style.h"

// The whole report: the truth, every point, the orders, the cheapest settings, and where the truth
// is limited by a horizon what lies beyond.
void compare_text_write(const CompareReport *report, const Style *style, Text *text);

// The distributions of an ensemble, one row a scheme and joint; nothing where there is none.
void compare_spread_write(const CompareReport *report, const Style *style, Text *text);
