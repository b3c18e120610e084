// The largest force and depth of a contact, which lie between the steps that know them.
#pragma once

#include <stdbool.h>

typedef struct ContactPeaks {
    double force; // N, the largest since the last step but one
    double depth; // m
    // to work with
    double forces[2]; // of the last two steps
    double depths[2];
    bool has_series; // whether there is a step behind the onset
    double since;    // s, between those two; at first from the onset
} ContactPeaks;

// A contact begins with a force; its first step is so far behind that, s.
void contact_peaks_begin(ContactPeaks *peaks, double force, double since);

// Notes force and depth of a step that is ahead of the last one, s; of the first it is 0.
void contact_peaks_note(ContactPeaks *peaks, double force, double depth, double ahead);

// Notes those of a step of a length, s, in a share of which the contact overlaps.
void contact_peaks_note_step(ContactPeaks *peaks, double force, double depth, double share,
                             double step_s);
