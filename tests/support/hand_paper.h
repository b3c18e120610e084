// The motion of cases/paper/impact-k66.yaml from its centred start by a program made for it alone:
// what an engineer would write by hand. Nothing is found that is not asked for: no extremes, no
// spikes, no energies.
#pragma once

#include "base/vec2.h"

#include <stddef.h>

// Its free bodies, coupler and follower.
enum { HAND_PAPER_BODIES = 2 };

typedef struct HandPaperSample {
    double angle[HAND_PAPER_BODIES]; // rad
    double omega[HAND_PAPER_BODIES]; // rad/s
    double alpha[HAND_PAPER_BODIES]; // rad/s^2
    Vec2 eccentricity;               // m, the crank pin's centre less its hole's
    double force;                    // N, in the crank pin
} HandPaperSample;

// One revolution of the crank, from 0 to its end, in so many equal intervals: one sample more than
// these. The tolerance is of a step, of angles in the play over a link, of speeds in the crank's.
// Returns how often the equations of motion were evaluated, or 0 where they could not be followed.
size_t hand_paper_run(double tolerance, size_t intervals, HandPaperSample *samples);
