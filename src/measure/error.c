// Measures how far a trajectory is from another: its rates, its contacts, its change points.
//
// As model/distance.c measures it; the reference's samples stand at the same times.
#include "measure/error.h"
#include "base/sorted.h"
#include "base/zeroed.h"
#include "model/forces.h"
#include "model/kinematics.h"
#include "model/space.h"

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
// which its furthest point would accelerate as the fastest of all does, and the floor of rest.
static double alpha_scale(const Trajectory *reference, size_t body, double fastest)
{
    const double floor = fmax(DISTANCE_FLOOR * fastest, reference->floor.acceleration);
    double largest = floor / reference->reach[body];
    for (size_t k = 0; k < reference->sample_count; k++) {
        largest = fmax(largest, vec3_length(angular_acceleration(reference, k, body)));
    }
    return largest;
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
        const bool is_driven = linkage_is_driven(&reference->linkage, (int)i);
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
            !linkage_is_driven(&reference->linkage, (int)measure->rates[i].number)) {
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

static double kinetic_at(const Trajectory *run, size_t sample)
{
    return run->space_motions != NULL
               ? space_kinetic_energy(&run->linkage, trajectory_space_motion(run, sample, 0))
               : linkage_kinetic_energy(&run->linkage, trajectory_motion(run, sample, 0));
}

double error_energy(const Trajectory *run)
{
    const Energy *energy = &run->energy;
    double largest = fmax(fabs(energy->drive_work), fabs(energy->change));
    largest = fmax(largest, fabs(energy->load_work));
    largest = fmax(largest, fabs(energy->dissipated) + fabs(energy->friction));
    for (size_t i = 0; i < run->sample_count; i++) {
        largest = fmax(largest, kinetic_at(run, i));
    }
    return fmax(largest, run->floor.energy);
}

static double energy_lost(const Trajectory *trajectory, const Trajectory *reference)
{
    return fabs(trajectory->energy.residual) / error_energy(reference);
}

// The forces of contacts.
//
//     e_j = max_k |F_jk - F_ref,jk| / S_j    at the samples k
//     S_j = max_k |F_ref,jk|, at least ERROR_FORCE_FLOOR of the largest of any joint, and the floor
//     of rest (model/scale.h)
// and of the peaks P of contacts, largest forces of every step, with S_j the largest of these.

// Two numbers over a scale. What is not finite is no small error.
static double apart_over(double a, double b, double scale)
{
    const double apart = fabs(a - b) / scale;
    return isfinite(apart) ? apart : INFINITY;
}

bool error_has_forces(const Trajectory *trajectory, const Trajectory *reference, size_t joint)
{
    const Joint *of = &reference->linkage.joints[joint];
    return trajectory->states != NULL && reference->states != NULL &&
           trajectory_feels_play(trajectory, of) && trajectory_feels_play(reference, of);
}

static double error_largest_force(const Trajectory *reference, size_t joint)
{
    double largest = 0.0;
    for (size_t k = 0; k < reference->sample_count; k++) {
        largest = fmax(largest, fabs(trajectory_state(reference, k, joint)->force));
    }
    return largest;
}

// A size, but at least the floor's share of the largest of the joints that are like it in unit, and
// what is no force to speak of in the mechanism.
static double force_scale(const Trajectory *reference, size_t joint,
                          double (*size)(const Trajectory *reference, size_t joint))
{
    const Linkage *linkage = &reference->linkage;
    const bool is_torsional = linkage_is_torsional(&linkage->joints[joint]);
    const double own = size(reference, joint);
    double largest = own;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_is_torsional(&linkage->joints[i]) == is_torsional) {
            largest = fmax(largest, size(reference, i));
        }
    }
    const double rest = is_torsional ? reference->floor.torque : reference->floor.force;
    return fmax(fmax(own, ERROR_FORCE_FLOOR * largest), rest);
}

static double error_force_between(const Trajectory *trajectory, const Trajectory *reference,
                                  size_t sample, size_t joint, double scale)
{
    return apart_over(trajectory_state(trajectory, sample, joint)->force,
                      trajectory_state(reference, sample, joint)->force, scale);
}

ForceMeasure error_forces(const Trajectory *reference)
{
    const size_t joint_count = reference->joint_count;
    ForceMeasure measure = {
        .joints = zeroed(joint_count, sizeof *measure.joints),
        .scales = zeroed(joint_count, sizeof *measure.scales),
    };
    for (size_t i = 0; i < joint_count; i++) {
        if (error_has_forces(reference, reference, i)) {
            measure.joints[measure.count] = i;
            measure.scales[measure.count++] = force_scale(reference, i, error_largest_force);
        }
    }
    return measure;
}

