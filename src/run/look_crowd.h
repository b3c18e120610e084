// The extremes of many signals in one step, found together.
#pragma once

#include "run/look.h"

// Tells the recorder what the signals of the part reach between two looks at a step's ends, where
// that may be beyond the run's extremes so far, and lets the looker have the tops.
void look_at_crowd(Looker *looker, const Look *before, const Look *end);

// A signal at one instant.
typedef struct LookPoint {
    double time_s;
    double value;
    double omega; // rad/s, of a body
} LookPoint;

enum { LOOK_PATH_MAX = LOOK_MAX + LOOK_SIGNS };

// Alpha of a body or force of a joint at looks, and at its tops between them where a crowd was
// looked at since the room was emptied. `before` is when the looks begin.
size_t look_path(const Looker *looker, RecorderSignal signal, size_t number, double before_s,
                 int count, const Look *looks, LookPoint path[LOOK_PATH_MAX]);
