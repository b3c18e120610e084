// A box that slides on a floor, held by ODE's own contacts with friction, and a rod that swings in
// a bearing on it with play, about an axis across no edge of the box: its knocks press the box onto
// three of its corners now and then.
#pragma once

#include <jointplay/jointplay.h>

typedef struct PressedBase {
    double position[2][3]; // m, of the box and of the rod
    double contacts;       // of box and floor a step, on average
    JpWorldStats stats;
} PressedBase;

// Steps it for a duration, s, with ODE ready, under a surface layer of ODE's, m. Returns false with
// an error where the library refuses it.
bool pressed_base_run(JpStepping stepping, double layer, double step, double duration,
                      PressedBase *end, JpError *error);

// The largest distance between two ends in any coordinate, m.
double pressed_base_apart(const PressedBase *one, const PressedBase *other);
