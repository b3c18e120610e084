// The picture of a comparison: error over wall time, a line a scheme, the frontier beneath them.
#pragma once

#include "base/text.h"
#include "commands/compare/compare_report.h"

// Appends the picture, as SVG, 1000 pixels wide. Points that failed are left out and counted.
void compare_plot_write(const CompareReport *report, Text *svg);
