// What physics gives where the paper estimates: real pin forces, and the contact under them.
#pragma once

#include "measure/printed.h"
#include "model/scenario.h"

// A pin at one speed, under the largest force that inverse dynamics finds over a turn.
typedef struct PhysicalPin {
    const char *name;
    double rpm;
    double force;            // N, largest over a turn, ideal joints, gravity included
    double hertz_approach;   // m, sphere in socket, the paper's own Eq. (3)
    double johnson_approach; // m, cylinder in hole
    double johnson_tangent;  // N/m, stiffness at that force
    double half_angle;       // rad, of the contact seen from the pin's axis, by Hertz's half width
} PhysicalPin;

// The laws at one force beside each other.
typedef struct PhysicalLaw {
    const char *name;
    double approach; // m
    double tangent;  // N/m
} PhysicalLaw;

enum {
    PHYSICAL_LAW_COUNT = LAW_COUNT,
    PHYSICAL_BASE_ROW = 9, // of 1000 rpm
};

typedef struct Physical {
    PhysicalPin pins[PRINTED_SPEED_COUNT][PRINTED_PIN_COUNT];
    double estimated_force;                    // N: the paper's, crank-coupler pin at 1000 rpm
    PhysicalLaw estimated[PHYSICAL_LAW_COUNT]; // every law at that force
    double real_force;                         // N: of inverse dynamics, same pin and speed
    PhysicalLaw real[PHYSICAL_LAW_COUNT];      // every law at that force
} Physical;

// The four-bar must have joints named as in PRINTED_PIN_NAMES; its own speed does not matter.
// Fails with ERR_SOLVER where its crank does not turn fully.
bool physical_compute(const Scenario *fourbar, Physical *physical, Err *err);

// The largest forces on the two pins over a turn, N, at a speed, rpm.
bool physical_force(const Scenario *fourbar, double rpm, double forces[PRINTED_PIN_COUNT],
                    Err *err);
