// The gaps of a place in the steps before a contact, where positions stand at mid-step.
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct Onset {
    double gaps[2]; // m, of the last step and of the one before it
    size_t known;   // how many of them nothing touched in
} Onset;

// The speed, m/s, at which a contact begins that is found at a gap, m, and a depth, m: `closing`,
// as it is now, where no steps before are known; else its mean over the last step, taken on to the
// crossing by its change from step to step.
double onset_speed(const Onset *onset, double closing, double gap, double depth, double step_s);

// Keeps the gap of a step, in which it touched or not.
void onset_note(Onset *onset, bool is_touching, double gap);
