// A truth of its own for random mechanisms: every body in coordinates of its own (x, y, phi in the
// plane; position, quaternion and angular velocity in space), ideal joints as rows of a constraint,
// all in long double. It shares no equation and no integrator with src/reference: only the numbers
// of a linkage, the places where bodies touch and the force laws are those of the program.
#pragma once

#include "kernel/force_law.h"
#include "model/trajectory.h"

typedef long double Real;

typedef enum MaximalMode {
    MAXIMAL_APART,
    MAXIMAL_PRESSED,
    MAXIMAL_SLACK, // overlaps, but parts faster than the spring follows
    MAXIMAL_RESTS, // stays pressed, and its impact is over: no mode, but what an event leads to
} MaximalMode;

typedef struct MaximalContact {
    ForceLaw law;
    Real flight; // m, the depth may change by so much in a step while it is apart
    MaximalMode mode;
    Real damping_rate; // s/m, chi / v0 of the contact under way
    bool is_released;  // whether it has moved out since it began
    bool is_resting;   // and has come back
} MaximalContact;

// How a contact stands: depth, m (rad), negative while apart, and its rate.
typedef struct MaximalGap {
    Real depth;
    Real closing;
} MaximalGap;

typedef struct Maximal Maximal;

// The equations of one kind of mechanism.
typedef struct MaximalKind {
    // The rates of all coordinates; time tables take the piece that holds from since_s on.
    void (*rates)(const Maximal *maximal, double since_s, Real time_s, const Real *y, Real *rates);
    MaximalGap (*gap)(const Maximal *maximal, size_t contact, const Real *y);
    // How far a contact is beyond where the curvature of its gap jumps, m; NULL: nowhere.
    Real (*corner)(const Maximal *maximal, size_t contact, const Real *y);
    // How far the torque of a soft drive is beyond its limit, N m, where it has a corner; NULL:
    // nowhere.
    Real (*limit)(const Maximal *maximal, Real time_s, const Real *y);
    // Puts a state on the drive's path and back on the ideal joints.
    void (*project)(const Maximal *maximal, Real time_s, Real *y);
    void (*sample)(const Maximal *maximal, const Real *y, Trajectory *trajectory, size_t sample);
    // Speed of the fastest point of all bodies, m/s.
    Real (*fastest)(const Maximal *maximal, const Real *y);
    void (*destroy)(Maximal *maximal);
} MaximalKind;

struct Maximal {
    const MaximalKind *kind;
    const Scenario *scenario;
    size_t contact_count;
    MaximalContact *contacts;
    size_t count;   // of numbers of a state
    Real *start;    // state at time zero
    double *arms;   // 1 or m, by number: by which it counts as a length or a speed
    bool *is_speed; // by number: whether it is a rate rather than a coordinate
};

// What can be wrong with the truth on purpose, for controls.
typedef struct MaximalFlaw {
    double gravity; // 1, factor
    double mass;    // 1, factor of the first body that nothing drives
} MaximalFlaw;

static const MaximalFlaw MAXIMAL_RIGHT = {1.0, 1.0};

// The equations of a scenario, which must live as long. NULL with a reason where there is something
// in it that they do not describe. For maximal_destroy.
Maximal *maximal_plane_create(const Scenario *scenario, const MaximalFlaw *flaw, Err *err);
Maximal *maximal_space_create(const Scenario *scenario, const MaximalFlaw *flaw, Err *err);
void maximal_destroy(Maximal *maximal);

// The shared part, for those who make one: room for a state and contacts.
void maximal_init(Maximal *maximal, size_t count, size_t contact_count);
void maximal_finish(Maximal *maximal);

// The force of a contact in its mode, N.
Real maximal_press(const MaximalContact *contact, MaximalGap gap);

// Solves the symmetric, positive semidefinite n x n system A x = b, row by row, whose right hand
// side it may have: rows that follow from others get 0. A is overwritten.
void maximal_solve(size_t n, Real *a, Real *b);

// Integrates a scenario, each step's error at most the tolerance times the speed of its fastest
// point, and stores the bodies' motions at its samples up to a time. With contacts the whole run
// has so many steps or more: one that is longer than a contact may pass over its end and over the
// next touch. A trajectory that is not complete says why.
Trajectory *maximal_run(const Scenario *scenario, const MaximalFlaw *flaw, double tolerance,
                        double steps_least, double until_s);
