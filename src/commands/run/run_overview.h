// The first screen of a run: what a reader asks first, on 24 lines of 80 columns at most.
#pragma once

#include "commands/run/run_report.h"

enum { RUN_OVERVIEW_LINES = 24 };

// One line: a joint, a body or a drive.
typedef struct OverviewRow {
    const char *name;
    const char *number;   // what is the largest, in keys
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
} OverviewRow;

typedef struct Overview {
    const Trajectory *run; // NULL: none is complete
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

// What is said below its table: how the motion settled, how far the runs are off, what was assumed.
// Each sentence on a line of its own, not folded.
void run_overview_sentences(const RunReport *report, Text *text);

// Of the run that is taken for the truth, or the last that is complete: of each joint with play its
// largest force, of each body its largest angular acceleration, of each drive its largest torque,
// each beside that with ideal joints; how the motion settled and what the damping does to it; how
// far ODE is off; and what was assumed. `is_alone` without the tables of run_text.c below it.
void run_overview_write(const RunReport *report, bool is_alone, Text *text);

// The whole first screen: title and overview.
void run_overview_screen(const void *report, const Style *style, Text *text);

// The same numbers, unrounded, as an object "overview".
void run_overview_json(json_t *object, const RunReport *report);
