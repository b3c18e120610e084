// A box on a floor, held by ODE's own contacts with friction, and an arm on a hinge on top of it
// that swings between two stops of the library and knocks the box along.
//
// All of ODE's bodies and contacts are in space; by symmetry the motion stays in a plane.
#pragma once

#include <jointplay/jointplay.h>

// What of it may be chosen.
typedef struct CartOptions {
    double mass;        // kg, of the box
    double friction;    // between box and floor
    double speed;       // m/s, of the box at the start
    double arm_speed;   // rad/s, of the arm at the start, hanging straight down
    double restitution; // of the stops; 1: no damper, and no jump of the force where one is met
    double duration;    // s
} CartOptions;

typedef struct CartState {
    double position;  // m, of the box
    double speed;     // m/s
    double angle;     // rad, of the arm from straight down
    double arm_speed; // rad/s
} CartState;

// Steps it to the end of its duration, with ODE ready. Returns false with an error where the
// library refuses it.
bool cart_run(const CartOptions *options, JpStepping stepping, double step, CartState *end,
              JpWorldStats *stats, JpError *error);

// The same by its two equations of motion, from event to event: accurate to 1e-8. Friction is
// ODE's: mu times what the floor would press with without friction (cart_truth.c). *changes is how
// often sliding began, ended or turned round.
CartState cart_truth(const CartOptions *options, int *changes);

// Root mean squares over starts with the arm at different speeds, against the equations of motion.
enum { CART_STARTS = 16 };

typedef struct CartErrors {
    double position;    // m
    double angle;       // rad
    JpWorldStats stats; // of all starts together, as is the next
    int changes;        // of the friction
} CartErrors;

// Takes the arm's speed of the options as a given one of each start. Returns false with an error
// where the library refuses a start.
bool cart_errors(CartOptions options, JpStepping stepping, double step, CartErrors *errors,
                 JpError *error);

// Of the arm: mass, kg; distance of its centre from the hinge, m; inertia about its centre, kg m^2.
extern const double CART_ARM_MASS;
extern const double CART_ARM_LENGTH;
extern const double CART_ARM_INERTIA;
extern const double CART_GRAVITY; // m/s^2

// The stops: where, rad; stiffness, N m/rad; damper, N m s/rad.
extern const double CART_STOP;
extern const double CART_STIFFNESS;
double cart_damper(const CartOptions *options);
