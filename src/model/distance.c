// How far are two motions of one linkage apart, in numbers that mean the same for all bodies?
//
//     d(t) = max over bodies |omega_b(t) - ref_b(t)| / max over t |ref_b|
// over every body whose speed is not prescribed. A body that hardly turns is measured by the omega
// with which its furthest joint would move at a thousandth of the speed of the fastest point of the
// linkage: its own would be rounding. Sizes are those of the body itself, so that a pivot far away
// changes nothing. Where no drive turns anything, bodies may not turn at all: the speeds of their
// centres then take the place of omega, and their accelerations that of alpha.
#include "model/distance.h"

enum { LEAST_SAMPLES = 1000 }; // fewer steps of a horizon would say little

static const double SMALLEST_SCALE =
    1e-3; // of the fastest point's: below it lies no motion to speak of

bool distance_is_by_velocity(const Trajectory *reference)
{
    return reference->driven_body == LINKAGE_GROUND;
}

double distance_of_rates(const Motion *motion, const Motion *truth, bool is_velocity)
{
    return is_velocity ? vec2_length(vec2_sub(motion->velocity, truth->velocity))
                       : fabs(motion->omega - truth->omega);
}

double distance_of_changes(const Motion *motion, const Motion *truth, bool is_velocity)
{
    return is_velocity ? vec2_length(vec2_sub(motion->acceleration, truth->acceleration))
                       : fabs(motion->alpha - truth->alpha);
}

// The largest rates of one body. A point of it moves with |v| + |omega| reach at most.
static DistanceScale body_scale(const Trajectory *reference, size_t body)
{
    const Motion still = {.omega = 0.0};
    const bool is_velocity = distance_is_by_velocity(reference);
    const double reach = reference->reach[body];
    DistanceScale scale = {.omega = 0.0};
    for (size_t k = 0; k < reference->sample_count; k++) {
        const Motion *truth = trajectory_motion(reference, k, body);
        scale.omega = fmax(scale.omega, distance_of_rates(truth, &still, is_velocity));
        scale.alpha = fmax(scale.alpha, distance_of_changes(truth, &still, is_velocity));
        scale.moving =
            fmax(scale.moving, vec2_length(truth->velocity) + fabs(truth->omega) * reach);
        scale.changing =
            fmax(scale.changing, vec2_length(truth->acceleration) + fabs(truth->alpha) * reach);
    }
    return scale;
}

// A share of a rate of the fastest point of all, as a rate of one body; 1 where nothing moves.
static double least_rate(double fastest, double reach, bool is_velocity)
{
    return fastest > 0.0 ? SMALLEST_SCALE * fastest / (is_velocity ? 1.0 : reach) : 1.0;
}

void distance_scales(const Trajectory *reference, DistanceScale scales[LINKAGE_BODY_MAX])
{
    const bool is_velocity = distance_is_by_velocity(reference);
    double moving = 0.0;
    double changing = 0.0;
    for (size_t i = 0; i < reference->body_count; i++) {
        scales[i] = body_scale(reference, i);
        moving = fmax(moving, scales[i].moving);
        changing = fmax(changing, scales[i].changing);
    }
    for (size_t i = 0; i < reference->body_count; i++) {
        const double reach = reference->reach[i];
        DistanceScale *scale = &scales[i];
        scale->omega = fmax(scale->omega, least_rate(moving, reach, is_velocity));
        scale->alpha = fmax(scale->alpha, least_rate(changing, reach, is_velocity));
        scale->moving = fmax(scale->moving, least_rate(moving, reach, true));
        scale->turning = scale->moving / reach;
        if ((int)i == reference->driven_body) {
            scale->omega = 0.0;
            scale->alpha = 0.0;
        }
    }
}

double distance_at(const Trajectory *trajectory, const Trajectory *reference, size_t sample,
                   const DistanceScale *scales)
{
    const bool is_velocity = distance_is_by_velocity(reference);
    double largest = 0.0;
    for (size_t i = 0; i < reference->body_count; i++) {
        if (scales[i].omega > 0.0) {
            const double apart =
                distance_of_rates(trajectory_motion(trajectory, sample, i),
                                  trajectory_motion(reference, sample, i), is_velocity);
            largest = fmax(largest, apart / scales[i].omega);
        }
    }
    return largest;
}

Scenario distance_grid(const Scenario *scenario)
{
    Scenario fine = *scenario;
    const size_t count = scenario_sample_count(scenario) - 1;
    if (count < LEAST_SAMPLES) {
        fine.run.samples *= (LEAST_SAMPLES + count - 1) / count;
    }
    return fine;
}
