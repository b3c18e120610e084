// How often does each value occur? The bars of a picture of a study.
#pragma once

#include "commands/study/study_points.h"
#include "write/plot.h"

// Draws the shares of each group's runs over the panel's x axis, with the median and the 5 and 95 %
// of all; chooses the other axis, and whole bars where the column's numbers are.
void study_histogram_draw(const StudyPoints *points, const Column *column, PlotPanel *panel,
                          PlotStyle (*style_of)(size_t group));
