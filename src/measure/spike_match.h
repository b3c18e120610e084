// Which contact of one run is which of another, and how far apart are they?
#pragma once

#include "model/trajectory.h"

typedef struct SpikePair {
    size_t spike;           // number among the run's spikes of the joint
    size_t reference_spike; // likewise, of the reference
    double onset_delay_s;   // the run's onset less the reference's
    double force_error;     // 1: the run's largest force over the reference's, less 1
    double impulse_error;   // 1: of the impulse, likewise
} SpikePair;

typedef struct SpikeMatch {
    size_t pair_count;
    SpikePair pairs[TRAJECTORY_SPIKE_MAX]; // in the order of the reference's spikes
    size_t missed;                         // spikes of the reference that nothing answers to
    size_t extra;                          // spikes of the run that answer to none
} SpikeMatch;

// Pairs the kept spikes of one joint by their onsets: a pair is nearer to each other than half the
// distance to the next spike of either run, so that no spike can belong to two, and nearer than
// the reach, s. Left out are spikes that begin after the horizon, s, with their partners, and
// spikes without force or impulse. Both trajectories must be complete and of the same scenario.
SpikeMatch spike_match(const Trajectory *trajectory, const Trajectory *reference, size_t joint,
                       double horizon_s, double reach_s);

// The reach of a scenario, s: a small part of a turn of its driver, or of the run where that is
// shorter or there is no driver.
double spike_match_reach(const Scenario *scenario);
