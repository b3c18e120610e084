// Where on an axis does a value stand, and at which values does the axis have ticks?
#include "write/axis.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

enum { AXIS_TICKS_WANTED = 6, AXIS_DECADE_LABELS = 7 };

// A value on its axis's own scale, on which distances are pixels.
static double scaled(const Axis *axis, double value)
{
    switch (axis->scale) {
    case AXIS_LOG:
        return log10(fmax(value, axis->low));
    case AXIS_SYMLOG: {
        const double ratio = fabs(value) / axis->threshold;
        return copysign(ratio <= 1.0 ? ratio : 1.0 + log10(ratio), value);
    }
    default:
        return value;
    }
}

double axis_share(const Axis *axis, double value)
{
    const double low = scaled(axis, axis->low);
    return (scaled(axis, value) - low) / (scaled(axis, axis->high) - low);
}

// The spacing of about that many ticks over a span: 1, 2 or 5 times a power of ten.
static double choose_tick(double span, int wanted)
{
    const double raw = span / wanted;
    const double power = pow(10.0, floor(log10(raw)));
    const double lead = raw / power;
    return power * (lead < 1.5 ? 1.0 : lead < 3.5 ? 2.0 : lead < 7.5 ? 5.0 : 10.0);
}

void axis_round(double *low, double *high)
{
    // a constant gets a range about itself
    if (!(*high - *low > 1e-9 * fmax(fabs(*low), fabs(*high)))) {
        const double margin = fmax(0.1 * fabs(*high), DBL_MIN * 1e6);
        *low -= margin;
        *high += margin;
    }
    const double margin = 0.02 * (*high - *low);
    const double tick = choose_tick(*high - *low, AXIS_TICKS_WANTED);
    *low = tick * floor((*low - margin) / tick);
    *high = tick * ceil((*high + margin) / tick);
}

// The nearest of 1, 2 and 5 times a power of ten below, or with `up` above.
static double round_to_125(double value, bool up)
{
    static const double LEADS[] = {0.5, 1.0, 2.0, 5.0, 10.0};
    const double power = pow(10.0, floor(log10(value)));
    for (int i = 0; i < 5; i++) {
        const int k = up ? i : 4 - i;
        if (up ? LEADS[k] * power >= value : LEADS[k] * power <= value) {
            return LEADS[k] * power;
        }
    }
    return value;
}

void axis_round_log(double *low, double *high)
{
    *low = round_to_125(*low / 1.3, false);
    *high = round_to_125(*high * 1.2, true);
    if (floor(log10(*high) + 1e-9) - ceil(log10(*low) - 1e-9) < 1.0) {
        *low = pow(10.0, floor(log10(*low) + 1e-9));
        *high = pow(10.0, ceil(log10(*high) - 1e-9));
    }
}

// The ticks of a logarithmic side of an axis: powers of ten, thinned out where they are many.
static size_t decade_ticks(double low, double high, double sign, double *ticks)
{
    const int first = (int)ceil(log10(low) - 1e-9);
    const int last = (int)floor(log10(high) + 1e-9);
    const int stride = 1 + (last - first) / AXIS_DECADE_LABELS;
    size_t count = 0;
    for (int power = first; power <= last && count < AXIS_TICK_MAX / 2; power += stride) {
        ticks[count++] = sign * pow(10.0, power);
    }
    return count;
}

size_t axis_ticks(const Axis *axis, double *ticks)
{
    size_t count = 0;
    if (axis->scale == AXIS_LOG) {
        return decade_ticks(axis->low, axis->high, 1.0, ticks);
    }
    if (axis->scale == AXIS_SYMLOG) {
        count = axis->low < -axis->threshold
                    ? decade_ticks(axis->threshold, -axis->low, -1.0, ticks)
                    : 0;
        ticks[count++] = 0.0;
        if (axis->high > axis->threshold) {
            count += decade_ticks(axis->threshold, axis->high, 1.0, ticks + count);
        }
        return count;
    }
    const double wanted = axis->tick;
    const double tick =
        wanted > 0.0 ? wanted : choose_tick(axis->high - axis->low, AXIS_TICKS_WANTED);
    const double first = ceil(axis->low / tick - 1e-9);
    const double last = floor(axis->high / tick + 1e-9);
    for (double i = first; i <= last && count < AXIS_TICK_MAX; i += 1.0) {
        ticks[count++] = i == 0.0 ? 0.0 : i * tick;
    }
    return count;
}
