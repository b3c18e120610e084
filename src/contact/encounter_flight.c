// With e0 and v the pin's centre and velocity, a its acceleration and c the play, |e0| = c:
//     |e0 + v t + a t^2 / 2|^2 - c^2 = t (2 e0 . v + (v . v + e0 . a) t + v . a t^2 + a . a t^3 /
//     4)
// At the wall the pin goes inwards, e0 . v < 0, and the cubic in brackets is below 0 until the pin
// is back at it. Outside a disc all signs are the other way round.
#include "contact/encounter_flight.h"

#include <math.h>

enum { HALVINGS = 200 };

typedef struct Cubic {
    double c[4]; // by power
} Cubic;

static double value_of(const Cubic *cubic, double t)
{
    const double *c = cubic->c;
    return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
}

// The root between two times, of which the cubic has another sign at the second.
static double find_root(const Cubic *cubic, double low, double high)
{
    for (int i = 0; i < HALVINGS && high - low > 1e-16 * high; i++) {
        const double middle = 0.5 * (low + high);
        if (value_of(cubic, middle) < 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return high;
}

// The times up to `last` between which the cubic only grows or only falls, in their order.
static size_t find_turns(const Cubic *cubic, double last, double turns[3])
{
    const double a = 3.0 * cubic->c[3];
    const double half = cubic->c[2];
    const double b = cubic->c[1];
    const double square = half * half - a * b;
    const double q = square > 0.0 ? -(half + copysign(sqrt(square), half)) : 0.0;
    // a root of the derivative that does not exist is no number or no time
    const double roots[2] = {q / a, b / q};
    const double first = fmin(roots[0], roots[1]);
    const double second = fmax(roots[0], roots[1]);
    size_t count = 0;
    if (first > 0.0 && first < last) {
        turns[count++] = first;
    }
    if (second > first && second > 0.0 && second < last) {
        turns[count++] = second;
    }
    turns[count++] = last;
    return count;
}

// The first time above 0 at which a cubic that starts below 0 is no longer.
static double first_root(const Cubic *cubic, double last)
{
    double turns[3];
    const size_t count = find_turns(cubic, last, turns);
    double low = 0.0;
    for (size_t i = 0; i < count; i++) {
        if (value_of(cubic, turns[i]) >= 0.0) {
            return find_root(cubic, low, turns[i]);
        }
        low = turns[i];
    }
    return INFINITY;
}

double encounter_flight_time(const Encounter *encounter, size_t joint, const EncounterPoint *from,
                             double left_s)
{
    const EncounterJoint *of = &encounter->joints[joint];
    // nothing presses: the impulses, and what they do to the accelerations, stay as they are
    double free[2];
    for (size_t i = 0; i < 2; i++) {
        free[i] = encounter_motion_acceleration(encounter, of->first_row + i, from->time_s,
                                                from->impulse, from->force);
    }
    const PinHole pose =
        encounter_motion_pose(encounter, joint, from->time_s, from->impulse, from->moment);
    if (of->shape == TOUCH_LINE) {
        // the gap grows by -approach t + free t^2 / 2
        const double time_s = 2.0 * pose.approach_speed / free[0];
        return time_s > 0.0 && time_s <= left_s ? time_s : INFINITY;
    }
    const Vec2 e = pose.eccentricity;
    const Vec2 a = {free[0], free[1]};
    const Vec2 v = {
        encounter_motion_speed(encounter, of->first_row, from->time_s, from->impulse, from->moment),
        encounter_motion_speed(encounter, of->first_row + 1, from->time_s, from->impulse,
                               from->moment),
    };
    const double sign = of->radial_clearance < 0.0 ? -1.0 : 1.0;
    const Cubic cubic = {{
        2.0 * sign * vec2_dot(e, v),
        sign * (vec2_dot(v, v) + vec2_dot(e, a)),
        sign * vec2_dot(v, a),
        sign * 0.25 * vec2_dot(a, a),
    }};
    return first_root(&cubic, left_s);
}
