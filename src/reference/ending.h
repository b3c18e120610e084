// How long may a step be in which a contact is about to end?
#pragma once

#include "reference/system.h"

// What the ends of contacts have shown so far.
typedef struct Ending {
    double crossed; // N s: ends with less than so much impulse to come can be crossed
    double size;    // N s, to come at the end that the present step is to cross; negative: none
} Ending;

// Where nothing has been seen yet.
Ending ending_start(void);

// The longest step from a state on, which is the integrator's, s; infinite where no contact ends
// soon. The integrator has the rates there, and its room for a state is used.
double ending_limit(Ending *ending, const System *system, const SystemState *state,
                    const Dop853 *integrator);

// Takes note of whether the step was refused.
void ending_note(Ending *ending, bool is_refused);
