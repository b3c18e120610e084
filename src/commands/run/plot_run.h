// The picture of a run: omega, alpha and joint forces over the crank angle, and the pin in its
// hole; every backend over the others.
#pragma once

#include "base/text.h"
#include "commands/run/run_report.h"

// Appends the picture, as SVG, 1000 pixels wide. Runs that failed are left out.
void plot_run_write(const RunReport *report, Text *svg);
