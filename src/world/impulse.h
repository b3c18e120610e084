// A step in which contacts of joints with play are integrated by themselves.
#pragma once

#include "world/world_response.h"

// Finds which bodies the joints with play can move in the step.
void impulse_reach(JpWorld *world);

// Makes the world's step in velocities, from bodies that are kept at mid-step. `is_done` is false
// where that could not be done; bodies are as they were kept then.
JpStatus world_impulse_step(JpWorld *world, double step, WorldResponse *response, bool *is_done,
                            JpError *error);

// Moves bodies and rotors on to where the impulses of the step were late or early, and books what
// the contacts did.
JpStatus impulse_finish(JpWorld *world, double step, WorldResponse *response, JpError *error);
