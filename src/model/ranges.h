// The least and the largest value of each signal of a run in short stretches of time, whatever its
// samples show. Memory grows with the stretches and not with the steps.
#pragma once

#include "model/linkage.h"

#include <math.h>

typedef enum RangesOfBody { RANGES_OMEGA, RANGES_ALPHA, RANGES_ACCELERATION } RangesOfBody;
typedef enum RangesOfJoint { RANGES_FORCE, RANGES_GAP } RangesOfJoint;

enum {
    RANGES_OF_BODY = 3,
    RANGES_OF_JOINT = 2,
};

// least > most where nothing has been seen.
typedef struct Range {
    double least;
    double most;
} Range;

static const Range RANGE_EMPTY = {INFINITY, -INFINITY};

typedef struct Ranges {
    size_t body_count;
    size_t signal_count;
    size_t count; // of stretches; 0: no ranges are kept
    double width_s;
    Range *values; // [stretch * signal_count + signal]; owned
} Ranges;

// So many stretches of equal width from time zero on, all empty; with count 0 where there is no
// memory for them.
Ranges ranges_create(const Linkage *linkage, size_t count, double width_s);
void ranges_finish(Ranges *ranges);

// The number of a signal: omega (rad/s), alpha (rad/s^2), size of the acceleration of the centre
// of mass (m/s^2) of a body; force (N) and gap (m) of a joint.
static inline size_t ranges_of_body(size_t body, RangesOfBody which)
{
    return RANGES_OF_BODY * body + which;
}

static inline size_t ranges_of_joint(const Ranges *ranges, size_t joint, RangesOfJoint which)
{
    return RANGES_OF_BODY * ranges->body_count + RANGES_OF_JOINT * joint + which;
}

// The stretch that holds a time; what lies beyond the last belongs to the last.
size_t ranges_find(const Ranges *ranges, double time_s);

// The stretches that a time belongs to, one of them or at a border two: writes the first and
// returns the last.
size_t ranges_find_all(const Ranges *ranges, double time_s, size_t *first);

// Takes a value in at a time. One at the border of two stretches belongs to both.
void ranges_add(Ranges *ranges, size_t signal, double time_s, double value);

// What one signal did in the stretches from `first` to before `behind`.
Range ranges_over(const Ranges *ranges, size_t signal, size_t first, size_t behind);

static inline void range_add(Range *range, double value)
{
    range->least = value < range->least ? value : range->least;
    range->most = value > range->most ? value : range->most;
}

static inline void range_join(Range *range, const Range *other)
{
    range->least = other->least < range->least ? other->least : range->least;
    range->most = other->most > range->most ? other->most : range->most;
}
