// A regression check as a comment on a change: what moved first, the rest folded away.
#pragma once

#include "base/text.h"
#include "commands/check/check_report.h"

void check_markdown_write(const CheckReport *report, Text *text);
