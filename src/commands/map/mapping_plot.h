// What each map delivers over the step, as a picture: a pair of panels a contact.
#pragma once

#include "base/text.h"
#include "commands/map/mapping_report.h"

// Appends the SVG.
void mapping_plot_write(const MappingReport *report, Text *svg);
