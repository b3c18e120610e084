// The first screen of a run: what a reader asks first, on 24 lines of 80 columns at most.
#pragma once

#include "commands/run/run_report.h"

enum { RUN_OVERVIEW_LINES = 24 };

// What a cell of a row is. Keys, intervals and words of each are in run_overview.c.
typedef enum OverviewQuantity {
    OVERVIEW_LARGEST, // N, N m, rad/s^2; of a motion that does not repeat the 95 % quantile of its
                      // revolutions
    OVERVIEW_MEDIAN,  // of these, as the next: of such a motion alone
    OVERVIEW_MOST,
    OVERVIEW_WIDTH,   // 1: half the interval of the quantile, to its wider side, over that
    OVERVIEW_CRANK,   // rad, where the largest was; NAN without a crank
    OVERVIEW_TIME,    // s, when
    OVERVIEW_RATIO,   // 1, to that with ideal joints
    OVERVIEW_IMPACTS, // a revolution, or in the run; as all below of joints with play
    OVERVIEW_CONTACT, // 1, share of the time
    OVERVIEW_DEEPEST, // m or rad
    OVERVIEW_DEEPEST_MEDIAN,
    OVERVIEW_DEEPEST_MOST,
    OVERVIEW_QUANTITY_COUNT,
} OverviewQuantity;

enum { OVERVIEW_KEY_SIZE = 48 };

// A quantity of a row: what JSON and the screen have of it.
typedef struct OverviewCell {
    bool is_there;               // the row has it, though it may not be known
    char key[OVERVIEW_KEY_SIZE]; // in JSON, without the unit
    const char *unit_key;        // in JSON, NULL without one
    const char *unit;            // for people, SI; NULL without one
    double value;                // SI; NAN: not known
    bool has_interval;           // it lies from `low` to `high`, INFINITY where that is not known
    double low;
    double high;
} OverviewCell;

// One line: a joint, a bushing, a body or a drive.
typedef struct OverviewRow {
    const char *name;
    OverviewCell cells[OVERVIEW_QUANTITY_COUNT];
} OverviewRow;

typedef struct Overview {
    const Trajectory *run;       // NULL: none is complete
    const SettledMotion *motion; // that its rows are of; NULL: they are of the run alone
    size_t joint_count;
    OverviewRow *joints; // with play, the largest first; owned, as the two below
    size_t ideal_count;
    OverviewRow *ideal_joints; // those without, of the run
    size_t bushing_count;
    OverviewRow *bushings; // of the run, at its samples; owned
    size_t body_count;
    OverviewRow *bodies;
    size_t drive_count; // 0 where no torque turns a body
    OverviewRow drives[LINKAGE_DRIVE_MAX];
} Overview;

// Its numbers, for run_overview_free.
Overview run_overview_make(const RunReport *report);
void run_overview_free(Overview *overview);

// Whether its rows are of a motion that does not repeat: each then has intervals.
static inline bool run_overview_is_random(const Overview *overview)
{
    return overview->motion != NULL && overview->motion->period == 0;
}

// What is said below its table: how the motion settled, how far the runs are off, what was assumed.
// Each sentence on a line of its own, not folded.
void run_overview_sentences(const RunReport *report, Text *text);

// The columns of its rows that any of them has a number in, with a title for a screen, and one for
// a page.
typedef struct OverviewColumn {
    OverviewQuantity quantity;
    const char *title;
    const char *unit;
    const char *page_title;
    bool is_minor;
} OverviewColumn;

enum { OVERVIEW_COLUMN_MAX = 8 };

size_t run_overview_columns(const Overview *overview, bool has_crank,
                            OverviewColumn columns[OVERVIEW_COLUMN_MAX]);

// Whether ideal joints stand among the rows of a screen or page: not where these are of a motion
// that is more than the run.
static inline bool run_overview_has_ideal(const Overview *overview)
{
    return overview->motion == NULL;
}

// What stands before the names of drives: of several each has that of its joint.
static inline const char *run_overview_drive_kind(const Overview *overview)
{
    return overview->drive_count > 1 ? "drive " : "";
}

// Appends a cell of a row as people read it, with no more digits than its interval leaves. Nothing
// where it is not known.
void run_overview_cell(const OverviewRow *row, OverviewQuantity quantity, Text *text);

// Of the run that is taken for the truth, or the last that is complete, or of the settled motion
// where that is more than the run shows: of each joint with play and each bushing its largest
// force, of each body its largest angular acceleration, of each drive its largest torque, each
// beside that with ideal joints; how the motion settled and what the damping does to it; how far
// ODE is off; and what was assumed. The width is that of a style (write/table.h). `is_alone`
// without the tables of run_text.c below it.
void run_overview_write(const RunReport *report, size_t width, bool is_alone, Text *text);

// What the first screen begins with, as soon as there is a reference, of a report of it alone:
// title, table, how the motion settled, how sure it is, what was assumed.
void run_overview_answer(const void *report, const Style *style, Text *text);

// The whole first screen: title and overview.
void run_overview_screen(const void *report, const Style *style, Text *text);

// The same numbers, unrounded, as an object "overview".
void run_overview_json(json_t *object, const RunReport *report);

// How many rows of each kind a table shows, and on how wide a screen.
typedef struct OverviewRows {
    size_t joints; // with play
    size_t ideals; // without
    size_t named;  // without, in a line where no row is of any
    size_t bushings;
    size_t bodies;
    size_t width; // characters; 0: any number
} OverviewRows;

// Writes the table of the first screen. Returns whether it says that --full has what there is no
// room for.
bool run_overview_table(const Overview *overview, const Scenario *scenario, OverviewRows rows,
                        Text *text);
