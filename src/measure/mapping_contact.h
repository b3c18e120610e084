// The contact of a joint with play under one law: what an impact on it asks for, and what ODE is
// predicted to deliver.
#pragma once

#include "contact/impact_figures.h"
#include "model/scenario.h"
#include "run/run.h"

// One impact of a single pin on the wall of its hole, or of a corner or stop on its line: what ODE
// delivers when it is run.

// What a run in ODE delivered.
typedef struct ImpactDelivered {
    bool is_measured;
    char message[ERR_TEXT_SIZE]; // why it could not be
    ImpactFigures figures;
} ImpactDelivered;

// Runs a single pin of a mass, kg, in the hole of a joint of the scenario, or a single body against
// a wall where the joint is no pin in a hole, without gravity, at a closing speed, m/s, and the
// scenario's own step, contact and map, over all phases. `contact_s` is the longest that the
// contact is expected to last, s. Nothing is measured, and the message says why, where a step takes
// the pin across the hole, a run would be too long or failed, or had another number of contacts
// than one.
ImpactDelivered impact_deliver(const Scenario *scenario, int joint, double mass, double speed,
                               double contact_s);

// What the contacts of a joint with play are like in its mechanism: with which mass they press, and
// how fast pin and wall come together.

typedef struct MappingJoint {
    int joint;              // number in the linkage
    double mass_least;      // kg, effective along the normal, over the run and all directions
    double mass_median;     //
    double mass_most;       //
    size_t onsets;          // contacts begun at a closing speed above 0
    double speed_median;    // m/s, closing, over these; 0 where there are none
    double speed_most;      //
    double penetration_max; // m, of the run
    double force_max;       // N, likewise
} MappingJoint;

// The joints with play of a scenario, in their order, and their count, from a run of the reference,
// which the watch follows. The caller frees them. Fails with ERR_SOLVER where the reference does.
bool mapping_joint_measure(const Scenario *scenario, RunWatch watch, MappingJoint **joints,
                           size_t *count, Err *err);

// The same joints, of which nothing is known but their numbers.
MappingJoint *mapping_joint_list(const Scenario *scenario, size_t *count);

enum { MAPPING_MAP_COUNT = ODE_MAP_COUNT };

// Where a number comes from.
typedef enum MappingSource {
    MAPPING_MEDIAN, // of the case's own run
    MAPPING_MOST,   // likewise, the largest
    MAPPING_GIVEN,  // on the command line
    MAPPING_USUAL,  // of a contact without a case, where none was given
    MAPPING_FLOOR,  // of the damping laws' impact speed: what the run has is slower
} MappingSource;

// One joint under one law.
typedef struct MappingContact {
    MappingJoint joint;
    const char *law_name;     // as in a case, or "stiffness" where the case gives that
    char lack[ERR_TEXT_SIZE]; // why the law has no such impact; then mass and speed alone are set
    ErrKind lack_kind;
    Scenario scenario;    // with this law; its linkage is that of the scenario it was made of
    MapImpactCase impact; // mass and speed used; of the step and rows nothing
    MappingSource mass_source;
    MappingSource speed_source;
    MapImpact asked;      // the law's own impact; NAN of CONTACT_POISSON, as the next five, but for
                          // the restitution
    double half_period_s; // Tc: the contact's length without damping
    double secant;        // k at the deepest point, N/m
    double tangent;       // dF/dd there, N/m
    double damping;       // c there, N s/m
    double equivalent;    // N s/m: the viscous damper that gives back as much beside that k
    double largest_s[MAPPING_MAP_COUNT]; // by map: the longest step from which on it is valid; 0
                                         // where none was found, infinite for every step
    double hardest_s[MAPPING_MAP_COUNT]; // the same for the least mass and the largest speed of the
                                         // run; 0 also where these are not known
    size_t first_row;
    size_t row_count;
    struct Constants
        *held; // owned by the mapping: the best constants at the step; NULL: not wanted
} MappingContact;

// Whether its rows are those of the velocity-level model, which has no law and no maps.
static inline bool mapping_contact_is_poisson(const MappingContact *contact)
{
    return contact->scenario.contact.model == CONTACT_POISSON;
}

// The prediction, of any map: the impulse map delivers the law. Not tried with more than
// MAPPING_STEPS_MOST steps to the contact.
extern const double MAPPING_STEPS_MOST;
ImpactFigures mapping_predict(const MappingContact *contact, OdeMap map, double step_s);

// What the law of a scenario's contacts is called.
const char *mapping_law_name(const Scenario *scenario, const Joint *joint);

// Fills in a contact's law, mass and speed and all that follows from them. Fails with ERR_CASE
// where the law does not fit the joint, and with ERR_SOLVER where it has no such impact.
bool mapping_contact_make(const Scenario *scenario, const MappingJoint *joint, double mass,
                          double speed, MappingContact *contact, Err *err);

// A contact's scenario for a map and step.
Scenario mapping_scenario(const MappingContact *contact, OdeMap map, double step_s);

// Whether a setting is right, what is wrong with it, and what would be right.

// What an impact may be off by, of what the law asks, for a setting to be called valid.
extern const double MAPPING_VALID_SHARE;

typedef enum VerdictKind {
    VERDICT_VALID,
    VERDICT_TOO_FINE,     // more steps than are tried
    VERDICT_PAST_END,     // the pin goes past the end of the law
    VERDICT_UNSTABLE,     // omega h beyond the map's limit: rows fall back to the textbook's
    VERDICT_STICKS,       // the contact does not end
    VERDICT_TOO_COARSE,   // fewer steps than a contact can be seen in
    VERDICT_GAINS,        // more speed after the impact than before it
    VERDICT_OVER_DAMPED,  // less restitution than asked for
    VERDICT_UNDER_DAMPED, // more
    VERDICT_PEAK,         // another peak force
    VERDICT_DEPTH,        // another depth
    VERDICT_SCATTERS,     // right in the mean, but not wherever the steps fall
    VERDICT_COUNT,
} VerdictKind;

extern const char *const VERDICT_NAMES[VERDICT_COUNT]; // one word each

enum { VERDICT_TEXT_SIZE = 192 };

typedef struct MappingRow {
    const MappingContact *contact;
    OdeMap map;
    const char *map_name; // "poisson" of CONTACT_POISSON, which has no map
    OdeStepping stepping;
    double step_s;
    ErpCfm soft;            // of the row at the law's deepest point; NAN of ODE_MAP_IMPULSE
    double stability_limit; // 1, of omega h; NAN where there is none, as the next two
    double steps_a_contact; // 1, Tc / h
    double omega_h;         // 1, at the deepest point
    ImpactFigures predicted;
    VerdictKind verdict;           // from the prediction
    char words[VERDICT_TEXT_SIZE]; // with advice where it is not valid
    ImpactDelivered delivered;
} MappingRow;

// What figures, predicted or delivered, are to be called beside what the law asks.
VerdictKind verdict_judge(const MappingContact *contact, OdeMap map, double step_s,
                          const ImpactFigures *figures);

// Fills in the contact's longest valid steps, found by trying predictions.
void verdict_find_steps(MappingContact *contact);

// Words for a row whose prediction and verdict stand in it.
void verdict_describe(const MappingContact *contact, MappingRow *row);

// Of CONTACT_POISSON: the smallest penalty, N s/m, that is valid at a step, s.
double verdict_least_penalty(const MappingContact *contact, double step_s);
