// How far is one trajectory from the one that is taken as the truth?
//
// As model/distance.c measures it; the reference's samples stand at the same times.
#include "measure/error.h"

#include "base/zeroed.h"

typedef struct Sums {
    double square; // of the relative errors of omega
    size_t count;
} Sums;

static bool can_compare(const Trajectory *trajectory, const Trajectory *reference)
{
    return trajectory->is_complete && reference->is_complete &&
           trajectory->sample_count == reference->sample_count &&
           trajectory->body_count == reference->body_count;
}

bool error_series(const Trajectory *trajectory, const Trajectory *reference,
                  const DistanceScale *scales, double *omega)
{
    if (!can_compare(trajectory, reference)) {
        return false;
    }
    for (size_t k = 0; k < reference->sample_count; k++) {
        omega[k] = distance_at(trajectory, reference, k, scales);
    }
    return true;
}

static void add_body(const Trajectory *trajectory, const Trajectory *reference, size_t body,
                     const DistanceScale *scales, double horizon_s, TrajectoryError *error,
                     Sums *sums)
{
    const DistanceMeasure measure = distance_measure(reference, body);
    for (size_t k = 0; k < reference->sample_count; k++) {
        const Motion *truth = trajectory_motion(reference, k, body);
        const Motion *motion = trajectory_motion(trajectory, k, body);
        const double omega = distance_between(distance_rate(trajectory, k, body, measure),
                                              distance_rate(reference, k, body, measure)) /
                             scales->omega;
        const double alpha = distance_between(distance_change(trajectory, k, body, measure),
                                              distance_change(reference, k, body, measure)) /
                             scales->alpha;
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
    DistanceScale *scales = zeroed(reference->body_count, sizeof *scales);
    distance_scales(reference, scales);
    for (size_t i = 0; i < reference->body_count; i++) {
        if (scales[i].omega > 0.0) {
            add_body(trajectory, reference, i, &scales[i], horizon_s, &error, &sums);
        }
    }
    free(scales);
    // a horizon without a sample beyond the start gives no error
    if (reference->sample_count > 1 && !(reference->times[1] <= horizon_s)) {
        error.omega_max_in_horizon = NAN;
    }
    // a number that is not finite makes the sum not finite, though it is larger than nothing
    error.is_known = sums.count > 0 && isfinite(sums.square);
    error.against = reference->backend;
    error.omega_rms = sums.count > 0 ? sqrt(sums.square / (double)sums.count) : 0.0;
    return error;
}
