// How far is one trajectory from the one that is taken as the truth?
//
// As model/distance.c measures it; the reference's samples stand at the same times.
#include "measure/error.h"

#include "base/zeroed.h"

#include <stdio.h>

static bool can_compare(const Trajectory *trajectory, const Trajectory *reference)
{
    return trajectory->is_complete && reference->is_complete &&
           trajectory->sample_count == reference->sample_count &&
           trajectory->body_count == reference->body_count;
}

bool error_series(const Trajectory *trajectory, const Trajectory *reference,
                  const DistanceMeasure *measure, double *distance)
{
    if (!can_compare(trajectory, reference)) {
        return false;
    }
    for (size_t k = 0; k < reference->sample_count; k++) {
        distance[k] = distance_apart(measure, distance_motion_at(trajectory, k),
                                     distance_motion_at(reference, k), NULL);
    }
    return true;
}

// One rate over all samples. A number that is not finite stays one.
typedef struct RateError {
    double max;
    double max_time_s;
    double max_in_horizon;
    double square; // sum over the samples
} RateError;

static RateError rate_error(const Trajectory *trajectory, const Trajectory *reference,
                            const DistanceMeasure *measure, size_t index, double horizon_s)
{
    const DistanceRate *rate = &measure->rates[index];
    RateError error = {.max = 0.0};
    for (size_t k = 0; k < reference->sample_count; k++) {
        const double apart = distance_between(
            rate, distance_value(measure->linkage, rate, distance_motion_at(trajectory, k)),
            distance_value(measure->linkage, rate, distance_motion_at(reference, k)));
        if (apart > error.max) {
            error.max = apart;
            error.max_time_s = reference->times[k];
        }
        if (reference->times[k] <= horizon_s) {
            error.max_in_horizon = fmax(error.max_in_horizon, apart);
        }
        error.square += apart * apart;
    }
    return error;
}

static Vec3 angular_acceleration(const Trajectory *trajectory, size_t sample, size_t body)
{
    return trajectory->space_motions != NULL
               ? trajectory_space_motion(trajectory, sample, body)->alpha
               : (Vec3){trajectory_motion(trajectory, sample, body)->alpha, 0.0, 0.0};
}

// A body's largest angular acceleration in the reference, but at least this share of that with
// which its furthest point would accelerate as the fastest of all does.
static double alpha_scale(const Trajectory *reference, size_t body, double fastest)
{
    double largest = DISTANCE_FLOOR * fastest / reference->reach[body];
    for (size_t k = 0; k < reference->sample_count; k++) {
        largest = fmax(largest, vec3_length(angular_acceleration(reference, k, body)));
    }
    return largest > 0.0 ? largest : 1.0;
}

static double fastest_change(const Trajectory *reference)
{
    double fastest = 0.0;
    for (size_t i = 0; i < reference->body_count; i++) {
        for (size_t k = 0; k < reference->sample_count; k++) {
            const Vec2 planar = trajectory_motion(reference, k, i)->acceleration;
            const double moving =
                reference->space_motions != NULL
                    ? vec3_length(trajectory_space_motion(reference, k, i)->acceleration)
                    : vec2_length(planar);
            const double turning = vec3_length(angular_acceleration(reference, k, i));
            fastest = fmax(fastest, moving + turning * reference->reach[i]);
        }
    }
    return fastest;
}

// Accelerations and angles, which stand beside the error.
static void add_beside(const Trajectory *trajectory, const Trajectory *reference,
                       TrajectoryError *error)
{
    const double fastest = fastest_change(reference);
    for (size_t i = 0; i < reference->body_count; i++) {
        const double scale = alpha_scale(reference, i, fastest);
        const bool is_driven = (int)i == reference->driven_body;
        for (size_t k = 0; k < reference->sample_count && !is_driven; k++) {
            const Vec3 apart = vec3_sub(angular_acceleration(trajectory, k, i),
                                        angular_acceleration(reference, k, i));
            error->alpha_max = fmax(error->alpha_max, vec3_length(apart) / scale);
            error->angle_max_rad =
                fmax(error->angle_max_rad, fabs(trajectory_motion(trajectory, k, i)->angle -
                                                trajectory_motion(reference, k, i)->angle));
        }
    }
}

