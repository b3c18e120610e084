// Which ERP, CFM and step for this joint, and what do they deliver: every joint with play, contact
// law, map and step, predicted, judged and measured.
#pragma once

#include "measure/impact.h"
#include "measure/mapping_joint.h"

enum {
    MAPPING_STEP_MAX = 32,
    MAPPING_LAW_MAX = 8,      // all of the family and the stiffness that a case gives
    MAPPING_MAP_COUNT = 5,    // textbook to impulse
    MAPPING_CONTACT_MAX = 64, // joints times laws
};

// What an impact may be off by, of what the law asks, for a setting to be called valid.
extern const double MAPPING_VALID_SHARE;

// Where a number comes from.
typedef enum MappingSource {
    MAPPING_MEDIAN, // of the case's own run
    MAPPING_MOST,   // likewise, the largest
    MAPPING_GIVEN,  // on the command line
    MAPPING_USUAL,  // of a contact without a case, where none was given
    MAPPING_FLOOR,  // of the damping laws' impact speed: what the run has is slower
} MappingSource;

typedef struct MappingSettings {
    size_t step_count;
    double steps[MAPPING_STEP_MAX]; // s, the longest first
    size_t map_count;
    OdeMap maps[MAPPING_MAP_COUNT];
    size_t law_count; // 0: the case's own
    LawKind laws[MAPPING_LAW_MAX];
    MappingSource mass_source;
    MappingSource speed_source;
    bool is_held; // to its only step: the best constants there are wanted
    double mass;  // kg, where given
    double speed; // m/s, where given
} MappingSettings;

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
    OdeMap map;
    double step_s;
    ErpCfm soft;            // of the row at the law's deepest point; not of ODE_MAP_IMPULSE
    double steps_a_contact; // 1, Tc / h
    double omega_h;         // 1, at the deepest point
    ImpactFigures predicted;
    VerdictKind verdict;           // from the prediction
    char words[VERDICT_TEXT_SIZE]; // with advice where it is not valid
    ImpactDelivered delivered;
} MappingRow;

// One joint under one law.
typedef struct MappingContact {
    MappingJoint joint;
    const char *law_name;     // as in a case, or "stiffness" where the case gives that
    char lack[ERR_TEXT_SIZE]; // why the law has no such impact; then mass and speed alone are set
    ErrKind lack_kind;
    Scenario scenario;    // with this law
    MapImpactCase impact; // mass and speed used; of the step and rows nothing
    MappingSource speed_source;
    MapImpact asked;      // the law's own impact
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
    struct Held *held; // owned by the mapping: the best constants at the step; NULL: not wanted
} MappingContact;

typedef struct Mapping {
    const Scenario *scenario; // of the case
    MappingSettings settings;
    size_t contact_count;
    MappingContact *contacts; // owned
    size_t row_count;
    MappingRow *rows; // owned
} Mapping;

// Who watches: of the world steps that all rows make, before the first of them, and before each row
// of what has been done and what there is to do.
typedef struct MappingWatch {
    void (*plan)(double steps, void *context);             // NULL: nobody watches
    void (*row)(size_t done, size_t total, void *context); // NULL: nobody watches
    RunWatch run;                                          // of the reference
    void *context;
} MappingWatch;

// Works it all out. Fails with ERR_CASE where no joint has play, with ERR_USAGE where mass or speed
// are neither given nor to be had from a run, with ERR_SOLVER where the reference fails or where no
// law has such an impact: one of several that has none says so and hides no other. A row that could
// not be run says so too and is no failure. mapping_finish accepts a zeroed mapping.
bool mapping_make(const Scenario *scenario, const MappingSettings *settings, MappingWatch watch,
                  Mapping *mapping, Err *err);
void mapping_finish(Mapping *mapping);

// The impact of a contact at a step under a map, as ODE makes it. Not of ODE_MAP_IMPULSE.
MapImpactCase mapping_case(const MappingContact *contact, OdeMap map, double step_s);

// The prediction, of any map: the impulse map delivers the law. Not tried with more than
// MAPPING_STEPS_MOST steps to the contact.
extern const double MAPPING_STEPS_MOST;
ImpactFigures mapping_predict(const MappingContact *contact, OdeMap map, double step_s);

// Fills in a contact's law, mass and speed and all that follows from them. Fails with ERR_CASE
// where the law does not fit the joint, and with ERR_SOLVER where it has no such impact.
bool mapping_contact_make(const Scenario *scenario, const MappingJoint *joint, double mass,
                          double speed, MappingContact *contact, Err *err);

// A contact's scenario for a map and step.
Scenario mapping_scenario(const MappingContact *contact, OdeMap map, double step_s);
