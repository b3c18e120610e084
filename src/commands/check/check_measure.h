// Measures a scenario for a regression check.
#pragma once

#include "measure/error.h"
#include "measure/truth.h"
#include "model/scale.h"
#include "model/trajectory.h"

// What a regression check measures, a list of numbers with names, and how those of one run get into
// it.

enum { CHECK_NAME_SIZE = 112, CHECK_MESSAGE_SIZE = 512 };

typedef enum CheckKind {
    CHECK_REAL,
    CHECK_COUNT,  // a whole number
    CHECK_EFFORT, // likewise, of what a solver spent: says nothing of the motion
    CHECK_HASH,   // of a trajectory: equal or not
} CheckKind;

// One number. Its name says where it is from and what its unit is:
// "ode/coupler/alpha_max_rad_s2", and "ode-to-horizon/..." where the run was cut short at the
// horizon of predictability.
typedef struct CheckMetric {
    char name[CHECK_NAME_SIZE];
    CheckKind kind;
    bool is_slow;  // measured where CheckPlan.is_full
    double value;  // in the unit of its name
    double scale;  // likewise, above 0 or 0: what a spread is a share of
    double floor;  // likewise: what rounding alone may change, whatever an ensemble says
    uint64_t hash; // of CHECK_HASH
} CheckMetric;

typedef struct CheckMeasure {
    bool is_complete; // false: the message says which run failed and why
    char message[CHECK_MESSAGE_SIZE];
    size_t count;
    size_t room;          // of the metrics there is room for
    CheckMetric *metrics; // owned: check_measure_finish
    // SI, by expectation of the scenario and by backend; NAN where it was not measured
    double expected[EXPECTATION_MAX][BACKEND_COUNT];
} CheckMeasure;

// Where numbers are added, and what they are scaled by.
typedef struct CheckAdd {
    const Scenario *scenario;
    CheckMeasure *measure;
    const char *group; // behind the backend's name: "" or "-to-horizon"
    SpeedScale speeds;
    double energy; // J, of everything at the scale of speeds; N m, of a torque that does so
    double force;  // N, which gives everything the acceleration of that scale
} CheckAdd;

// What to hold the runs against, and how much to measure. It is fixed when a baseline is made:
// a horizon found anew each time would differ by a sample.
typedef struct CheckPlan {
    bool has_truth;     // errors are measured
    double uncertainty; // 1, of the truth
    bool is_limited;    // the motion cannot be predicted to its end
    double horizon_s;   // where that is so
    bool is_full;       // order of convergence as well
} CheckPlan;

// How the starts of an ensemble differ from the scenario's own.
typedef struct CheckStart {
    unsigned member; // 0: not at all
    double share;    // 1: size of the perturbation, see model/perturb.h
    unsigned shake;  // 0: not; else the seed with which inputs are rounded anew
} CheckStart;

// The plan of a scenario, its truth being known. The runs are measured in full.
CheckPlan check_plan(const Truth *truth);

// The scenario from another start.
void check_measure_start(Scenario *scenario, CheckStart start);

// Runs the scenario on its backends and measures them. A run that fails leaves nothing measured.
// What the measure held before is lost but for its room.
void check_measure(const Scenario *scenario, const CheckPlan *plan, CheckMeasure *measure);

// Gives back what a measure holds, zeroed ones included; and one with the contents of another.
void check_measure_finish(CheckMeasure *measure);
CheckMeasure check_measure_copy(const CheckMeasure *measure);

// The same in one piece of memory, as a child process hands it to its parent: how many bytes that
// takes at most; what is written there; and what is read from it.
size_t check_measure_packed_size(const Scenario *scenario);
void check_measure_pack(const CheckMeasure *measure, void *packed, size_t size);
CheckMeasure check_measure_unpack(const void *packed);

// What a run says of the limits that its case sets.

// Whether a limit concerns a backend: the one that it names, or each that feels the play of the
// scenario; of an error none that is the truth itself.
bool expect_value_concerns(const Expectation *expectation, const Scenario *scenario,
                           BackendKind backend);

// Whether a limit is one of an error.
bool expect_value_is_error(const Expectation *expectation);

// Whether its number is of the settled motion of the case, and none of a run.
bool expect_value_is_settled(const Expectation *expectation);

// That number, SI; NAN where the case does not settle or it was not looked for.
double expect_value_of_settled(const Expectation *expectation, const Scenario *scenario);

// By how much a number is outside its limit, SI: 0 within it, below 0 under its low end. At an open
// end, where a number outside may be off by nothing, the least number that is not 0.
double expect_value_off(const Expectation *expectation, double value);
