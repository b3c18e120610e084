// Schemes over a ladder of steps: which runs there are to make, what came of them, and what it
// says about speed against error.
#pragma once

#include "measure/ensemble.h"
#include "measure/error.h"
#include "measure/scheme.h"
#include "measure/truth.h"

#include <stdbool.h>
#include <stddef.h>

// The power of the step with which an error falls.

typedef struct Order {
    bool is_known; // false: no three steps in a row fall alike
    double order;  // 1: error ~ step^order
    size_t first;  // of the steps the fit is over, in the order given
    size_t last;   //
    size_t points; // of the fit
    double from_s; // its coarsest and its finest step
    double to_s;   //
    double spread; // 1: largest less smallest of the orders from one step to the next in there
} Order;

// Fits the order by least squares of log error on log step, over the asymptotic range: the longest
// run of consecutive steps, at least three, from each to the next of which the error falls at
// orders no further apart than ORDER_AGREEMENT and not below ORDER_LEAST. Of two as long, the
// finer one. Steps, s, come coarse to fine. An error that is not above the floor, or is not
// finite, belongs to no range and divides those on its two sides.
Order order_fit(size_t count, const double *steps, const double *errors, double floor);

enum {
    LADDER_STEP_MAX = 32,
    LADDER_REPEAT_MAX = 100,
    LADDER_REPEAT_LEAST = 5, // fewer make no median
    LADDER_MESSAGE_SIZE = 512,
    LADDER_TARGET_COUNT = 4,
};

extern const double LADDER_TARGETS[LADDER_TARGET_COUNT]; // errors for which the cheapest is named

typedef enum LadderKind {
    LADDER_ERROR,  // held against the truth
    LADDER_TIMING, // once more, for its time alone
} LadderKind;

// What came of one run. It holds no pointers that matter, so that it can cross a pipe.
typedef struct LadderRun {
    LadderKind kind;
    size_t point;
    size_t round;                      // of LADDER_TIMING, from 0
    bool is_complete;                  // false: the message says why
    bool is_lost;                      // it died or hung: another try may end otherwise
    char message[LADDER_MESSAGE_SIZE]; // of a complete run what another engine says of its settings
    TrajectoryError error;             // of LADDER_ERROR; `against` is NULL
    size_t steps;
    size_t evaluations;
    double wall_s;      // of the stepping loop
    double processor_s; // of the whole run, its setting up included; 0 from a store
    uint64_t hash;
} LadderRun;

// One scheme at one step.
typedef struct LadderPoint {
    size_t scheme;
    const char *name; // of the scheme
    bool is_first;    // of its scheme
    double step_s;    // 0 where the scheme chooses its own
    bool is_measured;
    // whether there is no need to: neither it nor a finer one can come to the frontier
    bool is_left_out;
    LadderRun run;                            // LADDER_ERROR, where it is measured
    bool is_timed[LADDER_REPEAT_MAX];         // by round
    double wall_s[LADDER_REPEAT_MAX];         // likewise; NAN where the run failed
    char timing_message[LADDER_MESSAGE_SIZE]; // of the first timing run that failed
    // set by ladder_conclude
    bool is_failed;                   // there are no numbers, for the reason below
    char reason[LADDER_MESSAGE_SIZE]; // or why it has no error though it did not fail
    double error;                     // 1: within the horizon; NAN where there is none
    bool is_limited_by_truth;         // the error is below ten times the truth's uncertainty
    double wall_median_s;             // NAN where it failed or is not timed
    double wall_min_s;
    double wall_max_s;
    bool is_on_frontier;
} LadderPoint;

// What there is to know of the truth without its trajectory.
typedef struct LadderTruth {
    bool is_known;
    char backend[LINKAGE_NAME_SIZE];
    double uncertainty; // as those of Truth
    double horizon_s;
    double growth;
    bool is_limited;
    double wall_s;                     // that it took to make and certify it
    char message[LADDER_MESSAGE_SIZE]; // why it could not be certified; empty where it was
} LadderTruth;

// The distributions beyond the horizon of one scheme at its finest step that did not fail.
typedef struct LadderEnsemble {
    bool is_known;
    double step_s;
    Ensemble ensemble;
} LadderEnsemble;

typedef struct Ladder {
    size_t scheme_count;
    Scheme schemes[SCHEME_MAX];
    size_t step_count;
    double steps[LADDER_STEP_MAX]; // s, coarse to fine
    size_t repeats;                // timing runs of each point
    size_t samples;                // of a run; 0: not known
    bool is_whole; // whether no point, and no timing run for it is clear, is left out
    LadderTruth truth;
    size_t point_count;
    LadderPoint *points; // owned; scheme by scheme, coarse to fine
    size_t *error_order; // owned; the points as their error runs are made: step by step
    LadderEnsemble ensembles[SCHEME_MAX];
    // set by ladder_conclude
    Order orders[SCHEME_MAX];             // by scheme; of the steps of the ladder
    size_t cheapest[LADDER_TARGET_COUNT]; // points; point_count where none meets the target
} Ladder;

// What a truth says of itself, and the wall time, s, that it took.
LadderTruth ladder_truth_of(const Truth *truth, double wall_s);

// A ladder with nothing run yet, which is whole. Steps come coarse to fine.
Ladder *ladder_create(const Scheme *schemes, size_t scheme_count, const double *steps,
                      size_t step_count, size_t repeats);
void ladder_destroy(Ladder *ladder);

// The point of a scheme at a step, or point_count.
size_t ladder_find(const Ladder *ladder, const char *scheme, double step_s);

// Adds a run that is over, and leaves out the points that need not be run after it. False where the
// ladder has no such point, or has that run already.
bool ladder_add(Ladder *ladder, const LadderRun *run);

// The next run from a number on that has not been made, or ladder_run_total: first the error runs
// of all points, the coarsest step of every scheme first, so that the pace of each is known early;
// then round by round the timing runs of all points that did not fail and whose time is not yet
// known well enough.
size_t ladder_next(const Ladder *ladder, size_t from);
size_t ladder_run_total(const Ladder *ladder);
// The runs that are made or need not be made any more.
size_t ladder_run_done(const Ladder *ladder);
// Those that are made alone.
size_t ladder_run_made(const Ladder *ladder);
// Kind, point and round of a run by its number.
LadderRun ladder_run(const Ladder *ladder, size_t number);

// Whether the coarsest step of every scheme with steps has been run, and one of them to its end.
bool ladder_has_pace(const Ladder *ladder);

// How long the runs still to be made will take, s, from those that were: of each scheme the finest.
// Error runs are made `jobs` at a time. Of schemes that choose their steps what is not known is
// left out.
double ladder_time_left(const Ladder *ladder, size_t jobs);

// How long a ladder of the first steps alone would take from the start, s, the truth included.
double ladder_time_of_steps(const Ladder *ladder, size_t step_count, size_t jobs);

// The finest point of a scheme that did not fail, or point_count.
size_t ladder_finest(const Ladder *ladder, size_t scheme);

// Works out failures, errors, medians, the frontier, the orders and the cheapest points.
void ladder_conclude(Ladder *ladder);

// The points that are worth their time.

// Marks the points that are more accurate than every faster one, by more than a hundredth of its
// error: a smaller difference distinguishes no schemes. A point whose time, s, or error is not
// finite is no point.
void frontier_mark(size_t count, const double *times, const double *errors, bool *is_on_frontier);

// The fastest point whose error, the uncertainty of that error included, meets the target; of two
// as fast the more accurate. Returns `count` where none does.
size_t frontier_cheapest(size_t count, const double *times, const double *errors,
                         double uncertainty, double target);
