// An axis: a range of values on a linear or logarithmic scale, and its ticks.
#pragma once

#include <stddef.h>

enum { AXIS_TICK_MAX = 64 };

typedef enum AxisScale {
    AXIS_LINEAR,
    AXIS_LOG,    // what is not positive lies on the lower edge
    AXIS_SYMLOG, // linear up to the threshold, a decade a tick beyond it, on both sides of zero
} AxisScale;

typedef struct Axis {
    const char *title; // with its unit
    AxisScale scale;
    double low; // at the left or lower edge
    double high;
    double threshold; // of AXIS_SYMLOG
    double tick;      // of AXIS_LINEAR: distance of the ticks; 0: chosen
} Axis;

// Where a value stands between the two edges, 0 to 1; outside of them beyond that.
double axis_share(const Axis *axis, double value);

// The values of at most AXIS_TICK_MAX ticks; their count.
size_t axis_ticks(const Axis *axis, double *ticks);

// Widens a range to whole ticks, so that nothing touches the edges.
void axis_round(double *low, double *high);

// Widens a range of a logarithmic axis to 1, 2 or 5 times powers of ten, and so far that at least
// two powers of ten stand in it.
void axis_round_log(double *low, double *high);
