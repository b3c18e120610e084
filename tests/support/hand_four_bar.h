// The paper's four-bar as somebody would make it by hand: of ODE's bodies and hinges, with a pin in
// its hole from the library between crank and coupler.
#pragma once

#include "model/scenario.h"
#include "model/trajectory.h"

#include <jointplay/jointplay.h>

enum { HAND_BODIES = 3 }; // crank, coupler, follower

// Of one body in the plane: of its centre of mass, in the middle of the link.
typedef struct HandMotion {
    double position[2]; // m
    double angle;       // rad
    double velocity[2]; // m/s
    double omega;       // rad/s
} HandMotion;

typedef struct HandFourBar {
    dWorldID world;
    dBodyID bodies[HAND_BODIES];
    JpWorld *play;
    JpJoint *pin;
} HandFourBar;

// What of it may be chosen.
typedef struct HandOptions {
    JpStepping stepping;
    double hole_radius;    // m
    double friction;       // of the pin
    double friction_speed; // m/s
    double speed_floor;    // m/s, of the contact
    double resting_speed;  // m/s, of the contact
    double erp;            // of the hinges
} HandOptions;

// What a case of that four-bar says of it.
HandOptions hand_four_bar_options(const Scenario *scenario, JpStepping stepping, double erp);

// The state in which a run of the case begins.
void hand_four_bar_start(const Trajectory *truth, HandMotion start[HAND_BODIES]);

// Makes it in a state; false with an error where the library refuses it.
bool hand_four_bar_make(const HandOptions *options, const HandMotion start[HAND_BODIES],
                        HandFourBar *made, JpError *error);
void hand_four_bar_destroy(HandFourBar *made);

// The largest difference of omega of coupler and follower from the truth, relative to their
// largest: at one sample, and of a run of the program at all of them.
double hand_four_bar_error(const HandFourBar *bar, const Trajectory *truth, size_t sample);
double hand_four_bar_run_error(const Trajectory *run, const Trajectory *truth);
