// Measures how far a trajectory is from another: its rates, its contacts, its change points.
//
// As model/distance.c measures it; the reference's samples stand at the same times.
#include "measure/error.h"
#include "base/sorted.h"
#include "base/zeroed.h"
#include "model/kinematics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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
static void error_add_beside(const Trajectory *trajectory, const Trajectory *reference,
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
    error_add_beside(trajectory, reference, &error);
    distance_finish(&measure);
    // a horizon without a sample beyond the start gives no error
    if (reference->sample_count > 1 && !(reference->times[1] <= horizon_s)) {
        error.max_in_horizon = error.omega_max_in_horizon = NAN;
    }
    error.against = reference->backend;
    error.energy_lost = energy_lost(trajectory, reference);
    return error;
}

// Matches the contacts of two runs.
//
//     |t_i - s_k| < min(gap(t_i) / 2, gap(s_k) / 2, reach),
//     gap(t) = distance to the next onset of its run
// makes t_i and s_k each other's nearest, so that the pairs are the same in whatever order.

// contacts a twentieth of a turn apart are different contacts
static const double REACH = 0.05;

// Whether there is a contact to speak of: what has no force or impulse cannot be divided by.
static bool is_contact(const Spike *spike)
{
    return spike->force_max > 0.0 && spike->impulse > 0.0;
}

// The distance in time to the nearest other contact that was kept; infinite for one alone.
static double gap(const JointExtremes *joint, size_t spike)
{
    double nearest = INFINITY;
    for (size_t i = 0; i < joint->spike_count; i++) {
        if (i != spike && is_contact(&joint->spikes[i])) {
            const double distance = joint->spikes[i].onset_s - joint->spikes[spike].onset_s;
            nearest = fmin(nearest, fabs(distance));
        }
    }
    return nearest;
}

// The number of the other run's spike that answers to one of this run's, or -1.
static int error_find_partner(const JointExtremes *own, size_t spike, const JointExtremes *other,
                              double reach_s)
{
    const double limit = fmin(0.5 * gap(own, spike), reach_s);
    for (size_t i = 0; i < other->spike_count; i++) {
        const double distance = fabs(other->spikes[i].onset_s - own->spikes[spike].onset_s);
        if (is_contact(&other->spikes[i]) && distance < fmin(limit, 0.5 * gap(other, i))) {
            return (int)i;
        }
    }
    return -1;
}

// The contacts up to the horizon that no spike of the other run answers to, before or behind it.
static size_t count_alone(const JointExtremes *own, const JointExtremes *other, double horizon_s,
                          double reach_s)
{
    size_t count = 0;
    for (size_t i = 0; i < own->spike_count; i++) {
        const bool counts = is_contact(&own->spikes[i]) && own->spikes[i].onset_s <= horizon_s;
        count += counts && error_find_partner(own, i, other, reach_s) < 0 ? 1 : 0;
    }
    return count;
}

double spike_match_reach(const Scenario *scenario)
{
    const double run_s = scenario_duration(scenario);
    const double period_s = linkage_period(&scenario->linkage);
    return REACH * (period_s > 0.0 ? fmin(period_s, run_s) : run_s);
}

SpikeMatch spike_match(const Trajectory *trajectory, const Trajectory *reference, size_t joint,
                       double horizon_s, double reach_s)
{
    const JointExtremes *run = &trajectory->joints[joint];
    const JointExtremes *truth = &reference->joints[joint];
    SpikeMatch match = {0};
    for (size_t k = 0; k < truth->spike_count; k++) {
        const Spike *other = &truth->spikes[k];
        const bool is_early = is_contact(other) && other->onset_s <= horizon_s;
        const int partner = is_early ? error_find_partner(truth, k, run, reach_s) : -1;
        if (partner < 0 || run->spikes[partner].onset_s > horizon_s) {
            continue;
        }
        const Spike *spike = &run->spikes[partner];
        match.pairs[match.pair_count++] = (SpikePair){
            .spike = (size_t)partner,
            .reference_spike = k,
            .onset_delay_s = spike->onset_s - other->onset_s,
            .force_error = spike->force_max / other->force_max - 1.0,
            .impulse_error = spike->impulse / other->impulse - 1.0,
        };
    }
    match.missed = count_alone(truth, run, horizon_s, reach_s);
    match.extra = count_alone(run, truth, horizon_s, reach_s);
    return match;
}

// Change points of the ideal joints.
//
// At a change point the rows of the constraint Jacobian depend on one another. How close a position
// is to one is told by the least pivot of its elimination, as a share of the largest; how small
// that is anyway, by lengths and units, by its median over the run.

enum { TYPICAL = 65, HALVINGS = 30 };

static const double WINDOW = 0.01; // of the run
// of the typical pivot: a change point between two samples 2 degrees apart leaves .02 at one of
// them
static const double IS_CLOSE = 0.02;
static const double LEAST_SHARE = 1e-12;

// The largest share of the largest pivot that all independent pivots exceed.
static double least_pivot(const Trajectory *run, size_t sample)
{
    const Motion *motions = run->motions + sample * run->body_count;
    size_t rows = 0;
    double low = log(LEAST_SHARE), high = 0.0;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        const size_t rank = kinematics_rank(&run->linkage, motions, NULL, true, exp(middle), &rows);
        *(rank == rows ? &low : &high) = middle;
    }
    return exp(low);
}

static double typical_pivot(const Trajectory *run)
{
    double pivots[TYPICAL];
    for (size_t i = 0; i < TYPICAL; i++) {
        pivots[i] = least_pivot(run, i * (run->sample_count - 1) / (TYPICAL - 1));
    }
    sorted_make(pivots, TYPICAL);
    return sorted_median(pivots, TYPICAL);
}

static bool has_ideal_joints_alone(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (!linkage_kind_is_ideal(linkage->joints[i].kind)) {
            return false;
        }
    }
    return true;
}

bool change_point_is_near(const Trajectory *truth, double time_s)
{
    if (truth->space_motions != NULL || !kinematics_is_small(&truth->linkage) ||
        !has_ideal_joints_alone(&truth->linkage) || truth->sample_count < 2) {
        return false;
    }
    const double typical = typical_pivot(truth);
    const double window_s = WINDOW * truth->times[truth->sample_count - 1];
    for (size_t i = 0; i < truth->sample_count; i++) {
        if (fabs(truth->times[i] - time_s) <= window_s &&
            least_pivot(truth, i) < IS_CLOSE * typical) {
            return true;
        }
    }
    return false;
}
