// How far is one trajectory from the one that is taken as the truth?
//
//     error(t) = max over bodies |omega_b(t) - ref_b(t)| / max over t |ref_b|
// over every body whose speed is not prescribed; the reference's samples stand at the same times.
#include "compare/error.h"

typedef struct Sums {
    double square; // of the relative errors of omega
    size_t count;
} Sums;

static void add_body(const Trajectory *trajectory, const Trajectory *reference, size_t body,
                     TrajectoryError *error, Sums *sums)
{
    double omega_scale = 0.0;
    double alpha_scale = 0.0;
    for (size_t k = 0; k < reference->sample_count; k++) {
        const Motion *truth = trajectory_motion(reference, k, body);
        omega_scale = fmax(omega_scale, fabs(truth->omega));
        alpha_scale = fmax(alpha_scale, fabs(truth->alpha));
    }
    for (size_t k = 0; k < reference->sample_count; k++) {
        const Motion *truth = trajectory_motion(reference, k, body);
        const Motion *motion = trajectory_motion(trajectory, k, body);
        const double omega = fabs(motion->omega - truth->omega) / omega_scale;
        const double alpha = fabs(motion->alpha - truth->alpha) / alpha_scale;
        if (omega > error->omega_max) {
            error->omega_max = omega;
            error->omega_max_time_s = reference->times[k];
        }
        error->alpha_max = fmax(error->alpha_max, alpha);
        error->angle_max_rad = fmax(error->angle_max_rad, fabs(motion->angle - truth->angle));
        sums->square += omega * omega;
        sums->count++;
    }
}

TrajectoryError error_against(const Trajectory *trajectory, const Trajectory *reference)
{
    TrajectoryError error = {.against = "none"};
    if (!trajectory->is_complete || !reference->is_complete ||
        trajectory->sample_count != reference->sample_count ||
        trajectory->body_count != reference->body_count) {
        return error;
    }
    Sums sums = {0.0, 0};
    for (size_t i = 0; i < reference->body_count; i++) {
        if ((int)i != reference->driven_body) {
            add_body(trajectory, reference, i, &error, &sums);
        }
    }
    // a number that is not finite makes the sum not finite, though it is larger than nothing
    error.is_known = sums.count > 0 && isfinite(sums.square);
    error.against = reference->backend;
    error.omega_rms = sums.count > 0 ? sqrt(sums.square / (double)sums.count) : 0.0;
    return error;
}
