// The cheapest setting of ODE whose error, found by running it, meets a target; its search, its
// words and its report.
//
// Steps and tolerances come from a grid of preferred numbers, ten to a decade. A setting counts
// only where the next finer one of its scheme meets the target as well: an error that is small by
// luck at one step is no basis for a recommendation.
//
// With a step that is fixed the question is which scheme has the least error at that step, and
// where it does not meet the target, which is the longest step that does.
#pragma once

#include "base/text.h"
#include "measure/constants.h"
#include "measure/ladder.h"
#include "measure/truth.h"
#include "write/table.h"

#include <jansson.h>

enum {
    TUNE_REPEATS = LADDER_REPEAT_LEAST, // timing runs of each finalist
    TUNE_NONE = -1,
    TUNE_LINEAR_MAX = 64,
};

// By what settings are ranked. Time is that of the processor: on an idle machine it is that of the
// clock, and on a busy one it still is. By the length of the step the longest is the cheapest.
typedef enum TuneCost { TUNE_TIME, TUNE_STEPS, TUNE_LENGTH } TuneCost;

// One setting that was run.
typedef struct TuneTrial {
    size_t scheme;
    int index;    // on the grid, counted from the coarsest value
    double value; // step, s; of a scheme that chooses its steps the tolerance, 1
    LadderRun run;
    double error;                     // 1: as of a ladder's point; NAN where there is none
    char reason[LADDER_MESSAGE_SIZE]; // why there is none
    bool meets;                       // the error and the truth's uncertainty are within the target
} TuneTrial;

// How the search of a scheme ended.
typedef enum TuneOutcome {
    TUNE_OPEN,     // not yet
    TUNE_MEETS,    // two neighbours meet the target
    TUNE_COSTLIER, // whatever is left to try costs more than a setting that meets it
    TUNE_STALLED,  // finer steps do not help any more
    TUNE_TOO_LONG  // what is left to try takes longer than a run may, or more steps
} TuneOutcome;

typedef struct TuneScheme {
    Scheme scheme;
    int first; // index of the coarsest setting
    int next;  // index that is to be tried next
    bool is_busy;
    int pending;        // trial that meets the target and is not confirmed yet, or TUNE_NONE
    bool is_going_back; // whether settings before it, which were ruled out, are tried after all
    bool is_by_order;   // whether an order that was observed stands for runs of settings
    TuneOutcome outcome;
    int best;  // trial: the coarsest that is confirmed; TUNE_NONE
    int least; // trial of the least error, or TUNE_NONE
    size_t trials;
    size_t timed; // timing runs made
    double wall_s[TUNE_REPEATS];
    double processor_s[TUNE_REPEATS];
    double wall_median_s; // of the best; NAN where it was not timed
    double processor_median_s;
    double processor_least_s; // settings are ranked by it, for noise can only add
} TuneScheme;

// A limit on what a run may cost; 0 where there is none.
typedef struct TuneLimit {
    double time_s; // of the processor
    size_t steps;
} TuneLimit;

// Where constants come from.
typedef enum TuneLinearSource {
    TUNE_LINEAR_SECANT,  // the law's own spring at a depth
    TUNE_LINEAR_MEDIAN,  // best for an impact of median mass and speed at the step that is held
    TUNE_LINEAR_HARDEST, // likewise, for the hardest impact of the true motion
} TuneLinearSource;

// The contact made linear with constants, run at one step: kp and kd, as Gazebo has them, or a row
// of one ERP and one CFM.
typedef struct TuneLinear {
    TuneLinearSource source;
    bool is_row;      // whether no kp and kd make the row: its ERP may be above 1
    ErpCfm row;       // that is run
    double depth;     // m, at which the spring gives the law's force; NAN of other sources
    double stiffness; // kp, N/m; of a row that of the corrected map
    double damping;   // kd, N s/m
    double step_s;
    LadderRun run;
    double error;                     // as of a trial, against the law itself
    char reason[LADDER_MESSAGE_SIZE]; //
} TuneLinear;

// The joint on which a linear contact is modelled, at its deepest in the true motion.
// Of the limits of a pivot torques and angles are meant.
typedef struct TuneContact {
    bool is_known; // false: no joint with play ever touches
    bool is_limit; // whether they are stops or backlash of one pivot or slider, and not a pin
    size_t joint;
    double depth;       // m, the deepest
    double speed;       // m/s, of the hardest impact there
    double mass;        // kg, effective along the normal there
    double restitution; // 1, that the law delivers; NAN of a viscous damper
    // what is said where no constants are stable
    char unstable[LADDER_MESSAGE_SIZE];
} TuneContact;

