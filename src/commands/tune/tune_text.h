// A search for the cheapest setting, for people.
#pragma once

#include "base/text.h"
#include "commands/tune/tune_report.h"
#include "write/style.h"

void tune_text_write(const TuneReport *report, const Style *style, Text *text);