static void add_rates(const Trajectory *trajectory, const Trajectory *reference, double horizon_s,
                      const DistanceMeasure *measure, TrajectoryError *error)
{
    // without a sample in the horizon the whole run names its worst
    const bool has_horizon = reference->sample_count > 1 && reference->times[1] <= horizon_s;
    double square = 0.0;
    double omega_square = 0.0;
    size_t omega_count = 0;
    size_t worst = 0;
    // a solver that takes every joint as ideal has no rates in them
    const bool has_joints = options_backend_has_play(trajectory->backend) &&
                            options_backend_has_play(reference->backend);
    const size_t count = has_joints ? measure->count : 2 * reference->body_count;
    for (size_t i = 0; i < count; i++) {
        const RateError rate = rate_error(trajectory, reference, measure, i, horizon_s);
        const bool is_worst =
            has_horizon ? rate.max_in_horizon > error->max_in_horizon : rate.max > error->max;
        worst = is_worst ? i : worst;
        if (rate.max > error->max) {
            error->max = rate.max;
            error->max_time_s = rate.max_time_s;
        }
        error->max_in_horizon = fmax(error->max_in_horizon, rate.max_in_horizon);
        square += rate.square;
        if (measure->rates[i].kind == DISTANCE_TURNING &&
            measure->rates[i].number != reference->driven_body) {
            error->omega_max = fmax(error->omega_max, rate.max);
            error->omega_max_in_horizon = fmax(error->omega_max_in_horizon, rate.max_in_horizon);
            omega_square += rate.square;
            omega_count += reference->sample_count;
        }
    }
    error->is_known = measure->count > 0 && isfinite(square);
    error->omega_rms = omega_count > 0 ? sqrt(omega_square / (double)omega_count) : 0.0;
    if (measure->count > 0) {
        distance_name(measure->linkage, &measure->rates[worst], error->in);
        error->is_floor = distance_is_floor(&measure->rates[worst]);
    }
}

double error_energy(const Trajectory *run)
{
    const Energy *energy = &run->energy;
    double largest = fmax(fabs(energy->drive_work), fabs(energy->change));
    largest = fmax(largest, fabs(energy->dissipated) + fabs(energy->friction));
    for (size_t i = 0; i < run->sample_count; i++) {
        const double kinetic =
            run->space_motions != NULL
                ? space_kinetic_energy(&run->linkage, trajectory_space_motion(run, i, 0))
                : linkage_kinetic_energy(&run->linkage, trajectory_motion(run, i, 0));
        largest = fmax(largest, kinetic);
    }
    return largest;
}

// Of a run in which nothing moves there is none to lose.
static double energy_lost(const Trajectory *trajectory, const Trajectory *reference)
{
    const double lost = fabs(trajectory->energy.residual);
    return lost > 0.0 ? lost / error_energy(reference) : 0.0;
}

const char *error_is_unstable(const TrajectoryError *error, bool is_limited)
{
    if (!(error_of_run(error, is_limited) < ERROR_UNSTABLE)) {
        return "is faster than the true motion ever is: unstable";
    }
    return error->energy_lost > ERROR_ENERGY_LOST
               ? "has an energy residual above the largest energy of the true motion: unstable"
               : NULL;
}

bool error_fail_unstable(Trajectory *run, const Trajectory *reference, TrajectoryError *error)
{
    if (!(error->energy_lost > ERROR_ENERGY_LOST)) {
        return false;
    }
    run->is_complete = false;
    snprintf(run->message, sizeof run->message,
             "it is unstable: its energy is off by %.3g J, and the largest energy of the %s is "
             "%.3g J; a shorter step may help",
             fabs(run->energy.residual), reference->backend, error_energy(reference));
    *error = (TrajectoryError){.against = "none"};
    return true;
}

TrajectoryError error_against(const Trajectory *trajectory, const Trajectory *reference,
                              double horizon_s)
{
    TrajectoryError error = {.against = "none"};
    if (!can_compare(trajectory, reference)) {
        return error;
    }
    DistanceMeasure measure = distance_measure(reference);
    add_rates(trajectory, reference, horizon_s, &measure, &error);
    add_beside(trajectory, reference, &error);
    distance_finish(&measure);
    // a horizon without a sample beyond the start gives no error
    if (reference->sample_count > 1 && !(reference->times[1] <= horizon_s)) {
        error.max_in_horizon = error.omega_max_in_horizon = NAN;
    }
    error.against = reference->backend;
    error.energy_lost = energy_lost(trajectory, reference);
    return error;
}
