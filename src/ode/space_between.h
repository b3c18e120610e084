// How a body in space moves between the instants at which ODE knows it.
#pragma once

#include "model/space.h"

// Within a step of a leapfrog: `first` has the speeds of the step's start and positions of its
// middle, `mean` and `other` the mean accelerations of this step and of the one beside it, on the
// side of the time, s since the start. Speeds are linear, positions their integral, accelerations
// linear between mid-steps.
SpaceMotion space_between_leapfrog(const SpaceMotion *first, const SpaceMotion *mean,
                                   const SpaceMotion *other, double since_s, double step_s);

// The step before the first has no accelerations: they go on as they come, from the first two.
void space_between_guess(const SpaceMotion *first, const SpaceMotion *second, SpaceMotion *before);

// Within a plain step, from its start to its end: positions and speeds are linear, accelerations
// those of `last`, means of the step. ODE moves its bodies by the speed at the end.
SpaceMotion space_between_plain(const SpaceMotion *first, const SpaceMotion *last, double since_s,
                                double step_s);