// The reference as a way without ODE.
typedef struct TuneReference {
    double tolerance; // reference.tolerance of the loosest that meets the target; 0: none does
    double error;     // 1: as of a trial
    LadderRun run;    // that measured the error
    double processor_median_s;
} TuneReference;

// The program that --code writes, run before it is written.
typedef struct TuneProgram {
    bool is_run;
    int trial;           // whose setting it has, but for the step; TUNE_NONE before it is run
    bool meets;          // its error and the truth's uncertainty are within the target
    double step_first_s; // of the setting that was found
    double error_first;  // 1: with that step; NAN where there is none
    double step_s;       // that the program has: shorter where that step missed the target
    double error;        // 1: against the reference at the times that it prints
    size_t steps;        // calls of jp_world_step
    double processor_s;  // of its run
    char reason[LADDER_MESSAGE_SIZE]; // why there is none
} TuneProgram;

// MuJoCo's whole model with the contact made linear, run there before it is written.
typedef struct TuneModel {
    char *text;                       // owned; NULL: there is none
    double step_s;                    // of the model
    double error;                     // 1: as of a trial, against the law itself
    size_t steps;                     // of its run
    double processor_s;               // likewise
    char engine[LADDER_MESSAGE_SIZE]; // name and version
    char reason[LADDER_MESSAGE_SIZE]; // why there is none
} TuneModel;

// The files in which a setting is handed on.
typedef enum TuneFileKind {
    TUNE_FILE_CODE,
    TUNE_FILE_SDF,
    TUNE_FILE_MJCF,
    TUNE_FILE_COUNT
} TuneFileKind;

// Whether one is asked for: a folder gets those that are within the target, a name any.
typedef enum TuneAsked { TUNE_UNASKED, TUNE_IN_FOLDER, TUNE_NAMED } TuneAsked;

typedef struct Tune {
    double target;  // 1; INFINITY where any error will do
    ToleranceOf of; // which error that is
    double held_s;  // s, the only step that its user can take; 0: any
    size_t samples; // of a run
    double dear_s;  // s: an observed order rules out settings that take longer
    TuneCost cost;
    TuneLimit limit;
    LadderTruth truth;
    size_t scheme_count;
    TuneScheme schemes[SCHEME_MAX];
    size_t trial_count;
    size_t trial_room;
    TuneTrial *trials; // owned; in the order in which they ended
    int winner;        // scheme, or TUNE_NONE
    int plain;         // scheme: the cheapest that needs nothing but a contact's ERP and CFM
    int within;        // trial of the least error within the limit; TUNE_NONE without limit or one
    int held;          // trial of the least error at the step that is held, or TUNE_NONE
    int held_plain;    // likewise, of those that need nothing but a contact's ERP and CFM
    TuneContact contact;
    size_t linear_count;
    TuneLinear linears[TUNE_LINEAR_MAX];
    int linear; // the kp and kd to take, or TUNE_NONE
    int row;    // the ERP and CFM, at a step that is held
    TuneReference reference;
    TuneAsked asked[TUNE_FILE_COUNT];
    TuneProgram program;
    TuneModel model;
} Tune;

// The value of an index of the grid: 1, 0.8, 0.63, 0.5, 0.4, 0.315, 0.25, 0.2, 0.16, 0.125, 0.1,
// ... the R10 series of ISO 3 downwards. Indices may be negative.
double tune_value(int index);

// The index of the largest value of the grid that is not above this one.
int tune_index_below(double value);

// A search with nothing run yet: the schemes of ODE among those given, the several tolerances of
// steps that are chosen as one scheme.
Tune *tune_create(const Scenario *scenario, const Scheme *schemes, size_t scheme_count,
                  double target);
void tune_destroy(Tune *tune);

// The scenario of a setting.
void tune_apply(const TuneScheme *scheme, double value, Scenario *scenario);

// Whether a scheme needs nothing of its user but ERP and CFM of each contact row, and a step.
bool tune_is_plain_row(const Tune *tune, const Scenario *scenario, size_t scheme);

// The error of a run that is over, NAN with the reason where it has none.
double tune_error(const Tune *tune, const LadderRun *run, char reason[LADDER_MESSAGE_SIZE]);

// Takes in a run at an index of a scheme, and moves that scheme on.
void tune_take(Tune *tune, size_t scheme, int index, const LadderRun *run);

// Holds a search with nothing run yet to a step, s: schemes that choose their own are left out, and
// what is searched for, should it come to that, is the longest step below it.
void tune_hold(Tune *tune, double step_s);

