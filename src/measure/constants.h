// The best constants for a contact at a step that cannot be changed: one ERP and one CFM, or
// Gazebo's kp and kd, for every depth.
//
// The restitution comes first: it is within MAPPING_VALID_SHARE of what the law asks wherever the
// steps fall, where any constants reach that. Of those that do, the best are nearest to the law's
// impact by
//
//     misfit^2 = (ln^2(F / F_a) + ln^2(d / d_a) + ((e - e_a) / e_a)^2) / 3, mean over the phases
//
// F peak force, d depth, e restitution (as a divisor e_a is at least MAPPING_VALID_SHARE), the
// index a for asked: twice and half of a force are as far off.
#pragma once

#include "measure/mapping_contact.h"

enum { CONSTANTS_MAP_COUNT = 3 };

// The maps by which constants are rows. The textbook's are Gazebo's kp and kd, ERP at most 1; the
// corrected's are any ERP and CFM; the midpoint's row follows the closing speed, with staggered
// stepping. (The exact map makes no row that these do not.)
extern const OdeMap CONSTANTS_MAPS[CONSTANTS_MAP_COUNT];

typedef struct ConstantsSetting {
    OdeMap map;
    ErpCfm row;              // of the midpoint at the law's deepest point, without a closing speed
    double stiffness;        // N/m, the spring that the map makes the row of
    double damping;          // N s/m
    bool is_restitution_met; // in every phase
    double misfit;           // 1, as above
    ImpactFigures predicted;
    VerdictKind verdict; // from the prediction
    ImpactDelivered delivered;
} ConstantsSetting;

typedef struct Constants {
    double step_s;
    double flight;                                  // m, in a step at the closing speed
    double play;                                    // m, from wall to wall
    ConstantsSetting settings[CONSTANTS_MAP_COUNT]; // in the order of CONSTANTS_MAPS
} Constants;

// Searches the best constants of a contact of CONTACT_IMPACT at a step, s, and runs them in ODE.
void constants_find(const MappingContact *contact, double step_s, Constants *held);

// What constants come to at a step: the prediction, and from it all but `delivered`.
ConstantsSetting constants_setting(const MappingContact *contact, double step_s, OdeMap map,
                                   double stiffness, double damping);

// What the engine delivers with constants at a step, in a hole that leaves the pin room.
ImpactDelivered constants_deliver(const MappingContact *contact, double step_s, OdeMap map,
                                  double stiffness, double damping);

// Whether one setting is better than another, as above.
bool constants_is_better(const ConstantsSetting *one, const ConstantsSetting *other);

// The contact of every joint of a scenario made of the constants; friction, step and stepping stay.
void constants_apply(const ConstantsSetting *setting, Scenario *scenario);
