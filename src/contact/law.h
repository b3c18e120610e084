// The family of elastic contact laws: what pin, hole and material give as a force law.
#pragma once

#include "base/err.h"
#include "kernel/force_law.h"
#include "model/scenario.h"

// A pin in a hole.
typedef struct ContactPair {
    double hole_radius;     // m
    double pin_radius;      // m, smaller
    double width;           // m, over which they touch; only the cylinder laws need it
    double eye_radius;      // m, of the outside of the eye around the hole, for the elastic law; 0:
                            // twice that of the hole
    double youngs_modulus;  // Pa, of what has the hole
    double poisson_ratio;   // 1, likewise
    double pin_modulus;     // Pa, of a pin of another material; 0: of the same
    double pin_ratio;       // 1, likewise, of a modulus above 0
    double reference_force; // N, at which a law whose stiffness depends on a load is taken:
                            // paper-table-2, by the tangential force of the paper's Table I
} ContactPair;

typedef struct Law {
    bool needs_width; // whether the joint must have a width
    bool needs_force; // whether the reference force must be above 0
    // Makes the undamped force law. The pair has been checked.
    void (*make)(const ContactPair *pair, ForceLaw *law);
} Law;

const Law *law_get(LawKind kind);

// The law that is meant by one that may be auto, of a pin with a width, m, or 0.
LawKind law_chosen(LawKind kind, double width);

// Makes the undamped law of a pair. Fails with ERR_CASE, the law untouched, where radii, material
// or (if needed) width or reference force are out of range.
bool law_make(LawKind kind, const ContactPair *pair, ForceLaw *law, Err *err);

// The pair of a joint. The reference force is the paper's for its crank-coupler pin at the
// driver's speed, rad/s; 0 stands for 1000 rpm.
ContactPair law_pair(const Clearance *clearance, const MaterialOptions *material, double speed);

// The outer radius of an eye over that of its hole, m: of one that is given, m, or where that is 0
// of a usual one.
double law_eye_ratio(double eye_radius, double hole_radius);

// The whole law of a joint as the options say: given stiffness or law, damping, speed floor,
// friction. Fails
// as law_make does.
bool law_build(const ContactOptions *contact, const MaterialOptions *material,
               const Clearance *clearance, double speed, ForceLaw *law, Err *err);

// The speed that a law without memory divides by, whatever its impact, m/s: beyond any.
static const double LAW_NO_MEMORY = 1e6;

// Makes the hysteretic damping of a law F = F_el (1 + c d'), c >= 0 in s/m: what the material
// dissipates, with no memory of the impact (Hunt and Crossley 1975; so in Simbody and Drake).
static inline void law_set_dissipation(double dissipation, ForceLaw *law)
{
    law->hysteresis = dissipation * LAW_NO_MEMORY;
    law->impact_speed_floor = LAW_NO_MEMORY;
}

// c of a law that this has made, s/m.
static inline double law_dissipation(const ForceLaw *law)
{
    return law->hysteresis / law->impact_speed_floor;
}

// The restitution, 1, that the hysteretic damping of a law delivers at an impact speed, m/s.
double law_restitution(const ForceLaw *law, double speed);

// The contact's options with what the joint has of its own in their place, and the law that is
// meant.
ContactOptions law_options(const ContactOptions *contact, const Joint *joint);

// Whether the stiffness of any joint with play is that of the law that the options name.
bool law_is_asked(const Scenario *scenario);

// Whether a force of the contact opposes its speed: none where its restitution is 1.
bool law_is_damped(const ContactOptions *contact);

// Whether any joint with play has friction; whether any is damped.
bool law_has_friction(const Scenario *scenario);
bool law_has_damping(const Scenario *scenario);

// The loosest tolerance of the reference that saves work, 1. Looser ones than 3e-5 make steps that
// are refused as often as they are longer, with errors of up to 1 and more (twelve cases). Where
// contacts are damped so much that hardly anything is given back, an error of a speed is that of a
// force chi times over: pins leave their walls and come back for nothing. Evaluations on rows of 8
// and 24 four-bars, the paper's case and three-clearances at restitutions from 0.1 to 1e-9 are
// fewest at 1e-6 to 1e-10, a thousandth of those at 3e-5, with 1e-5 chi^-0.6 in the middle of it.
double law_loosest_tolerance(const Scenario *scenario);

// The tolerance with which the reference is integrated: the one asked for, or the loosest.
double law_reference_tolerance(const Scenario *scenario);

// The law of a joint with play of a scenario. Fails as law_make does, with the joint's name in
// front, and where a joint that is no pin in its hole has no stiffness that is given.
bool law_of_joint(const Scenario *scenario, const Joint *joint, ForceLaw *law, Err *err);

// The deepest penetration, m, at which the contact of a joint still means anything: of a law of the
// material a tenth of the pin's radius, or the law's own limit. A stiffness that is given holds at
// any depth up to where the whole part is inside the other: a pin, a block, a gear, whose sizes are
// given.
double law_depth_max(const ForceLaw *law, const Joint *joint);

// The radius, m, of what touches in a joint with play: of a pin its own, of a block half its height
// or half of what it slides in, of a stop the smaller disc. Infinite of a point at a line.
double law_touching_radius(const Joint *joint);

// Fails with ERR_SOLVER where the pin of a joint is deeper, m, in its wall than a share of that, or
// its depth is no number.
bool law_check_depth(const ForceLaw *law, const Joint *joint, double depth, double share, Err *err);

// E*, Pa: 1 / E* = (1 - nu_a^2) / E_a + (1 - nu_b^2) / E_b, of hole and pin.
double law_effective_modulus(const ContactPair *pair);

// The members, by the names in OPTIONS_LAW_LIST.
#define LAW_DECLARE(id, word, law) extern const Law law;
OPTIONS_LAW_LIST(LAW_DECLARE)
