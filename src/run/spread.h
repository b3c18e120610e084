// What the inputs of a case and the assumptions of its form add to the forces of its settled
// motion.
//
// ASME V&V 20 asks for two parts of the uncertainty of a computed number: what the computation
// adds, which the reference states, and what the inputs add. Here inputs are drawn independently of
// one another, each evenly between the limits that the case gives it, or those that are assumed,
// and each draw is settled from every motion of the case. The least and the largest of n
// independent draws leave 2 / (n + 1) of the distribution outside in the mean; of 38 they hold at
// least 90 % of it with probability 0.905 (Wilks, Ann. Math. Stat. 12, 1941): 1 - n p^(n-1) + (n-1)
// p^n at p = .9. Assumptions of form have no distribution: each is changed alone.
#pragma once

#include "casefile/casefile.h"
#include "run/run.h"

enum { SPREAD_DRAWS = 38, SPREAD_FORM_SIZE = 64 };

// The text of a case and what the command line sets in it, which must outlive its use.
typedef struct SpreadCase {
    const char *name; // of the case, in messages
    const char *text;
    size_t size;
    const char *const *overrides; // KEY=VALUE
    size_t override_count;
} SpreadCase;

// A number that draws change, in its unit.
typedef struct SpreadInput {
    char key[CASEFILE_KEY_SIZE];        // joints.crank-coupler.hole
    size_t item;                        // of a vector; else 0
    size_t item_count;                  // of the vector; else 1
    double items[3];                    // of a vector, SI, as they are without a draw
    char item_unit[CASEFILE_UNIT_SIZE]; // in SI
    double nominal;
    double lower; // as deviations from it
    double upper;
    char unit[SCENARIO_UNIT_SIZE];
    bool is_given; // by the case; else assumed
} SpreadInput;

typedef struct SpreadInputs {
    size_t count;
    SpreadInput *inputs; // owned
} SpreadInputs;

// What an assumption of form is about.
typedef enum SpreadFormKind {
    SPREAD_LAW,
    SPREAD_DAMPING,
    SPREAD_RESTING_SPEED,
    SPREAD_FRICTION,
    SPREAD_FORM_KIND_COUNT
} SpreadFormKind;

extern const char *const SPREAD_FORM_KINDS[]; // "laws", "damping", ...

// What came of one start.
typedef struct SpreadAnswer {
    bool is_there;
    bool is_made;   // its work was done; else the budget had ended
    size_t period;  // 0: it does not repeat
    double *forces; // N or N m, by joint: the largest, or of what does not repeat its 95 % quantile
    double *impacts; // by joint, a revolution
} SpreadAnswer;

// One draw or one form, from each motion.
typedef struct SpreadRun {
    double *values;              // of a draw: of each input, in its unit; else NULL
    double damping_scale;        // times that of the case
    char key[CASEFILE_KEY_SIZE]; // of a form: the key that it changes; empty: none
    char value[SPREAD_FORM_SIZE];
    char name[SPREAD_FORM_SIZE]; // of a form, for people: "law johnson"
    SpreadFormKind kind;
    SpreadAnswer *answers;   // by motion; owned
    char why[ERR_TEXT_SIZE]; // its numbers make no case; empty: they do
} SpreadRun;

// From the least to the largest.
typedef struct SpreadRange {
    double low;
    double high;
} SpreadRange;

// Where a touch begins or ends as one input changes alone.
typedef struct SpreadTouch {
    bool is_there;
    size_t input;
    double at;          // of the input, in its unit
    double force;       // N, beyond it, of the loudest joint
    double impacts;     // a revolution there
    double was_impacts; // and at the nominal
} SpreadTouch;

typedef struct Spread {
    bool is_there;            // somebody looked, and at least two draws were made
    const Scenario *scenario; // that is settled; not owned
    size_t motion_count;      // that draws start from
    SpreadInputs inputs;
    double *ranks; // 1, by input: rank correlation with the largest force of the joint below over
                   // the draws; NAN: not known; owned
    size_t joint;  // the one with play whose force is largest
    size_t asked;  // draws
    size_t draw_count;       // that came to an answer
    size_t without;          // draws that make no case, such as a pin without play, or that failed
    const char *why_without; // of the first of them that makes no case; NULL: none
    SpreadRun *draws;        // `asked`; owned
    size_t form_count;
    SpreadRun *forms;                      // owned
    SpreadRange *ranges;                   // N, by joint, over the draws; owned
    SpreadRange *form_ranges;              // N, by joint, over the forms and the case itself; owned
    bool has_form[SPREAD_FORM_KIND_COUNT]; // whether any of that kind has an answer
    SpreadTouch touch;
    bool is_spent;  // the budget ended it
    double spent_s; // of processor time
} Spread;

// How it is made.
typedef struct SpreadOptions {
    size_t draws;
    unsigned first;  // number of the first draw: others are other draws
    double budget_s; // of processor time; 0: none
    bool has_forms;  // whether assumptions of form and touches nearby are looked at
} SpreadOptions;

SpreadOptions spread_options_default(void);

// What draws change of a settled scenario: the tolerances that the case gives, and where it gives
// none those that are assumed (docs/spread.md).
SpreadInputs spread_inputs(const Scenario *scenario);
void spread_inputs_free(SpreadInputs *inputs);

// The value of an input in a draw, between its limits: the same wherever it is asked.
double spread_drawn(const SpreadInput *input, unsigned draw);

// Whether a scenario has a settled motion whose forces inputs can move.
bool spread_is_of(const Scenario *scenario);

// Finds all of it, of a scenario that is settled and that of the case. Side by side, with the same
// numbers but for where the budget ends.
Spread spread_find(const SpreadCase *of, const Scenario *scenario, const SpreadOptions *options,
                   RunWatch watch);
void spread_free(Spread *spread);
