// Finds when a body is fastest if the drive's speed changes.
//
// Between two kinks of the speed the motion is smooth. It is searched by the angle that the crank
// would turn at its largest speed, of which the grid (analytic/curve.c) has half a degree.
#include "analytic/driven_extremes.h"

#include "analytic/closed_form.h"
#include "analytic/curve.h"

typedef struct Signal {
    const Scenario *scenario;
    size_t body;
    bool is_alpha;
    double from_s;  // of the piece
    double per_rad; // s
} Signal;

static double signal_value(double turned, void *context)
{
    const Signal *signal = context;
    Motion motions[CLOSED_FORM_BODIES];
    const DriveState drive = drive_since(&signal->scenario->linkage.driver, signal->from_s,
                                         signal->from_s + signal->per_rad * turned);
    if (!closed_form_driven(signal->scenario, &drive, motions)) {
        return NAN;
    }
    const Motion *motion = &motions[signal->body];
    return signal->is_alpha ? motion->alpha : motion->omega;
}

static Extreme at(const Signal *signal, double value, double turned)
{
    const double time_s = signal->from_s + signal->per_rad * turned;
    return (Extreme){value, time_s, drive_angle(&signal->scenario->linkage.driver, time_s)};
}

// Takes the extremes of a piece where they go beyond those so far.
static void widen(Signal *signal, double end_s, Extreme *low, Extreme *high)
{
    const double turn = (end_s - signal->from_s) / signal->per_rad;
    const CurveExtreme found = curve_extreme(signal_value, signal, 0.0, turn);
    if (!(found.low >= low->value)) {
        *low = at(signal, found.low, found.low_angle);
    }
    if (!(found.high <= high->value)) {
        *high = at(signal, found.high, found.high_angle);
    }
}

BodyExtremes driven_extremes(const Scenario *scenario, size_t body, double from_s, double to_s)
{
    const Driver *driver = &scenario->linkage.driver;
    const Extreme none_low = {.value = INFINITY};
    const Extreme none_high = {.value = -INFINITY};
    BodyExtremes found = {none_high, none_low, none_high, none_low};
    Signal signal = {.scenario = scenario, .body = body, .per_rad = 1.0 / fabs(driver->speed)};
    for (double start_s = from_s; start_s < to_s;) {
        const double end_s = fmin(to_s, drive_next_kink(driver, start_s));
        signal.from_s = start_s;
        signal.is_alpha = false;
        widen(&signal, end_s, &found.omega_min, &found.omega_max);
        signal.is_alpha = true;
        widen(&signal, end_s, &found.alpha_min, &found.alpha_max);
        start_s = end_s;
    }
    return found;
}
