// When do the force and the depth of a contact stop growing?
//
//     F = F_el(d) (1 + chi d'/v0) + c d'
//     dF/dt = F_el' d' (1 + chi d'/v0) + (F_el chi / v0 + c) d''
//     d'' = n . (a_pin - a_hole) + (v across n)^2 / |e|,    n outwards
// A maximum lies where such a rate turns from positive to negative; it is found on the polynomial
// of the step.
#include "reference/peaks.h"

#include "base/root.h"

#include <string.h>

// Rates of force, N/s, and depth, m/s, of one contact.
static void contact_rates(const Dynamics *dynamics, size_t number, const DynamicsState *state,
                          double *rates)
{
    const DynamicsContact *contact = &dynamics->contacts[number];
    const ForceLaw *law = &contact->law;
    const PinHole *pose = &state->contacts[number].pose;
    const int hole = 2 * contact->joint;
    const Vec2 outward = vec2_scale(-1.0, pose->normal);
    const Vec2 closing = vec2_sub(tree_end_acceleration(&dynamics->tree, &state->tree, hole + 1),
                                  tree_end_acceleration(&dynamics->tree, &state->tree, hole));
    const Vec2 moving = vec2_sub(tree_end_velocity(&dynamics->tree, &state->tree, hole + 1),
                                 tree_end_velocity(&dynamics->tree, &state->tree, hole));
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

double peaks_next(Peaks *peaks, const Stepper *stepper, double start_s, double end_s,
                  const DynamicsState *state)
{
    const Dynamics *dynamics = &stepper->dynamics;
    double earliest = end_s;
    size_t passed = SIZE_MAX;
    bool is_rising[2 * LINKAGE_JOINT_MAX];
    for (size_t i = 0; i < dynamics->contact_count; i++) {
        if (dynamics->contacts[i].mode != CONTACT_PRESSING) {
            // the next contact begins with both rising
            is_rising[2 * i] = is_rising[2 * i + 1] = true;
            continue;
        }
        double rates[2];
        contact_rates(dynamics, i, state, rates);
        for (int which = 0; which < 2; which++) {
            is_rising[2 * i + which] = rates[which] > 0.0;
            Peak peak = {stepper, i, which};
            double time = end_s;
            if (peaks->was_rising[2 * i + which] && rates[which] < 0.0 &&
                root_find(peak_rate, &peak, start_s, end_s, 0.0, &time) && time < earliest &&
                time > start_s) {
                earliest = time;
                passed = 2 * i + (size_t)which;
            }
        }
    }
    if (passed == SIZE_MAX) {
        memcpy(peaks->was_rising, is_rising, 2 * dynamics->contact_count * sizeof *is_rising);
    } else {
        peaks->was_rising[passed] = false;
    }
    return earliest;
}
