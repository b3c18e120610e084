// The picture of a study: one of its columns over another, or the distribution of one.
#pragma once

#include "base/text.h"
#include "commands/study/spec.h"
#include "commands/study/store.h"
#include "write/plot.h"

typedef struct StudyPlot {
    const char *title; // NULL: what is drawn
    const char *x;     // a column of numbers
    const char *y;     // NULL: how often each value of x occurs
    const char *by;    // a colour for each value of this column of the settings; NULL: one for all
    bool is_small;     // 560 pixels wide, the legend below: for a page, which a phone may show
} StudyPlot;

// Appends the picture as SVG, 1000 pixels wide: where many runs share each x, their median as a
// line with a band from 5 to 95 %, else a dot a run. Columns have the words, units and scales of
// study_label.h, with the study or, where it is NULL, without. An axis that the study does not
// decide about is logarithmic where its values are positive and spread over more than a decade and
// a half. Runs without a result are left out and counted. Fails with ERR_FILE, or with ERR_USAGE
// where there is no such column or nothing to draw.
bool study_plot_write(Store *store, const StudyPlot *plot, const Spec *spec, Text *svg, Err *err);

// What a picture of a study shows of its runs: two numbers of each, and the group it belongs to.

enum { STUDY_GROUP_MAX = 8 }; // that can be told apart in a picture

typedef struct StudyPoint {
    double x;
    double y;
    size_t group;
} StudyPoint;

// The points of all groups, by rising group, then x, then y.
typedef struct StudyPoints {
    size_t count;
    StudyPoint *points; // owned
    size_t group_count; // at least 1
    size_t by;          // the column of the groups; used where there is more than one value
    Cell groups[STUDY_GROUP_MAX];
    size_t first[STUDY_GROUP_MAX + 1]; // where each group begins, and where the last one ends
    size_t x_count;                    // different values of x
    uint64_t left_out;                 // runs without one of the numbers
} StudyPoints;

// Reads them. Without y (NULL) all y are 0, without `by` there is one group. Fails with ERR_FILE,
// or with ERR_USAGE where there is no such column, it has too many values, or there are no points;
// the points are then empty.
bool study_points_read(Store *store, const char *x, const char *y, const char *by,
                       StudyPoints *points, Err *err);

// Accepts zeroed points.
void study_points_finish(StudyPoints *points);

// How often does each value occur? The bars of a picture of a study.

// Draws the shares of each group's runs over the panel's x axis, with the median and the 5 and 95 %
// of all; chooses the other axis, and whole bars where the column's numbers are.
void study_histogram_draw(const StudyPoints *points, const Column *column, PlotPanel *panel,
                          PlotStyle (*style_of)(size_t group));
