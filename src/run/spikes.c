// Finds the spikes of a signal in its trace.
//
// The positive part of s(t) and that of -s(t) are looked at each by itself, u = max(0, +-s): what
// goes away from zero is an excursion, what comes back between two of them is none.
//     prominence   of a maximum of u: its height above the higher of the lowest values on either
//                  side, up to where u is higher than the maximum, or the run ends
//     spike        a maximum whose prominence reaches the threshold
//     width        from where u, outwards from the peak, first is half the prominence lower
//     onset, end   the knees: between the peak p and the lowest value q before the neighbouring
//                  spike, and before u, once half the prominence lower, is back at three quarters,
//                  where u is furthest below the straight line from p to q
//     impulse      integral of s from onset to end: of an acceleration the change of speed
// All on the trace's broken line. The sides are searched with a stack of the maxima that no later
// one has overtopped: a number of operations in proportion to the points.
// Source: prominence is the persistence of a maximum, H. Edelsbrunner and J. Harer, Computational
// Topology, 2010, VII.1; knees: V. Satopaa and others, Finding a Kneedle in a Haystack, 2011.
#include "run/spikes.h"
#include "base/memory.h"
#include "run/ideal.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

// of the prominence: values so near to each other are as low as each other, as the trace knows
// them no better
static const double SPIKES_ALIKE = 1e-3;

// One of the two parts of a signal as a broken line.
typedef struct Part {
    double sign;
    size_t count;
    TracePoint *points; // integrals are the signal's own
} Part;

// A maximum of a part.
typedef struct Peak {
    size_t point;
    double left; // lowest value on either side
    double right;
    double prominence;
} Peak;

// Where the line between two points crosses a value that lies between theirs.
static TracePoint cross(const TracePoint *a, const TracePoint *b, double value)
{
    const double width = b->time_s - a->time_s;
    const double share = (value - a->value) / (b->value - a->value);
    const double since = share * width;
    // the line's own integral, and its share of what the line does not show
    const double hidden = b->integral - a->integral - 0.5 * width * (a->value + b->value);
    return (TracePoint){
        .time_s = a->time_s + since,
        .value = value,
        .integral = a->integral + 0.5 * since * (a->value + value) + share * hidden,
    };
}

static Part spikes_take_part(const Trace *trace, double sign)
{
    Part part = {.sign = sign, .points = memory_plain(2 * trace->count + 1, sizeof *part.points)};
    for (size_t i = 0; i < trace->count; i++) {
        const TracePoint *point = &trace->points[i];
        const TracePoint *before = &trace->points[i > 0 ? i - 1 : 0];
        if (before->value * point->value < 0.0) {
            TracePoint zero = cross(before, point, 0.0);
            part.points[part.count++] = zero;
        }
        part.points[part.count] = *point;
        part.points[part.count++].value = fmax(0.0, sign * point->value);
    }
    return part;
}

// The maxima of a part, each with the lowest value up to the maximum next to it on either side. A
// flat top is one maximum, at its start; the ends of the run are none.
static size_t list_peaks(const Part *part, Peak *peaks)
{
    size_t count = 0;
    double lowest = part->points[0].value;
    bool is_rising = false;
    for (size_t i = 1; i < part->count; i++) {
        const double change = part->points[i].value - part->points[i - 1].value;
        if (change > 0.0) {
            if (!is_rising && count > 0) {
                peaks[count - 1].right = lowest;
            }
            peaks[count].left = is_rising ? peaks[count].left : lowest;
            peaks[count].point = i;
            is_rising = true;
        } else if (change < 0.0) {
            count += is_rising ? 1 : 0;
            lowest = part->points[i].value;
            is_rising = false;
        }
    }
    if (count > 0 && !is_rising) {
        peaks[count - 1].right = lowest;
    }
    return count;
}

static double height(const Part *part, const Peak *peak)
{
    return part->points[peak->point].value;
}

