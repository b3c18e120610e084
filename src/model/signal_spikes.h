// Spikes of a signal: where the angular acceleration of a body, or the force of a joint, goes away
// from zero and comes back. Found by run/spikes.c, which says what each word means.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// A turn of the crank in sectors of ten degrees.
enum { SIGNAL_SPIKE_MAX = 12, SIGNAL_SECTOR_COUNT = 36 };

// Values, prominences and impulses are rad/s^2 and rad/s of a body, N and N s of a joint.
typedef struct SignalSpike {
    double onset_s;
    double time_s; // of the peak
    double end_s;
    double crank_rad;  // at the peak, not wrapped
    double value;      // at the peak, with its sign
    double prominence; // how far the peak stands out, above 0
    double width_s;    // where half of the prominence is left
    double impulse;    // integral of the signal from onset to end, with its sign
    int joint;         // of a body's spike: the joint with play whose force changes most; else -1
} SignalSpike;

// The spikes that have their peaks in one sector.
typedef struct SignalSector {
    size_t count;
    double largest; // value of the strongest, without its sign
} SignalSector;

typedef struct SignalSpikes {
    bool is_known;     // false: they were not looked for, and nothing below is to be used
    double threshold;  // least prominence of a spike
    double resolution; // largest distance of the history they were found in from the signal
    size_t count;      // all of them
    size_t kept;       // of those below
    SignalSpike spikes[SIGNAL_SPIKE_MAX];      // the strongest by value, strongest first
    SignalSector sectors[SIGNAL_SECTOR_COUNT]; // of the crank angle; empty without a driver
} SignalSpikes;
