// Everything a solver needs to know: the linkage, the world around it, the contact, the run.
#pragma once

#include "model/expectation.h"
#include "model/fourbar.h"
#include "model/linkage.h"
#include "model/options.h"
#include "model/settled.h"
#include "model/slidercrank.h"

enum { SCENARIO_TITLE_SIZE = 256, SCENARIO_PATH_SIZE = 4096, SCENARIO_POINT_MAX = 4 };

// A point of a body whose path is written out.
typedef struct TracedPoint {
    char name[LINKAGE_NAME_SIZE];
    int body;
    Vec2 local; // in the body's frame, m
} TracedPoint;

// Where bodies may move.
typedef enum ScenarioSpace {
    SCENARIO_PLANAR,  // in the plane: pins have no length
    SCENARIO_SPATIAL, // in space: pins tilt and slide in their holes
} ScenarioSpace;

extern const char *const SCENARIO_SPACES[]; // the words, ending in NULL

// A key that the case or the command line gives, for messages about it.
typedef struct ScenarioKey {
    size_t row;    // of the table of keys, casefile/schema.h
    size_t member; // of its family
    size_t line;   // of the case file, from 1; 0 of the command line
} ScenarioKey;

enum { SCENARIO_UNIT_SIZE = 32 };

// A number of the case that has a tolerance, in the unit that it is written with.
typedef struct ScenarioTolerance {
    size_t row;     // of the table of keys, casefile/schema.h
    size_t member;  // of its family
    size_t item;    // of a vector; else 0
    double nominal; // as the case has it, of a fit the middle of its limits
    double lower;   // as deviations from it: 0 or below
    double upper;   // 0 or above
    char unit[SCENARIO_UNIT_SIZE];
} ScenarioTolerance;

// It owns the arrays of its linkage and its own. An assignment shares them: it is for a scenario of
// other options that does not outlive the first. What is to have other bodies, joints or a life of
// its own needs scenario_copy.
typedef struct Scenario {
    char title[SCENARIO_TITLE_SIZE];
    char *path; // of the case file, as given; owned; NULL where there is none: scenario_path
    ScenarioSpace space; // linkage.is_spatial is the same
    Linkage linkage;
    bool has_fourbar; // whether the case used that short form
    FourBar fourbar;
    bool has_slidercrank; // or that one
    SliderCrank slidercrank;
    size_t point_count;
    TracedPoint points[SCENARIO_POINT_MAX];
    Vec3 gravity; // acceleration of free fall, m/s^2, in the world's axes; in the plane z is 0
    MaterialOptions material;
    ContactOptions contact;
    RunOptions run;
    ReferenceOptions reference;
    OdeOptions ode;
    EngineOptions engines[BACKEND_COUNT]; // by backend, of other engines
    size_t expectation_count;
    Expectation *expectations; // for the checks of runs; no solver reads them; owned
    size_t outcome_count;
    ExpectedOutcome *outcomes; // likewise
    SettledStart settled;      // of START_SETTLED and START_PRESSED
    size_t key_count;
    ScenarioKey *keys; // that were given, in the order of the text; no solver reads them; owned
    size_t tolerance_count;
    ScenarioTolerance *tolerances; // that the case gives, in the order of the table of keys;
                                   // likewise
} Scenario;

// A scenario with every option at its default and an empty linkage, without arrays.
Scenario scenario_default(void);

// One with arrays of its own, of the same contents. For scenario_free.
Scenario scenario_copy(const Scenario *scenario);

// The same options around another linkage, which is now the scenario's; of no file, expecting
// nothing. For scenario_free.
Scenario scenario_around(const Scenario *scenario, Linkage linkage);

// The path of the case file, empty where there is none.
const char *scenario_path(const Scenario *scenario);
void scenario_set_path(Scenario *scenario, const char *path);

// Frees what the scenario owns; its linkage is then empty.
void scenario_free(Scenario *scenario);

// The same of a scenario that was allocated itself; NULL is nothing.
void scenario_destroy(Scenario *scenario);

// Length of the run, s, and the number of samples in it (both ends included).
double scenario_duration(const Scenario *scenario);
size_t scenario_sample_count(const Scenario *scenario);

// The time from which on extremes, contacts and spikes are reported, s.
double scenario_report_from(const Scenario *scenario);

// Whether that is before the end of the run, by more than rounding.
bool scenario_reports_any(const Scenario *scenario);

// Time of one sample: an exact multiple of the sample interval, s.
double scenario_sample_time(const Scenario *scenario, size_t sample);

// The friction of a joint with play: its own, or the contact's.
static inline double scenario_friction(const Scenario *scenario, const Joint *joint)
{
    return joint->contact.has_friction && !joint_is_ideal(joint->kind) ? joint->contact.friction
                                                                       : scenario->contact.friction;
}

// The restitution likewise.
static inline double scenario_restitution(const Scenario *scenario, const Joint *joint)
{
    return joint->contact.has_restitution ? joint->contact.restitution
                                          : scenario->contact.restitution;
}

// Gravity as one number has it: along -y, m/s^2.
static inline Vec3 scenario_downward(double gravity)
{
    return (Vec3){0.0, -gravity, 0.0};
}

// Gravity in the plane, m/s^2.
static inline Vec2 scenario_gravity(const Scenario *scenario)
{
    return (Vec2){scenario->gravity.x, scenario->gravity.y};
}

// Its opposite: what a body's joints must give it, beside its own acceleration, m/s^2.
static inline Vec2 scenario_upward(const Scenario *scenario)
{
    return vec2_sub((Vec2){0.0, 0.0}, scenario_gravity(scenario));
}

// The period in which a motion can settle, s: that of all that acts, drives, torques and loads
// (model/common_period.h). 0: there is none.
double scenario_settling_period(const Scenario *scenario);

// The same in revolutions of a drive of constant speed, a whole number; else 1.
double scenario_settling_turns(const Scenario *scenario);

// Lets it start as the case puts its bodies, and keeps why in words of its own.
void scenario_start_as_written(Scenario *scenario, const char *reason);

// Whether runs are to start in a settled motion: it is asked for, and there is one to come to.
bool scenario_settles(const Scenario *scenario);

// Whether its start is still to be found, that motion or that of START_PRESSED.
bool scenario_lacks_start(const Scenario *scenario);

// Gives all joints with play one stiffness, N/m^exponent, in place of the contact's and of their
// own; 0 where the contact's law is to say it.
void scenario_set_stiffness(Scenario *scenario, double stiffness, double exponent);

// Whether any joint has play.
bool scenario_has_clearance(const Scenario *scenario);

// Whether the motion with ideal joints is known in closed form: of the short forms.
bool scenario_has_closed_form(const Scenario *scenario);

// Whether ODE's motion can be extrapolated from several worlds: all joints ideal, in the plane, and
// the drive's speed without kinks.
bool scenario_is_extrapolable(const Scenario *scenario);

// Whether ODE integrates the contacts within its steps, by the map that makes no rows.
bool scenario_integrates_contacts(const Scenario *scenario);

// The scenario with the step given and the way of stepping that a step chosen for a tolerance is
// for: staggered with the contacts integrated in the step, or as rows of mid-step where they cannot
// be; or extrapolated where every joint is ideal.
Scenario scenario_with_step(const Scenario *scenario, double step_s);

// Checks what no single key can show: the linkage, the options' ranges, the size of the run.
bool scenario_check(const Scenario *scenario, Err *err);
