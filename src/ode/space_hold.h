// The ideal joints of a world in space with many of them, held by forces that are found here
// instead of by rows of ODE: ode/plane/world_hold.h in space.
#pragma once

#include "model/scenario.h"
#include "model/space_response.h"
#include "ode/plane/world.h"

typedef struct SpaceHold SpaceHold;

// What holds the ideal joints of a scenario with that response; NULL where they are rows of ODE.
// For space_hold_free, which accepts NULL.
SpaceHold *space_hold_make(const Scenario *scenario, const SpaceResponse *response);
void space_hold_free(SpaceHold *hold);

// Pushes the bodies, on which all else acts already, so that a step keeps the joints closed, and
// fills in the feedback of the joints as ODE does. The response is that of the motions given: the
// bodies as the step has them.
void space_hold_push(SpaceHold *hold, const SpaceResponse *response, const SpaceMotion *motions,
                     double step_s, World *world);
