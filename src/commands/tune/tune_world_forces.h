// What drives and pushes the bodies of a case as lines of a C program against libjointplay.
#pragma once

#include "base/text.h"
#include "model/linkage.h"

// Whether a spring at a joint moves anything: not where a drive says how the joint turns.
bool tune_world_has_effect(const Linkage *linkage, const TorsionSpring *spring);

// The angle, rad, at which a hinge of ODE's, which counts from where it starts, is at 0.
double tune_world_angle_at_start(const Linkage *linkage, int joint);

// Whether anything pushes where a step evaluates forces: springs, or a torque over time.
bool tune_world_pushes(const Linkage *linkage);

// Appends the function that pushes there, with what it needs; and the tables over time.
void tune_world_push(const Linkage *linkage, Text *text);

// Appends what is set once, when bodies and hinges are made.
void tune_world_motors(const Linkage *linkage, Text *text);

// Appends what is set before each step.
void tune_world_drive(const Linkage *linkage, Text *text);
