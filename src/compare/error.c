// How far is one trajectory from the one that is taken as the truth?
//
//     error(t) = max over bodies |omega_b(t) - ref_b(t)| / max over t |ref_b|
// over every body whose speed is not prescribed; the reference's samples stand at the same times. A
// body that hardly turns is measured by a thousandth of the fastest body's speed: its own would be
// rounding. Where no drive turns anything, bodies may not turn at all: the speeds of their centres
// then take the place of omega, and their accelerations that of alpha.
#include "compare/error.h"

static const double SMALLEST_SCALE =
    1e-3; // of the fastest body's: below it lies no motion to speak of

typedef struct Sums {
    double square; // of the relative errors of omega
    size_t count;
} Sums;

typedef struct Scales {
    double omega; // rad/s
    double alpha; // rad/s^2
} Scales;

// What errors are measured in.
static bool by_velocity(const Trajectory *reference)
{
    return reference->driven_body == LINKAGE_GROUND;
}

static double rate_difference(const Motion *motion, const Motion *truth, bool is_velocity)
{
    return is_velocity ? vec2_length(vec2_sub(motion->velocity, truth->velocity))
                       : fabs(motion->omega - truth->omega);
}

static double change_difference(const Motion *motion, const Motion *truth, bool is_velocity)
{
    return is_velocity ? vec2_length(vec2_sub(motion->acceleration, truth->acceleration))
                       : fabs(motion->alpha - truth->alpha);
}

static Scales body_scales(const Trajectory *reference, size_t body)
{
    const Motion still = {.omega = 0.0};
    const bool is_velocity = by_velocity(reference);
    Scales scales = {0.0, 0.0};
    for (size_t k = 0; k < reference->sample_count; k++) {
        const Motion *truth = trajectory_motion(reference, k, body);
        scales.omega = fmax(scales.omega, rate_difference(truth, &still, is_velocity));
        scales.alpha = fmax(scales.alpha, change_difference(truth, &still, is_velocity));
    }
    return scales;
}

static Scales smallest_scales(const Scales *scales, size_t body_count)
{
    Scales largest = {0.0, 0.0};
    for (size_t i = 0; i < body_count; i++) {
        largest.omega = fmax(largest.omega, scales[i].omega);
        largest.alpha = fmax(largest.alpha, scales[i].alpha);
    }
    // where nothing turns at all, errors are absolute
    return (Scales){
        .omega = largest.omega > 0.0 ? SMALLEST_SCALE * largest.omega : 1.0,
        .alpha = largest.alpha > 0.0 ? SMALLEST_SCALE * largest.alpha : 1.0,
    };
}

static bool can_compare(const Trajectory *trajectory, const Trajectory *reference)
{
    return trajectory->is_complete && reference->is_complete &&
           trajectory->sample_count == reference->sample_count &&
           trajectory->body_count == reference->body_count;
}

// The scales of every body that is not driven; 0 for the driven one, which does not count.
static void free_scales(const Trajectory *reference, Scales scales[LINKAGE_BODY_MAX])
{
    for (size_t i = 0; i < reference->body_count; i++) {
        scales[i] = body_scales(reference, i);
    }
    const Scales smallest = smallest_scales(scales, reference->body_count);
    for (size_t i = 0; i < reference->body_count; i++) {
        scales[i].omega = fmax(scales[i].omega, smallest.omega);
        scales[i].alpha = fmax(scales[i].alpha, smallest.alpha);
        if ((int)i == reference->driven_body) {
            scales[i] = (Scales){0.0, 0.0};
        }
    }
}

bool error_series(const Trajectory *trajectory, const Trajectory *reference, double *omega)
{
    if (!can_compare(trajectory, reference)) {
        return false;
    }
    Scales scales[LINKAGE_BODY_MAX];
    free_scales(reference, scales);
    for (size_t k = 0; k < reference->sample_count; k++) {
        omega[k] = 0.0;
        for (size_t i = 0; i < reference->body_count; i++) {
            if (scales[i].omega > 0.0) {
                const double difference =
                    rate_difference(trajectory_motion(trajectory, k, i),
                                    trajectory_motion(reference, k, i), by_velocity(reference));
                omega[k] = fmax(omega[k], difference / scales[i].omega);
            }
        }
    }
    return true;
}

static void add_body(const Trajectory *trajectory, const Trajectory *reference, size_t body,
                     const Scales *scales, double horizon_s, TrajectoryError *error, Sums *sums)
{
    const bool is_velocity = by_velocity(reference);
    for (size_t k = 0; k < reference->sample_count; k++) {
        const Motion *truth = trajectory_motion(reference, k, body);
        const Motion *motion = trajectory_motion(trajectory, k, body);
        const double omega = rate_difference(motion, truth, is_velocity) / scales->omega;
        const double alpha = change_difference(motion, truth, is_velocity) / scales->alpha;
        if (omega > error->omega_max) {
            error->omega_max = omega;
            error->omega_max_time_s = reference->times[k];
        }
        if (reference->times[k] <= horizon_s) {
            error->omega_max_in_horizon = fmax(error->omega_max_in_horizon, omega);
        }
        error->alpha_max = fmax(error->alpha_max, alpha);
        error->angle_max_rad = fmax(error->angle_max_rad, fabs(motion->angle - truth->angle));
        sums->square += omega * omega;
        sums->count++;
    }
}

TrajectoryError error_against(const Trajectory *trajectory, const Trajectory *reference,
                              double horizon_s)
{
    TrajectoryError error = {.against = "none"};
    if (!can_compare(trajectory, reference)) {
        return error;
    }
    Sums sums = {0.0, 0};
    Scales scales[LINKAGE_BODY_MAX];
    free_scales(reference, scales);
    for (size_t i = 0; i < reference->body_count; i++) {
        if (scales[i].omega > 0.0) {
            add_body(trajectory, reference, i, &scales[i], horizon_s, &error, &sums);
        }
    }
    // a horizon that holds no sample but the start says nothing
    if (reference->sample_count > 1 && !(reference->times[1] <= horizon_s)) {
        error.omega_max_in_horizon = NAN;
    }
    // a number that is not finite makes the sum not finite, though it is larger than nothing
    error.is_known = sums.count > 0 && isfinite(sums.square);
    error.against = reference->backend;
    error.omega_rms = sums.count > 0 ? sqrt(sums.square / (double)sums.count) : 0.0;
    return error;
}