void error_forces_finish(ForceMeasure *measure)
{
    free(measure->joints);
    free(measure->scales);
    *measure = (ForceMeasure){.count = 0};
}

double error_forces_apart(const ForceMeasure *measure, const Trajectory *trajectory,
                          const Trajectory *reference, size_t sample)
{
    double largest = 0.0;
    for (size_t i = 0; i < measure->count; i++) {
        largest = fmax(largest, error_force_between(trajectory, reference, sample,
                                                    measure->joints[i], measure->scales[i]));
    }
    return largest;
}

// The peaks of contacts.

// a contact that is still under way at the horizon ends there but for rounding
static const double PEAK_HORIZON_ROUNDING = 1e-9;

// One contact of either run.
typedef struct PeakContact {
    double onset_s;
    double end_s;
    double force_max; // N or N m
    bool is_truth;
} PeakContact;

static int compare_onsets(const void *a, const void *b)
{
    const PeakContact *left = a;
    const PeakContact *right = b;
    return (left->onset_s > right->onset_s) - (left->onset_s < right->onset_s);
}

static size_t list_contacts(const JointExtremes *run, const JointExtremes *truth,
                            PeakContact contacts[2 * TRAJECTORY_SPIKE_MAX])
{
    const JointExtremes *const joints[] = {run, truth};
    size_t count = 0;
    for (int i = 0; i < 2; i++) {
        for (size_t k = 0; k < joints[i]->spike_count; k++) {
            const Spike *spike = &joints[i]->spikes[k];
            contacts[count++] = (PeakContact){
                .onset_s = spike->onset_s,
                .end_s = spike->onset_s + spike->duration_s,
                .force_max = spike->force_max,
                .is_truth = i == 1,
            };
        }
    }
    qsort(contacts, count, sizeof *contacts, compare_onsets);
    return count;
}

// The largest force that a contact may have had without being kept.
static double weakest_kept(const JointExtremes *joint)
{
    return joint->spike_count == TRAJECTORY_SPIKE_MAX
               ? joint->spikes[TRAJECTORY_SPIKE_MAX - 1].force_max
               : 0.0;
}

// The contacts from one on that overlap, directly or through others, as one of each run.
typedef struct PeakGroup {
    size_t counts[2]; // of the run, of the reference
    double peaks[2];  // N or N m, likewise
    double end_s;
} PeakGroup;

static PeakGroup take_group(const PeakContact *contacts, size_t count)
{
    PeakGroup group = {.end_s = contacts[0].end_s};
    for (size_t i = 0; i < count && contacts[i].onset_s <= group.end_s; i++) {
        const PeakContact *contact = &contacts[i];
        group.counts[contact->is_truth]++;
        group.peaks[contact->is_truth] = fmax(group.peaks[contact->is_truth], contact->force_max);
        group.end_s = fmax(group.end_s, contact->end_s);
    }
    return group;
}

// The difference of its two peaks, N or N m.
static double peaks_apart(const PeakGroup *group, const JointExtremes *run,
                          const JointExtremes *truth)
{
    if (group->counts[true] == 0) {
        return fmax(0.0, group->peaks[false] - weakest_kept(truth));
    }
    if (group->counts[false] == 0) {
        return fmax(0.0, group->peaks[true] - weakest_kept(run));
    }
    return fabs(group->peaks[false] - group->peaks[true]);
}

static double largest_peak(const Trajectory *reference, size_t joint)
{
    return reference->joints[joint].force_max.value;
}

static void error_add_peaks(const Trajectory *trajectory, const Trajectory *reference, size_t joint,
                            double horizon_s, JointError *error)
{
    const JointExtremes *run = &trajectory->joints[joint];
    const JointExtremes *truth = &reference->joints[joint];
    const double scale = force_scale(reference, joint, largest_peak);
    const double until_s = horizon_s * (1.0 + PEAK_HORIZON_ROUNDING);
    PeakContact contacts[2 * TRAJECTORY_SPIKE_MAX];
    const size_t count = list_contacts(run, truth, contacts);
    for (size_t i = 0; i < count;) {
        const PeakGroup group = take_group(contacts + i, count - i);
        const double apart = apart_over(peaks_apart(&group, run, truth), 0.0, scale);
        error->peak_max = fmax(error->peak_max, apart);
        if (group.end_s <= until_s) {
            error->peak_max_in_horizon = fmax(error->peak_max_in_horizon, apart);
            error->missed += group.counts[false] == 0 ? group.counts[true] : 0;
            error->extra += group.counts[true] == 0 ? group.counts[false] : 0;
        }
        i += group.counts[false] + group.counts[true];
    }
}

