// A search for the cheapest setting, for people.
#pragma once

#include "base/text.h"
#include "report/style.h"
#include "report/tune_report.h"

void tune_text_write(const TuneReport *report, const Style *style, Text *text);
