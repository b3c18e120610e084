// Which of the two methods takes the next step: the explicit one, or the implicit one where a
// contact is damped so strongly that explicit steps are far shorter than the motion is smooth?
#pragma once

#include "model/scale.h"
#include "reference/radau.h"
#include "reference/system.h"

typedef struct Stiffness {
    Radau *radau; // owned; NULL before the first look
    size_t steps; // explicit ones since the last event or look
    // While the implicit method is on trial: the explicit step that it has to beat, s; else 0.
    double beaten_s;
    size_t wait;  // looks until another trial may follow the last one
    size_t pause; // as many were waited for after the last trial that was lost
} Stiffness;

// To be asked before each step, whether an event has come at its start or not, with the length of
// the step before it, s; the integrator stands at the state. Sets the method.
void stiffness_follow(Stiffness *stiffness, const System *system, const SystemState *state,
                      const SpeedScale *scale, double taken_s, bool is_event, Dop853 *integrator);

void stiffness_finish(Stiffness *stiffness);
