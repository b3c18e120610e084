// The picture of a study: one of its columns over another.
#pragma once

#include "base/text.h"
#include "commands/study/store.h"

typedef struct StudyPlot {
    const char *title; // NULL: what is drawn
    const char *x;     // a column of numbers
    const char *y;     // NULL: how often each value of x occurs
    const char *by;    // a colour for each value of this column of the settings; NULL: one for all
} StudyPlot;

// Appends the picture as SVG, 1000 pixels wide: where many runs share each x, their median as a
// line with a band from 5 to 95 %, else a dot a run. An axis is logarithmic where its values are
// positive and spread over more than a decade and a half. Runs without a result are left out and
// counted. Fails with ERR_FILE, or with ERR_USAGE where there is no such column or nothing to draw.
bool study_plot_write(Store *store, const StudyPlot *plot, Text *svg, Err *err);