// A horizon without a sample beyond the start gives no error.
static bool has_horizon(const Trajectory *reference, double horizon_s)
{
    return reference->sample_count <= 1 || reference->times[1] <= horizon_s;
}

JointError error_of_joint(const Trajectory *trajectory, const Trajectory *reference, size_t joint,
                          double horizon_s)
{
    JointError error = {.force_max = 0.0};
    const double scale = force_scale(reference, joint, error_largest_force);
    for (size_t k = 0; k < reference->sample_count; k++) {
        const double apart = error_force_between(trajectory, reference, k, joint, scale);
        error.force_max = fmax(error.force_max, apart);
        if (reference->times[k] <= horizon_s) {
            error.force_max_in_horizon = fmax(error.force_max_in_horizon, apart);
        }
    }
    error_add_peaks(trajectory, reference, joint, horizon_s, &error);
    if (!has_horizon(reference, horizon_s)) {
        error.force_max_in_horizon = error.peak_max_in_horizon = NAN;
    }
    return error;
}

// The peaks of accelerations.

// The largest and the smallest acceleration of a body, rad/s^2.
typedef struct AlphaPeaks {
    double most;
    double least;
} AlphaPeaks;

static AlphaPeaks peaks_of_steps(const Trajectory *run, size_t body)
{
    return (AlphaPeaks){run->bodies[body].alpha_max.value, run->bodies[body].alpha_min.value};
}

static AlphaPeaks peaks_of_samples(const Trajectory *run, size_t body, double until_s)
{
    AlphaPeaks peaks = {-INFINITY, INFINITY};
    for (size_t k = 0; k < run->sample_count && run->times[k] <= until_s; k++) {
        const double alpha = trajectory_motion(run, k, body)->alpha;
        peaks.most = fmax(peaks.most, alpha);
        peaks.least = fmin(peaks.least, alpha);
    }
    return peaks;
}

static double peak_size(AlphaPeaks peaks)
{
    return fmax(fabs(peaks.most), fabs(peaks.least));
}

// Of the largest acceleration of the body in the reference, but at least the floor's share of that
// with which its furthest point would accelerate as the fastest of all by turning does, and the
// floor of rest.
static double peak_scale(const Trajectory *reference, size_t body)
{
    double fastest = 0.0;
    for (size_t i = 0; i < reference->body_count; i++) {
        fastest = fmax(fastest, peak_size(peaks_of_steps(reference, i)) * reference->reach[i]);
    }
    const double floor = fmax(ERROR_FORCE_FLOOR * fastest, reference->floor.acceleration);
    return fmax(peak_size(peaks_of_steps(reference, body)), floor / reference->reach[body]);
}

static double alpha_apart(AlphaPeaks run, AlphaPeaks truth, double scale)
{
    return fmax(apart_over(run.most, truth.most, scale), apart_over(run.least, truth.least, scale));
}

BodyError error_of_body(const Trajectory *trajectory, const Trajectory *reference, size_t body,
                        double horizon_s)
{
    const double scale = peak_scale(reference, body);
    const double end_s = reference->times[reference->sample_count - 1];
    BodyError error = {.peak_max = alpha_apart(peaks_of_steps(trajectory, body),
                                               peaks_of_steps(reference, body), scale)};
    error.peak_max_in_horizon =
        !has_horizon(reference, horizon_s) ? NAN
        : end_s <= horizon_s               ? error.peak_max
                             : alpha_apart(peaks_of_samples(trajectory, body, horizon_s),
                                           peaks_of_samples(reference, body, horizon_s), scale);
    return error;
}

// Keeps the larger, and whose it is: by the horizon's where that is known.
static void keep_larger(double whole, double in_horizon, const char *name, double *most,
                        double *most_in_horizon, char in[LINKAGE_NAME_SIZE])
{
    const bool is_first = isnan(*most);
    const bool is_larger =
        isnan(in_horizon) ? !(whole <= *most) : !(in_horizon <= *most_in_horizon);
    if (is_larger) {
        snprintf(in, LINKAGE_NAME_SIZE, "%s", name);
    }
    *most = is_first ? whole : fmax(*most, whole);
    *most_in_horizon = is_first ? in_horizon : fmax(*most_in_horizon, in_horizon);
}

