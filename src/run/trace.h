// What a signal did in a run, in few points: a broken line that stays near all of its values, goes
// through its extremes, and knows its integral.
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

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
