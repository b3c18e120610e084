// The trace of a signal, its spikes, and the scale above which a peak is one.
#pragma once

#include "model/scenario.h"
#include "model/signal_spikes.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

// What a signal did in a run, in few points: a broken line that stays near all of its values, goes
// through its extremes, and knows its integral.

typedef struct TracePoint {
    double time_s;
    double value;
    double integral; // of the signal, up to there
} TracePoint;

typedef struct Trace {
    // the stretch under way: from the last point kept to the last one seen
    TracePoint first;
    TracePoint last;
    TracePoint top;
    TracePoint bottom;
    double most_slope; // of lines from the first point that pass near all values since
    double least_slope;
    double tolerance; // of the line: it grows with the signal
    double largest;   // |value| so far

    double floor;      // the tolerance is at least this
    double coarseness; // 1, doubled whenever the points would have become too many
    size_t limit;      // most points, but for what jumps need
    size_t capacity;
    size_t count;
    TracePoint *points; // owned; times never fall
} Trace;

// An empty trace of at most `limit` points, 8 or more, with a tolerance of at least `floor`.
Trace trace_start(double floor, size_t limit);
void trace_finish(Trace *trace);

// Keeps what is under way too: the line then ends at the last value seen. Nothing is added later.
void trace_close(Trace *trace);

// Of trace_add: what is not a step on along the line.
void trace_turn(Trace *trace, const TracePoint *point);

// Takes in the signal at a time not before the last one. Two values at one time are a jump.
static inline void trace_add(Trace *trace, double time_s, double value, double integral)
{
    const TracePoint point = {time_s, value, integral};
    const double width = time_s - trace->first.time_s;
    const double rise = value - trace->first.value;
    if (!(time_s > trace->last.time_s && fabs(value) <= trace->largest &&
          rise <= trace->most_slope * width && rise >= trace->least_slope * width)) {
        trace_turn(trace, &point);
        return;
    }
    // once a signal and step: fmin and fmax would be calls
    const double inverse = 1.0 / width;
    const double most = (rise + trace->tolerance) * inverse;
    const double least = (rise - trace->tolerance) * inverse;
    trace->most_slope = most < trace->most_slope ? most : trace->most_slope;
    trace->least_slope = least > trace->least_slope ? least : trace->least_slope;
    trace->last = point;
    if (value > trace->top.value) {
        trace->top = point;
    }
    if (value < trace->bottom.value) {
        trace->bottom = point;
    }
}

// Finds the spikes whose prominence is at least the threshold, above 0, in the order of their
// peaks. Fills in all of each but crank angle and joint, which is -1. `spikes` receives an array
// that the caller frees, NULL where there are none. Returns how many. The trace must be closed.
size_t spikes_find(const Trace *trace, double threshold, SignalSpike **spikes);

// How much do accelerations and forces vary without any play? What stands out further is a spike.

typedef struct SpikeScale {
    bool is_known; // false: nothing drives, or the ideal linkage does not go all the way round
    double alpha;  // rad/s^2: above 0
    double force;  // N: above 0
} SpikeScale;

// Sizes in a turn of the driver with every joint ideal, over all bodies and joints: the largest
// range of an angular acceleration, or the square of the driver's speed where that is more, and the
// largest force.
SpikeScale spike_scale(const Scenario *scenario);
