// How far are two motions of one linkage apart, in numbers that mean the same for all bodies?
//
//     d(t) = max over bodies |omega_b(t) - ref_b(t)| / max over t |ref_b|
// over every body whose speed is not prescribed. A body that hardly turns is measured by a
// thousandth of the fastest body's speed: its own would be rounding. Where no drive turns anything,
// bodies may not turn at all: the speeds of their centres then take the place of omega, and their
// accelerations that of alpha.
#include "model/distance.h"

enum { LEAST_SAMPLES = 1000 }; // fewer steps of a horizon would say little

static const double SMALLEST_SCALE =
    1e-3; // of the fastest body's: below it lies no motion to speak of

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

static DistanceScale body_scales(const Trajectory *reference, size_t body)
{
    const Motion still = {.omega = 0.0};
    const bool is_velocity = distance_is_by_velocity(reference);
    DistanceScale scales = {0.0, 0.0};
    for (size_t k = 0; k < reference->sample_count; k++) {
        const Motion *truth = trajectory_motion(reference, k, body);
        scales.omega = fmax(scales.omega, distance_of_rates(truth, &still, is_velocity));
        scales.alpha = fmax(scales.alpha, distance_of_changes(truth, &still, is_velocity));
    }
    return scales;
}

static DistanceScale smallest_scales(const DistanceScale *scales, size_t body_count)
{
    DistanceScale largest = {0.0, 0.0};
    for (size_t i = 0; i < body_count; i++) {
        largest.omega = fmax(largest.omega, scales[i].omega);
        largest.alpha = fmax(largest.alpha, scales[i].alpha);
    }
    // where nothing turns at all, errors are absolute
    return (DistanceScale){
        .omega = largest.omega > 0.0 ? SMALLEST_SCALE * largest.omega : 1.0,
        .alpha = largest.alpha > 0.0 ? SMALLEST_SCALE * largest.alpha : 1.0,
    };
}

void distance_scales(const Trajectory *reference, DistanceScale scales[LINKAGE_BODY_MAX])
{
    for (size_t i = 0; i < reference->body_count; i++) {
        scales[i] = body_scales(reference, i);
    }
    const DistanceScale smallest = smallest_scales(scales, reference->body_count);
    for (size_t i = 0; i < reference->body_count; i++) {
        scales[i].omega = fmax(scales[i].omega, smallest.omega);
        scales[i].alpha = fmax(scales[i].alpha, smallest.alpha);
        if ((int)i == reference->driven_body) {
            scales[i] = (DistanceScale){0.0, 0.0};
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
