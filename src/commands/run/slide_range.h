// How far and how fast the slider of a prismatic joint or of a block between guides went along its
// line, at the samples of a run.
#pragma once

#include "model/trajectory.h"

typedef struct SlideRange {
    Extreme position[2];     // m, least and most, along the line from its point on body a
    Extreme velocity[2];     // m/s, likewise, of the slider against the line's body
    Extreme acceleration[2]; // m/s^2, of the slider's centre of mass, along the line
    Extreme resultant;       // N, largest size of the vector sum of all forces on the slider in it
} SlideRange;

// Whether a joint has a slider.
bool slide_range_has(const Joint *joint);

SlideRange slide_range_find(const Linkage *linkage, const Trajectory *run, size_t joint);

// The acceleration of the slider's centre of mass along the line at a sample, m/s^2.
double slide_range_acceleration(const Linkage *linkage, const Trajectory *run, size_t sample,
                                size_t joint);
