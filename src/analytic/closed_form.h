// The closed form of whichever mechanism has one: a four-bar, or a slider-crank.
#pragma once

#include "analytic/curve.h"
#include "model/scenario.h"

enum { CLOSED_FORM_BODIES = 3 }; // the crank, what it pushes, and the follower or slider

// How messages call the mechanism: "four-bar".
const char *closed_form_name(const Scenario *scenario);

// Whether the crank can turn through every angle.
bool closed_form_turns(const Scenario *scenario);

// The motion of the bodies at a crank angle. Returns false, motions untouched, where the loop does
// not close there. The scenario has a closed form.
bool closed_form_bodies(const Scenario *scenario, double crank_angle,
                        Motion motions[CLOSED_FORM_BODIES]);

// The same at any speed and acceleration of the crank, 0 too.
bool closed_form_driven(const Scenario *scenario, const DriveState *drive,
                        Motion motions[CLOSED_FORM_BODIES]);

// The extremes of a body's angular velocity, rad/s, and acceleration, rad/s^2, for crank angles
// from first to last; not of the crank.
void closed_form_extremes(const Scenario *scenario, size_t body, double first_angle,
                          double last_angle, CurveExtreme *omega, CurveExtreme *alpha);
