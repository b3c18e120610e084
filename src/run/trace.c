// What did a signal do in a run, in few points?
//
// A point s_n is left out as long as one line from the last point kept, s_0, to the newest passes
// every point between by no more than the tolerance:
//     max (s_i - E - s_0) / (t_i - t_0)  <=  (s_n - s_0) / (t_n - t_0)  <=  min (s_i + E - s_0) /
//     ..
// Where it does not, the point before is kept and a new line begins there. The largest and the
// smallest value passed over are kept with it, exactly; a line that they bend passes the others by
// no more than 2 E. A constant number of operations a point.
// Source: the swinging door of E. H. Bristol, Swinging door trending: adaptive trend recording, ISA
// 1990; in this form, which keeps the signal's own points, K. D. Fowell and D. D. McNeil, Faster
// plots by fan data-compression, IEEE Computer Graphics and Applications 9 (1989).
#include "run/trace.h"

#include <assert.h>
#include <stdint.h>
#include <stdlib.h>

// E over the largest value so far: half a swing is then some 25 points, and its width is right to
// a thousandth
static const double SHARE = 1e-3;

enum { FIRST_CAPACITY = 256, LIMIT_LEAST = 8 };

Trace trace_start(double floor, size_t limit)
{
    assert(limit >= LIMIT_LEAST);
    return (Trace){.floor = floor, .tolerance = floor, .coarseness = 1.0, .limit = limit};
}

void trace_finish(Trace *trace)
{
    free(trace->points);
    *trace = (Trace){.points = NULL};
}

static void set_tolerance(Trace *trace)
{
    trace->tolerance = trace->coarseness * fmax(trace->floor, SHARE * trace->largest);
}

static void append(Trace *trace, const TracePoint *point)
{
    if (trace->count == trace->capacity) {
        trace->capacity = trace->capacity > 0 ? 2 * trace->capacity : FIRST_CAPACITY;
        trace->points = realloc(trace->points, trace->capacity * sizeof *trace->points);
        assert(trace->points != NULL);
    }
    trace->points[trace->count++] = *point;
}

// Begins a line at a point that has been kept.
static void begin(Trace *trace, const TracePoint *point)
{
    trace->first = trace->last = trace->top = trace->bottom = *point;
    trace->most_slope = INFINITY;
    trace->least_slope = -INFINITY;
}

// Keeps the last point seen, and before it the extremes that it and the line's start do not reach.
static void keep(Trace *trace)
{
    const TracePoint last = trace->last;
    const bool has_top = trace->top.value > fmax(trace->first.value, last.value);
    const bool has_bottom = trace->bottom.value < fmin(trace->first.value, last.value);
    const bool is_top_first = trace->top.time_s < trace->bottom.time_s;
    if (has_top && is_top_first) {
        append(trace, &trace->top);
    }
    if (has_bottom) {
        append(trace, &trace->bottom);
    }
    if (has_top && !is_top_first) {
        append(trace, &trace->top);
    }
    append(trace, &last);
    begin(trace, &last);
}

void trace_close(Trace *trace)
{
    if (trace->count > 0 && trace->last.time_s > trace->first.time_s) {
        keep(trace);
    }
}

// Goes over the points once more with twice the tolerance, until three quarters of the room are
// free or nothing more can be had. The points written never catch up with those read.
static void thin(Trace *trace)
{
    const TracePoint under_way = trace->last;
    const size_t aim = trace->limit / 4;
    size_t before = SIZE_MAX;
    // rewriting must not thin
    const size_t limit = trace->limit;
    trace->limit = SIZE_MAX;
    while (trace->count > aim && trace->count < before) {
        before = trace->count;
        trace->coarseness *= 2.0;
        set_tolerance(trace);
        trace->count = 1;
        begin(trace, &trace->points[0]);
        for (size_t i = 1; i < before; i++) {
            const TracePoint point = trace->points[i];
            trace_add(trace, point.time_s, point.value, point.integral);
        }
        trace_close(trace);
    }
    trace->limit = limit;
    trace_add(trace, under_way.time_s, under_way.value, under_way.integral);
}

// Two values at one time: both are kept.
static void jump(Trace *trace, const TracePoint *point)
{
    if (point->value != trace->last.value) {
        trace_close(trace);
        append(trace, point);
        begin(trace, point);
    }
}

void trace_turn(Trace *trace, const TracePoint *point)
{
    // a run with such a value fails, and has no spikes
    if (!isfinite(point->value)) {
        return;
    }
    if (fabs(point->value) > trace->largest) {
        trace->largest = fabs(point->value);
        set_tolerance(trace);
    }
    if (trace->count == 0) {
        append(trace, point);
        begin(trace, point);
        return;
    }
    if (!(point->time_s > trace->last.time_s)) {
        jump(trace, point);
        return;
    }
    const double width = point->time_s - trace->first.time_s;
    const double rise = point->value - trace->first.value;
    if (rise > trace->most_slope * width || rise < trace->least_slope * width) {
        keep(trace);
        if (trace->limit - trace->count < LIMIT_LEAST) {
            thin(trace);
        }
    }
    trace_add(trace, point->time_s, point->value, point->integral);
}
