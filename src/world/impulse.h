// A step in which contacts of joints with play are integrated by themselves.
#pragma once

#include "world/world_response.h"

// Makes the world's step in velocities, from bodies that are kept at mid-step. `is_done` is false
// where that could not be done; bodies are as they were kept then.
JpStatus world_impulse_step(JpWorld *world, double step, WorldResponse *response, bool *is_done,
                            JpError *error);

// Moves bodies and rotors on to where the impulses of the step were late or early, and books what
// the contacts did.
void impulse_finish(JpWorld *world, double step, WorldResponse *response);