// Lets the lowest values reach as far as the maximum overtops what is there: of two that are as
// high as each other the earlier one does.
static void spread_lows(const Part *part, size_t count, Peak *peaks, size_t *stack)
{
    size_t depth = 0;
    for (size_t i = 0; i < count; i++) {
        while (depth > 0 && height(part, &peaks[stack[depth - 1]]) < height(part, &peaks[i])) {
            peaks[i].left = fmin(peaks[i].left, peaks[stack[--depth]].left);
        }
        stack[depth++] = i;
    }
    depth = 0;
    for (size_t i = count; i-- > 0;) {
        while (depth > 0 && height(part, &peaks[stack[depth - 1]]) <= height(part, &peaks[i])) {
            peaks[i].right = fmin(peaks[i].right, peaks[stack[--depth]].right);
        }
        stack[depth++] = i;
    }
}

// Keeps the maxima that stand out.
static size_t select_peaks(const Part *part, double threshold, Peak *peaks)
{
    size_t *stack = memory_plain(part->count, sizeof *stack);
    const size_t count = list_peaks(part, peaks);
    spread_lows(part, count, peaks, stack);
    free(stack);
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        peaks[i].prominence = height(part, &peaks[i]) - fmax(peaks[i].left, peaks[i].right);
        if (peaks[i].prominence >= threshold) {
            peaks[kept++] = peaks[i];
        }
    }
    return kept;
}

// Where the flank of a peak may go on: the lowest point before another one, and before the part,
// once it has fallen, has risen again. Of several as low the furthest: a knee is seen from afar.
static size_t spikes_find_limit(const Part *part, const Peak *peak, size_t other)
{
    const int step = other >= peak->point ? 1 : -1;
    const double fallen = height(part, peak) - 0.5 * peak->prominence;
    const double risen = height(part, peak) - 0.25 * peak->prominence;
    const double alike = SPIKES_ALIKE * peak->prominence;
    double least = height(part, peak);
    size_t limit = peak->point;
    for (size_t i = peak->point; i != other;) {
        i = (size_t)((long)i + step);
        const double value = part->points[i].value;
        if (value > risen && least <= fallen) {
            break;
        }
        limit = value <= least + alike ? i : limit;
        least = fmin(least, value);
    }
    return limit;
}

// The knee between a peak and a limit: never on a shoulder above the level.
static size_t find_knee(const Part *part, size_t peak, size_t limit, double level)
{
    const TracePoint *p = &part->points[peak];
    const TracePoint *q = &part->points[limit];
    const int step = limit >= peak ? 1 : -1;
    const double slope = limit == peak ? 0.0 : (q->value - p->value) / (q->time_s - p->time_s);
    size_t knee = limit;
    double furthest = 0.0;
    for (size_t i = peak; i != limit; i = (size_t)((long)i + step)) {
        const TracePoint *point = &part->points[i];
        const double below = p->value + slope * (point->time_s - p->time_s) - point->value;
        if (below > furthest && point->value <= level) {
            furthest = below;
            knee = i;
        }
    }
    return knee;
}

// The time at which the part has fallen to a level on the way from the peak to a limit, or that of
// the limit.
static double find_level(const Part *part, size_t peak, size_t limit, double level)
{
    const int step = limit >= peak ? 1 : -1;
    for (size_t i = peak; i != limit;) {
        const size_t next = (size_t)((long)i + step);
        if (part->points[next].value <= level) {
            return cross(&part->points[i], &part->points[next], level).time_s;
        }
        i = next;
    }
    return part->points[limit].time_s;
}

