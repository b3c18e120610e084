// The first screen of a run: what a reader asks first, on 24 lines of 80 columns at most.
#pragma once

#include "commands/run/run_report.h"

enum { RUN_OVERVIEW_LINES = 24 };

// One line: a joint, a body or a drive.
typedef struct OverviewRow {
    const char *name;
    const char *stem;     // what is the largest, in keys: "force" of force_max_N
    const char *unit;     // of that
    const char *unit_key; // in keys
    double largest;       // its size
    double crank_rad;     // where that was; NAN without a crank
    double time_s;        // and when
    double ratio;         // 1, to that with ideal joints; NAN: not known
    double impacts;       // a revolution, or in the run; NAN of what is no joint with play
    double contact;       // 1, share of the time
    double deepest;       // m or rad
    const char *depth;    // unit of that
    // of a motion that does not repeat, of which the numbers above are then, but for angle and
    // time: the largest is the 95 % quantile of its revolutions, as is the deepest, impacts and
    // contact are medians
    const SettledNumber *spread; // of the largest; NULL: the numbers are those of a run
    const SettledJoint *settled; // of a joint
} OverviewRow;

typedef struct Overview {
    const Trajectory *run;       // NULL: none is complete
    const SettledMotion *motion; // that its rows are of; NULL: they are of the run alone
    size_t joint_count;
    OverviewRow *joints; // the largest first; owned, as the next
    size_t body_count;
    OverviewRow *bodies;
    size_t drive_count; // 0 where no torque turns a body
    OverviewRow drives[LINKAGE_DRIVE_MAX];
} Overview;

// Its numbers, for run_overview_free.
Overview run_overview_make(const RunReport *report);
void run_overview_free(Overview *overview);

// Whether its rows are of a motion that does not repeat: each then has a spread.
static inline bool run_overview_is_random(const Overview *overview)
{
    return overview->motion != NULL && overview->motion->period == 0;
}

// What is said below its table: how the motion settled, how far the runs are off, what was assumed.
// Each sentence on a line of its own, not folded.
void run_overview_sentences(const RunReport *report, Text *text);

// Cells of a row of a motion that does not repeat, with no more digits than their intervals leave:
// the 95 % quantile; half the width of its interval, %; the median and the largest, without their
// unit; x ideal; impacts; the share of contact; depth. Empty where there is none.
typedef enum OverviewCell {
    OVERVIEW_HEADLINE,
    OVERVIEW_WIDTH,
    OVERVIEW_MEDIAN,
    OVERVIEW_MOST,
    OVERVIEW_RATIO,
    OVERVIEW_IMPACTS,
    OVERVIEW_CONTACT,
    OVERVIEW_DEPTH,
    OVERVIEW_CELL_COUNT,
} OverviewCell;

void run_overview_cell(const OverviewRow *row, OverviewCell cell, Text *text);

// Of the run that is taken for the truth, or the last that is complete, or of the settled motion
// where that is more than the run shows: of each joint with play its largest force, of each body
// its largest angular acceleration, of each drive its largest torque, each beside that with ideal
// joints; how the motion settled and what the damping does to it; how far ODE is off; and what was
// assumed. The width is that of a style (write/table.h). `is_alone` without the tables of
// run_text.c below it.
void run_overview_write(const RunReport *report, size_t width, bool is_alone, Text *text);

// What the first screen begins with, as soon as there is a reference, of a report of it alone:
// title, table, how the motion settled, how sure it is, what was assumed.
void run_overview_answer(const void *report, const Style *style, Text *text);

// The whole first screen: title and overview.
void run_overview_screen(const void *report, const Style *style, Text *text);

// The same numbers, unrounded, as an object "overview".
void run_overview_json(json_t *object, const RunReport *report);
