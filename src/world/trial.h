// Steps of ODE's that are taken back, to learn what a world does under a push.
#pragma once

#include "world/play.h"

// One step of ODE, for good or to be taken back. Fails where ODE has no memory for it.
JpStatus trial_step(JpWorld *world, double step, JpError *error);

// Fails where the world has bodies that are not known: a trial would move them for good.
JpStatus trial_check(JpWorld *world, JpError *error);

// The acceleration in a direction for a force of 1, from two steps that are taken back: with a
// force, and without. Bodies are as they were kept.
JpStatus trial_mobility(JpWorld *world, const Direction *direction, double force, double step,
                        double *mobility, JpError *error);
