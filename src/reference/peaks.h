// Where do the force and the depth of a contact have their maxima?
#pragma once

#include "reference/stepper.h"

// Force and depth of each contact, where it was left.
typedef struct Peaks {
    SystemState *scratch; // of the stepper's system, owned by whoever has the peaks
    bool was_rising[2 * SYSTEM_CONTACT_MAX];
    double last[2 * SYSTEM_CONTACT_MAX];
    double largest[2 * SYSTEM_CONTACT_MAX]; // since the contact began, at the times looked at
} Peaks;

// The earliest maximum of a pressing contact's force or depth between two times of the present
// step, or the later of them. The state is that at the later time.
double peaks_next(Peaks *peaks, const Stepper *stepper, double start_s, double end_s,
                  const SystemState *state);
