// The contact of a joint with play under one law: what an impact on it asks for, and what ODE is
// predicted to deliver.
#pragma once

#include "measure/impact.h"
#include "measure/mapping_joint.h"

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
    struct Held *held; // owned by the mapping: the best constants at the step; NULL: not wanted
} MappingContact;

// Whether its rows are those of the velocity-level model, which has no law and no maps.
static inline bool mapping_contact_is_poisson(const MappingContact *contact)
{
    return contact->scenario.contact.model == CONTACT_POISSON;
}

// The impact of a contact at a step under a map, as ODE makes it. Not of ODE_MAP_IMPULSE.
MapImpactCase mapping_case(const MappingContact *contact, OdeMap map, double step_s);

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
