// When do the force and the depth of a contact stop growing?
//
//     F = F_el(d) (1 + chi d'/v0) + c d'
//     dF/dt = F_el' d' (1 + chi d'/v0) + (F_el chi / v0 + c) d''
//     d'' = n . (a_pin - a_hole) + (v across n)^2 / |e|,    n outwards
// A maximum lies where such a rate turns from positive to negative; it is found on the polynomial
// of the step.
#include "reference/peaks.h"

#include "base/root.h"

#include <stdint.h>

// of a step: a maximum missed by so much is too low by half the square of it, 1e-10 of itself
static const double NARROW = 1e-5;

// how much higher than both its ends a part of a step can rise: it is a seventh of a swing or so
static const double OVERSHOOT = 1.5;

// Rates of force, N/s, and depth, m/s, of one contact.
static void contact_rates(const Dynamics *dynamics, size_t number, const DynamicsState *state,
                          double *rates)
{
    const DynamicsContact *contact = &dynamics->contacts[number];
    const ForceLaw *law = &contact->law;
    const PinHole *pose = &state->contacts[number].pose;
    const Vec2 outward = vec2_scale(-1.0, pose->normal);
    const Vec2 closing = tree_joint_acceleration(&dynamics->tree, &state->tree, contact->joint);
    const Vec2 moving = tree_joint_velocity(&dynamics->tree, &state->tree, contact->joint);
    const double across = vec2_cross(outward, moving);
    const double second = vec2_dot(outward, closing) + across * across / pose->eccentricity_size;
    const double rise = 1.0 + contact->damping_rate * pose->approach_speed;
    rates[0] = force_law_tangent(law, pose->penetration) * pose->approach_speed * rise +
               (state->contacts[number].elastic * contact->damping_rate + law->viscous) * second;
    rates[1] = pose->approach_speed;
}

typedef struct Peak {
    const Stepper *stepper;
    size_t contact;
    int which;
} Peak;

static double peak_rate(double time, void *context)
{
    const Peak *peak = context;
    const Stepper *stepper = peak->stepper;
    DynamicsState state;
    double y[DOP853_SIZE_MAX];
    double rates[2];
    dop853_dense(&stepper->integrator, time, y);
    if (!dynamics_evaluate(&stepper->dynamics, time, y, &state)) {
        return NAN;
    }
    contact_rates(&stepper->dynamics, peak->contact, &state, rates);
    return rates[peak->which];
}

// Whether a maximum of one quantity lies between two times, and could be the largest of its
// contact.
static bool has_peak(const Peaks *peaks, size_t index, double rate, double value)
{
    return peaks->was_rising[index] && rate < 0.0 &&
           OVERSHOOT * fmax(value, peaks->last[index]) > peaks->largest[index];
}

// Takes note of where a contact is now.
static void leave(Peaks *peaks, size_t index, double rate, double value)
{
    peaks->was_rising[index] = rate > 0.0;
    peaks->last[index] = value;
    peaks->largest[index] = fmax(peaks->largest[index], value);
}

double peaks_next(Peaks *peaks, const Stepper *stepper, double start_s, double end_s,
                  const DynamicsState *state)
{
    const Dynamics *dynamics = &stepper->dynamics;
    double earliest = end_s;
    size_t passed = SIZE_MAX;
    double rates[LINKAGE_JOINT_MAX][2];
    for (size_t i = 0; i < dynamics->contact_count; i++) {
        if (dynamics->contacts[i].mode != CONTACT_PRESSING) {
            continue;
        }
        contact_rates(dynamics, i, state, rates[i]);
        const double values[2] = {state->contacts[i].normal, state->contacts[i].pose.penetration};
        for (int which = 0; which < 2; which++) {
            const size_t index = 2 * i + (size_t)which;
            Peak peak = {stepper, i, which};
            double time = end_s;
            if (has_peak(peaks, index, rates[i][which], values[which]) &&
                root_find(peak_rate, &peak, start_s, end_s, NARROW * (end_s - start_s), &time) &&
                time < earliest && time > start_s) {
                earliest = time;
                passed = index;
            }
        }
    }
    if (passed != SIZE_MAX) {
        peaks->was_rising[passed] = false;
        return earliest;
    }
    for (size_t i = 0; i < dynamics->contact_count; i++) {
        const bool is_pressing = dynamics->contacts[i].mode == CONTACT_PRESSING;
        for (size_t which = 0; which < 2; which++) {
            const size_t index = 2 * i + which;
            if (is_pressing) {
                leave(peaks, index, rates[i][which],
                      which == 0 ? state->contacts[i].normal : state->contacts[i].pose.penetration);
            } else {
                // the next contact begins with both rising from nothing
                peaks->was_rising[index] = true;
                peaks->last[index] = peaks->largest[index] = 0.0;
            }
        }
    }
    return end_s;
}
