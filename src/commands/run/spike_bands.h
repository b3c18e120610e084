// The bands of the crank angle in which the paper saw its spikes.
#pragma once

#include "commands/run/run_report.h"

enum { SPIKE_BAND_COUNT = 2 };

// 120 to 130 and 290 to 300 deg, each from its first sector to before its last: Sec. on Fig. 6,
// where the crank is normal to the coupler, and the coupler to the ground. Angles of the crank
// against the ground, whichever way it turns.
extern const size_t SPIKE_BANDS[SPIKE_BAND_COUNT];

// Spikes of one signal with their peaks in the bands and outside of them.
typedef struct SpikeBandSums {
    SignalSector inside;
    SignalSector outside;
} SpikeBandSums;

SpikeBandSums spike_bands_sums(const SignalSpikes *spikes);

// Whether the bands mean anything: in the paper's four-bar with the paper's play, and in no other.
bool spike_bands_apply(const RunReport *report);

// The two ends of a band, degrees.
double spike_bands_first_deg(size_t band);
double spike_bands_last_deg(size_t band);