// Takes in the run of a scheme at the step that is held.
void tune_take_held(Tune *tune, size_t scheme, const LadderRun *run);

// Whether a run at the step that is held meets the target.
bool tune_is_met_held(const Tune *tune);

// What a setting would cost at the least, in the cost's own unit (s or steps), from the trials of
// its scheme; 0 where there are none. Of one that was run: the least time where it was timed, else
// its work at the rate of its scheme.
double tune_cost(const Tune *tune, size_t scheme, int index);
double tune_time(const Tune *tune, size_t scheme, int index); // s, whatever the cost is
double tune_trial_cost(const Tune *tune, const TuneTrial *trial);

// Whether the run of a trial is within the limit.
bool tune_is_within(const Tune *tune, const TuneTrial *trial);

// Chooses winner, the cheapest plain row, and the least errors within the limit and at a step held.
void tune_conclude(Tune *tune, const Scenario *scenario);

// The trial of the best setting of a scheme, or NULL.
const TuneTrial *tune_best(const Tune *tune, int scheme);

// How long a search will still take.

// The settings of some schemes that a search may still run.
typedef struct TuneLeft {
    bool is_in[SCHEME_MAX];
    double best;      // cost of the best setting that meets the target; INFINITY where none does
    double margin;    // settings that cost more than this times the best are not run
    double limit_s;   // nor settings that take longer
    bool is_reopened; // schemes that were ended because they cost more go on
} TuneLeft;

// The time by the clock, s, of the runs that are to be expected one after another. Errors are taken
// to go on falling as between the last two settings of a scheme; schemes that have not been run are
// left out.
double tune_left(const Tune *tune, const TuneLeft *left);

// Everything there is to tell about a search for the cheapest setting: plain pointers, nothing
// owned.

typedef struct TuneReport {
    const Scenario *scenario;
    const Tune *tune;             // concluded
    const char *const *overrides; // that were given with --set
    size_t override_count;
    double time_limit_s; // of one run
} TuneReport;

// Whether the error asked for is met by a setting that costs no more than what was allowed, or at
// the step that is held.
static inline bool tune_report_is_met(const TuneReport *report)
{
    const TuneTrial *best = tune_best(report->tune, report->tune->winner);
    if (report->tune->held_s > 0.0) {
        return tune_is_met_held(report->tune);
    }
    return best != NULL && tune_is_within(report->tune, best);
}

// Whether a cost was set that nothing may exceed.
static inline bool tune_report_has_limit(const TuneReport *report)
{
    return report->tune->limit.steps > 0 || report->tune->limit.time_s > 0.0;
}

// Each is of a TuneReport: for other programs, a new reference; and for people.
json_t *tune_json_build(const void *report);
void tune_text_write(const void *report, const Style *style, Text *text);
void tune_screen_write(const void *report, const Style *style, Text *text);

// What can be had at a step that is held, for people.

// Appends the constants that were run in the whole mechanism, each with its error.
void tune_held_text_constants(const TuneReport *report, const Style *style, Text *text);

// Appends what one ERP and one CFM for all depths come to.
void tune_held_text_row(const Tune *tune, Text *text);

// Fails with ERR_DIFFERS: nothing at the step meets the error, how near it comes, and the longest
// step that does.
bool tune_held_text_unmet(const TuneReport *report, Err *err);

// Where constants come from, such as "law at 1.2 um".
void tune_held_text_source(const TuneReport *report, const TuneLinear *linear, Text *text);

// A setting in words: its keys of a case, and the command line that runs it.

// Whether a setting replaces what a --set KEY=VALUE gives for its key.
bool tune_setting_replaces(const char *override);

// Appends what a case says for the setting of a trial, each KEY=VALUE by itself, and a separator in
// between.
void tune_setting_keys(const TuneReport *report, const TuneTrial *trial, const char *separator,
                       Text *text);

enum { TUNE_SEPARATOR_SIZE = 64 };

// Appends the command line that runs the setting of a trial and reports its error, as a shell takes
// it; a separator, a blank at least, stands in front of each option.
void tune_setting_command(const TuneReport *report, const TuneTrial *trial, const char *separator,
                          Text *text);

// The scheme and its step or tolerance, for people.
void tune_setting_words(const TuneReport *report, const TuneTrial *trial, Text *text);

// What a setting takes of the processor, s: a median where it was timed, else the one run that
// found its error.
double tune_setting_time(const Tune *tune, const TuneTrial *trial);

// Appends the setting of a trial: its words, error and cost, its keys of a case, and its command
// line.
void tune_setting_write(const TuneReport *report, const TuneTrial *trial, Text *text);