static void add_forces(const Trajectory *trajectory, const Trajectory *reference, double horizon_s,
                       TrajectoryError *error)
{
    error->force_max = error->force_max_in_horizon = NAN;
    error->peak_force_max = error->peak_force_max_in_horizon = NAN;
    for (size_t i = 0; i < reference->joint_count; i++) {
        if (error_has_forces(trajectory, reference, i)) {
            const JointError joint = error_of_joint(trajectory, reference, i, horizon_s);
            const char *name = reference->linkage.joints[i].name;
            keep_larger(joint.force_max, joint.force_max_in_horizon, name, &error->force_max,
                        &error->force_max_in_horizon, error->force_in);
            keep_larger(joint.peak_max, joint.peak_max_in_horizon, name, &error->peak_force_max,
                        &error->peak_force_max_in_horizon, error->peak_force_in);
        }
    }
}

static void error_add_peak_alphas(const Trajectory *trajectory, const Trajectory *reference,
                                  double horizon_s, TrajectoryError *error)
{
    error->peak_alpha_max = error->peak_alpha_max_in_horizon = NAN;
    // a run that was made to be compared by its motion alone has no extremes
    const bool has_extremes = trajectory->states != NULL && reference->states != NULL;
    for (size_t i = 0; has_extremes && i < reference->body_count; i++) {
        if (!linkage_is_driven(&reference->linkage, (int)i)) {
            const BodyError body = error_of_body(trajectory, reference, i, horizon_s);
            keep_larger(body.peak_max, body.peak_max_in_horizon, reference->linkage.bodies[i].name,
                        &error->peak_alpha_max, &error->peak_alpha_max_in_horizon,
                        error->peak_alpha_in);
        }
    }
}

double error_of_peaks(const Trajectory *trajectory, const Trajectory *reference, double horizon_s)
{
    TrajectoryError error = {.is_known = true};
    add_forces(trajectory, reference, horizon_s, &error);
    error_add_peak_alphas(trajectory, reference, horizon_s, &error);
    return error_of_kind(&error, TOLERANCE_OF_PEAKS, true);
}

double error_of_kind(const TrajectoryError *error, ToleranceOf kind, bool is_limited)
{
    switch (kind) {
    case TOLERANCE_OF_FORCES:
        return is_limited ? error->force_max_in_horizon : error->force_max;
    case TOLERANCE_OF_PEAKS:
        return is_limited ? fmax(error->peak_force_max_in_horizon, error->peak_alpha_max_in_horizon)
                          : fmax(error->peak_force_max, error->peak_alpha_max);
    default:
        return error_of_run(error, is_limited);
    }
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

static double potential_at(const Scenario *scenario, const Trajectory *run, size_t sample)
{
    return run->space_motions != NULL
               ? space_potential_energy(&run->linkage, trajectory_space_motion(run, sample, 0),
                                        scenario->gravity)
               : linkage_potential_energy(&run->linkage, trajectory_motion(run, sample, 0),
                                          scenario_gravity(scenario));
}

// What a run began with and was given, J: works, the bodies' motion, springs, and all that they
// may have fallen.
static double energy_given(const Scenario *scenario, const Trajectory *run)
{
    double fallen = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        fallen =
            fmax(fallen, fabs(potential_at(scenario, run, i) - potential_at(scenario, run, 0)));
    }
    const double sprung = run->space_motions != NULL
                              ? 0.0
                              : forces_energy(&run->linkage, trajectory_motion(run, 0, 0));
    return fabs(run->energy.drive_work) + fabs(run->energy.load_work) + kinetic_at(run, 0) +
           sprung + fallen + run->floor.energy;
}

bool error_fail_runaway(const Scenario *scenario, Trajectory *run)
{
    const double lost = fabs(run->energy.residual);
    if (!(run->is_complete && run->sample_count > 0 && lost > 0.5 * error_energy(run))) {
        return false;
    }
    const double given = energy_given(scenario, run);
    if (!(lost > ERROR_ENERGY_RUNAWAY * given)) {
        return false;
    }
    run->is_complete = false;
    snprintf(run->message, sizeof run->message,
             "it is unstable: its energy is off by %.3g J, and all that it began with and was "
             "given is %.3g J; a shorter step may help",
             lost, given);
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
    add_forces(trajectory, reference, horizon_s, &error);
    error_add_peak_alphas(trajectory, reference, horizon_s, &error);
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
static const double PIVOT_SHARE_LEAST = 1e-12;

// The largest share of the largest pivot that all independent pivots exceed.
static double least_pivot(const Trajectory *run, size_t sample)
{
    const Motion *motions = run->motions + sample * run->body_count;
    size_t rows = 0;
    double low = log(PIVOT_SHARE_LEAST), high = 0.0;
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
        if (!joint_is_ideal(linkage->joints[i].kind)) {
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