static SignalSpike spikes_measure(const Part *part, const Peak *peak, size_t before, size_t behind)
{
    const TracePoint *top = &part->points[peak->point];
    const double level = top->value - 0.5 * peak->prominence;
    const size_t first = spikes_find_limit(part, peak, before);
    const size_t last = spikes_find_limit(part, peak, behind);
    const TracePoint *onset = &part->points[find_knee(part, peak->point, first, level)];
    const TracePoint *end = &part->points[find_knee(part, peak->point, last, level)];
    return (SignalSpike){
        .onset_s = onset->time_s,
        .time_s = top->time_s,
        .end_s = end->time_s,
        .value = part->sign * top->value,
        .prominence = peak->prominence,
        .width_s = find_level(part, peak->point, last, level) -
                   find_level(part, peak->point, first, level),
        .impulse = end->integral - onset->integral,
        .joint = -1,
    };
}

// Adds the spikes of one part of the signal to a list that has room for them.
static size_t spikes_add_part(const Trace *trace, double sign, double threshold,
                              SignalSpike *spikes)
{
    Part part = spikes_take_part(trace, sign);
    Peak *peaks = memory_plain(part.count, sizeof *peaks);
    const size_t count = select_peaks(&part, threshold, peaks);
    for (size_t i = 0; i < count; i++) {
        const size_t before = i > 0 ? peaks[i - 1].point : 0;
        const size_t behind = i + 1 < count ? peaks[i + 1].point : part.count - 1;
        spikes[i] = spikes_measure(&part, &peaks[i], before, behind);
    }
    free(peaks);
    free(part.points);
    return count;
}

static int by_time(const void *a, const void *b)
{
    const SignalSpike *first = a;
    const SignalSpike *second = b;
    return (first->time_s > second->time_s) - (first->time_s < second->time_s);
}

size_t spikes_find(const Trace *trace, double threshold, SignalSpike **spikes)
{
    assert(threshold > 0.0);
    *spikes = NULL;
    if (trace->count < 3 || !(trace->largest >= threshold)) {
        return 0;
    }
    SignalSpike *found = memory_plain(trace->count, sizeof *found);
    size_t count = spikes_add_part(trace, 1.0, threshold, found);
    count += spikes_add_part(trace, -1.0, threshold, found + count);
    qsort(found, count, sizeof *found, by_time);
    *spikes = found;
    return count;
}

SpikeScale spike_scale(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    IdealSizes sizes = ideal_sizes(scenario);
    SpikeScale scale = {.alpha = linkage->driver.speed * linkage->driver.speed};
    for (size_t i = 0; i < linkage->body_count; i++) {
        scale.alpha = fmax(scale.alpha, sizes.alpha_range[i]);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        scale.force = fmax(scale.force, sizes.force_max[i]);
    }
    scale.is_known = sizes.is_known && scale.force > 0.0;
    ideal_sizes_free(&sizes);
    return scale;
}

// What a signal did in a run, in few points.
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
static void spikes_begin(Trace *trace, const TracePoint *point)
{
    trace->first = trace->last = trace->top = trace->bottom = *point;
    trace->most_slope = INFINITY;
    trace->least_slope = -INFINITY;
}

// Keeps the last point seen, and before it the extremes that it and the line's start do not reach.
static void spikes_keep(Trace *trace)
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
    spikes_begin(trace, &last);
}

void trace_close(Trace *trace)
{
    if (trace->count > 0 && trace->last.time_s > trace->first.time_s) {
        spikes_keep(trace);
    }
}

// Goes over the points once more with twice the tolerance, until three quarters of the room are
// free or nothing more can be had. The points written never catch up with those read.
static void spikes_thin(Trace *trace)
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
        spikes_begin(trace, &trace->points[0]);
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
        spikes_begin(trace, point);
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
        spikes_begin(trace, point);
        return;
    }
    if (!(point->time_s > trace->last.time_s)) {
        jump(trace, point);
        return;
    }
    const double width = point->time_s - trace->first.time_s;
    const double rise = point->value - trace->first.value;
    if (rise > trace->most_slope * width || rise < trace->least_slope * width) {
        spikes_keep(trace);
        if (trace->limit - trace->count < LIMIT_LEAST) {
            spikes_thin(trace);
        }
    }
    trace_add(trace, point->time_s, point->value, point->integral);
}
