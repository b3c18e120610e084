// A comparison: its options, its report, its store and its progress.
#pragma once

#include "base/err.h"
#include "base/text.h"
#include "cli/common_options.h"
#include "cli/status_line.h"
#include "measure/ladder.h"
#include "measure/runner.h"
#include "write/fields.h"
#include "write/journal.h"

#include <jansson.h>
#include <stdbool.h>

// Everything there is to say about a comparison, and the forms in which it is said.

// The usual steps that were left out for the time that they take.
typedef struct LadderLeft {
    double finest_s; // s; 0: none was
    double ratio;    // 1: world steps with them over those without
} LadderLeft;

typedef struct CompareReport {
    const Scenario *scenario;
    const Ladder *ladder; // concluded
    const char *machine;  // the processor that the times are of
    LadderLeft left;
} CompareReport;

// Whether the errors contain more than ODE's own: the reference knows contact by its elastic law
// alone.
static inline bool compare_report_mixes_models(const CompareReport *report)
{
    return report->scenario->contact.model == CONTACT_POISSON &&
           scenario_has_clearance(report->scenario);
}

// The forms, each of a CompareReport. The CSV is a file of its own, a row a point, with its reason
// and no numbers where it failed: ERR_FILE.
void compare_text_write(const void *report, const Style *style, Text *text);
void compare_screen_write(const void *report, const Style *style, Text *text);
bool compare_rows_write_csv(const void *report, const char *path, Err *err);
void compare_plot_write(const void *report, Text *svg);
json_t *compare_json_build(const void *report);

// What `jointplay compare` was asked for.

typedef struct CompareOptions {
    CommonOptions common;
    const char *backends;                   // as given, or NULL: ODE, and the engines of --driver
    const char *drivers[ENGINE_DRIVER_MAX]; // NAME=PROGRAM
    size_t driver_count;
    const char *steps; // as given, or NULL
    size_t repeats;    // 0: as many as are needed
    const char *store; // NULL: the usual one
    bool is_fresh;
    const char *csv;
    const char *plot;
} CompareOptions;

extern const Arguments COMPARE_ARGUMENTS;

// Other engines in a comparison (docs/engines.md).

typedef struct CompareEngines {
    size_t count;
    EngineDriver drivers[ENGINE_DRIVER_MAX];
    bool has_ode;
    size_t scheme_count;
    Scheme schemes[SCHEME_ENGINE_MAX]; // their ways, which point to the drivers
} CompareEngines;

// Finds the engines that --backends and --driver name, and asks them what they are. The caller
// frees it, after the last use of its schemes. NULL: fails with ERR_USAGE, or ERR_SOLVER where a
// program is no driver.
CompareEngines *compare_engines_read(const CompareOptions *options, Err *err);

// Whether each engine, a run of which may take so long, s, takes the scenario, whose start may
// still have to be found, in one of its ways at least. Fails with ERR_CASE, naming what it does not
// take.
bool compare_engines_check(const CompareEngines *engines, const Scenario *scenario,
                           double time_limit_s, Err *err);

// Adds their ways to the schemes of a scenario, and takes ODE's out where it is not asked for.
void compare_engines_apply(const CompareEngines *engines, Scheme *schemes, size_t *count);

// Whether a ladder has other engines than ODE.
bool compare_engines_are_any(const Ladder *ladder);

// New references: which engines there are, in the key of a store and in a result; and for every
// backend the cheapest points.
json_t *compare_engines_key(const Ladder *ladder);
json_t *compare_engines_json(const Ladder *ladder);
json_t *compare_engines_cheapest(const Ladder *ladder);

// What the engine of a scheme says of its settings at its finest step that did not fail; empty
// where there is none.
const char *compare_engines_settings(const Ladder *ladder, size_t scheme);

// A line of the head for each engine; the table of the least times, and that of the ways.
void compare_engines_write(const Ladder *ladder, Text *text);
void compare_engines_write_times(const Ladder *ladder, const Style *style, Text *text);
void compare_engines_write_ways(const Ladder *ladder, const Style *style, Text *text);

// Where a comparison keeps what it has finished, and how it goes on from there.

enum { COMPARE_MACHINE_SIZE = 128 };

typedef struct CompareStore {
    Journal journal;
    const Linkage *linkage;
    const Ladder *ladder;
    char machine[COMPARE_MACHINE_SIZE]; // the processor, as the system names it
    size_t taken;                       // runs that were there
} CompareStore;

// Opens the store that the options name, or the usual one, which is named after its key, and takes
// the runs in it into the ladder. Says on standard error, unless quiet, what was taken. ERR_FILE.
bool compare_store_open(CompareStore *store, const CompareOptions *options,
                        const Scenario *scenario, Ladder *ladder, Err *err);

// The keepers of a runner, with the store as their context.
bool compare_store_keep_truth(const LadderTruth *truth, void *store, Err *err);
bool compare_store_keep_run(const LadderRun *run, void *store, Err *err);
bool compare_store_keep_ensemble(size_t scheme, const LadderEnsemble *ensemble, void *store,
                                 Err *err);

// Accepts a zeroed store.
void compare_store_close(CompareStore *store);

// The runs of a ladder as lines of a store, and back.

// New reference: what must be equal for a stored run to count. The build is a fingerprint of the
// program.
json_t *ladder_json_key(const Ladder *ladder, const Scenario *scenario, const char *build);

// New references, a line each. Times carry the machine they were taken on.
json_t *ladder_json_truth(const LadderTruth *truth);
json_t *ladder_json_run(const Ladder *ladder, const LadderRun *run, const char *machine);
json_t *ladder_json_ensemble(const Ladder *ladder, const Linkage *linkage, size_t scheme,
                             const LadderEnsemble *ensemble);

// What became of a line that was taken.
typedef enum LadderJsonTaken {
    LADDER_JSON_TAKEN,
    LADDER_JSON_UNUSED,        // not of this ladder, or there already
    LADDER_JSON_OTHER_MACHINE, // a time of another machine
    LADDER_JSON_DAMAGED,       // a key is missing or has a value of another type
} LadderJsonTaken;

// Adds a line to the ladder; one that is damaged leaves it as it was.
LadderJsonTaken ladder_json_take(Ladder *ladder, const Linkage *linkage, const json_t *line,
                                 const char *machine);

// How far a comparison has come: a line on standard error, as of a long run, gone at its end.

typedef struct CompareProgress {
    const Ladder *ladder;
    size_t jobs; // error runs at a time
    bool is_announced;
    StatusLine line;
} CompareProgress;

CompareProgress compare_progress_start(const Ladder *ladder, size_t jobs, bool is_quiet);

// Says what is being done, if it is time for a line. Once the pace of every scheme is known, by its
// coarsest step, long work (long_work.h) is announced, with what would take less.
void compare_progress_show(CompareProgress *progress, const char *doing);

// Takes the line away again.
void compare_progress_end(CompareProgress *progress);
