// Where does a signal stand out, how far, for how long, and with what impulse?
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

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// of the prominence: values so near to each other are as low as each other, as the trace knows
// them no better
static const double ALIKE = 1e-3;

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

static Part take_part(const Trace *trace, double sign)
{
    Part part = {.sign = sign, .points = calloc(2 * trace->count + 1, sizeof *part.points)};
    assert(part.points != NULL);
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
    size_t *stack = calloc(part->count, sizeof *stack);
    assert(stack != NULL);
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
static size_t find_limit(const Part *part, const Peak *peak, size_t other)
{
    const int step = other >= peak->point ? 1 : -1;
    const double fallen = height(part, peak) - 0.5 * peak->prominence;
    const double risen = height(part, peak) - 0.25 * peak->prominence;
    const double alike = ALIKE * peak->prominence;
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

static SignalSpike measure(const Part *part, const Peak *peak, size_t before, size_t behind)
{
    const TracePoint *top = &part->points[peak->point];
    const double level = top->value - 0.5 * peak->prominence;
    const size_t first = find_limit(part, peak, before);
    const size_t last = find_limit(part, peak, behind);
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
static size_t add_part(const Trace *trace, double sign, double threshold, SignalSpike *spikes)
{
    Part part = take_part(trace, sign);
    Peak *peaks = calloc(part.count, sizeof *peaks);
    assert(peaks != NULL);
    const size_t count = select_peaks(&part, threshold, peaks);
    for (size_t i = 0; i < count; i++) {
        const size_t before = i > 0 ? peaks[i - 1].point : 0;
        const size_t behind = i + 1 < count ? peaks[i + 1].point : part.count - 1;
        spikes[i] = measure(&part, &peaks[i], before, behind);
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
    SignalSpike *found = calloc(trace->count, sizeof *found);
    assert(found != NULL);
    size_t count = add_part(trace, 1.0, threshold, found);
    count += add_part(trace, -1.0, threshold, found + count);
    qsort(found, count, sizeof *found, by_time);
    *spikes = found;
    return count;
}
