// Keeps how far each signal went, stretch by stretch.
#include "model/ranges.h"

#include <assert.h>
#include <stdlib.h>

// of a stretch: a time so near to a border is at it, but for rounding
static const double AT_BORDER = 1e-9;

Ranges ranges_create(const Linkage *linkage, size_t count, double width_s)
{
    assert(width_s > 0.0);
    Ranges ranges = {
        .body_count = linkage->body_count,
        .signal_count =
            RANGES_OF_BODY * linkage->body_count + RANGES_OF_JOINT * linkage->joint_count,
        .count = count,
        .width_s = width_s,
    };
    ranges.values = malloc(count * ranges.signal_count * sizeof *ranges.values);
    if (ranges.values == NULL) {
        ranges.count = 0;
    }
    for (size_t i = 0; i < ranges.count * ranges.signal_count; i++) {
        ranges.values[i] = RANGE_EMPTY;
    }
    return ranges;
}

void ranges_finish(Ranges *ranges)
{
    free(ranges->values);
    *ranges = (Ranges){0};
}

// The stretch at a time, counted in stretches.
static size_t stretch_at(const Ranges *ranges, double at)
{
    return at <= 0.0 ? 0 : at < (double)(ranges->count) ? (size_t)at : ranges->count - 1;
}

size_t ranges_find(const Ranges *ranges, double time_s)
{
    return stretch_at(ranges, time_s / ranges->width_s);
}

size_t ranges_find_all(const Ranges *ranges, double time_s, size_t *first)
{
    const double at = time_s / ranges->width_s;
    *first = stretch_at(ranges, at - AT_BORDER);
    return stretch_at(ranges, at + AT_BORDER);
}

void ranges_add(Ranges *ranges, size_t signal, double time_s, double value)
{
    size_t first;
    const size_t last = ranges_find_all(ranges, time_s, &first);
    for (size_t i = first; i <= last; i++) {
        range_add(&ranges->values[i * ranges->signal_count + signal], value);
    }
}

Range ranges_over(const Ranges *ranges, size_t signal, size_t first, size_t behind)
{
    Range over = RANGE_EMPTY;
    for (size_t i = first; i < behind && i < ranges->count; i++) {
        range_join(&over, &ranges->values[i * ranges->signal_count + signal]);
    }
    return over;
}
