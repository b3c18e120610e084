// Which numbers of a run does a check compare?
//
// Extremes of omega and alpha of each moving body; of each joint the force, of those with play the
// impulse, the contacts, the penetration, the time in contact; the spikes of accelerations and
// forces; the energy and its residual; the error; what the run cost; the order of convergence
// p = log2(e(h) / e(h/2)); the hash.
//
// Rounding: a number of a run is known to some 1e-12 of its scale, and an acceleration, as the
// difference of two speeds over a step, to no better than 16 eps omega / h.
#include "commands/check/check_add.h"

#include "base/room.h"
#include "contact/law.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

static const double ROUNDING = 1e-12;    // of a scale: some 5000 roundings, all to one side
static const double CHOSEN_STEPS = 0.05; // of their number: a change of the method costs more
static const double SPEED_ULPS = 16; // of a speed before and after a step, and of what made them

static void add(CheckAdd *work, const Trajectory *run, const char *part, const char *name,
                CheckMetric metric)
{
    CheckMeasure *measure = work->measure;
    snprintf(metric.name, sizeof metric.name, "%s%s/%s%s%s", run->backend, work->group, part,
             part[0] != '\0' ? "/" : "", name);
    if (!isfinite(metric.value)) {
        measure->is_complete = false;
        snprintf(measure->message, sizeof measure->message, "%s is not finite", metric.name);
        return;
    }
    measure->metrics =
        room_grow(measure->metrics, &measure->room, measure->count + 1, sizeof metric);
    measure->metrics[measure->count++] = metric;
}

// A number of which rounding is that of something else, if that is larger than its scale.
static void add_beside(CheckAdd *work, const Trajectory *run, const char *part, const char *name,
                       double value, double scale, double beside)
{
    const double whole = fmax(fabs(value), scale);
    add(work, run, part, name,
        (CheckMetric){.kind = CHECK_REAL,
                      .value = value,
                      .scale = whole,
                      .floor = ROUNDING * fmax(whole, beside)});
}

static void add_real(CheckAdd *work, const Trajectory *run, const char *part, const char *name,
                     double value, double scale)
{
    add_beside(work, run, part, name, value, scale, 0.0);
}

// What a joint carries may be nothing but the rounding of what moves the mechanism.
static void add_force(CheckAdd *work, const Trajectory *run, const Joint *joint, const char *name,
                      double value, double scale)
{
    const double moving = linkage_is_torsional(joint) ? work->energy : work->force;
    add_beside(work, run, joint->name, name, value, scale, moving);
}

static void add_count(CheckAdd *work, const Trajectory *run, const char *part, const char *name,
                      size_t value)
{
    add(work, run, part, name,
        (CheckMetric){.kind = CHECK_COUNT, .value = (double)value, .scale = (double)value});
}

// What rounding of speeds makes of an acceleration, rad/s^2.
static double alpha_rounding(const Trajectory *run, double omega)
{
    return run->step_s > 0.0 ? SPEED_ULPS * DBL_EPSILON * omega / run->step_s : 0.0;
}

static void add_alpha(CheckAdd *work, const Trajectory *run, size_t number, const char *name,
                      double value, const BodyExtremes *extremes)
{
    const double omega = fmax(work->speeds.turning[number], fmax(fabs(extremes->omega_max.value),
                                                                 fabs(extremes->omega_min.value)));
    const double scale = fmax(work->speeds.speeding[number],
                              fmax(extremes->alpha_max.value, -extremes->alpha_min.value));
    const char *body = work->scenario->linkage.bodies[number].name;
    add(work, run, body, name,
        (CheckMetric){.kind = CHECK_REAL,
                      .value = value,
                      .scale = scale,
                      .floor = ROUNDING * scale + alpha_rounding(run, omega)});
}

// Of steps that a solver chooses by itself extremes depend on where the steps fall: now and then by
// a thousandth, and mostly by nothing. Its samples, at fixed times, are as sure as the solver is.
static bool is_by_samples(BackendKind backend)
{
    return backend == BACKEND_REFERENCE;
}

static BodyExtremes extremes_of_samples(const Trajectory *run, size_t body)
{
    const Motion *start = trajectory_motion(run, 0, body);
    BodyExtremes extremes = {.omega_max.value = start->omega,
                             .omega_min.value = start->omega,
                             .alpha_max.value = start->alpha,
                             .alpha_min.value = start->alpha};
    for (size_t k = 1; k < run->sample_count; k++) {
        const Motion *motion = trajectory_motion(run, k, body);
        extremes.omega_max.value = fmax(extremes.omega_max.value, motion->omega);
        extremes.omega_min.value = fmin(extremes.omega_min.value, motion->omega);
        extremes.alpha_max.value = fmax(extremes.alpha_max.value, motion->alpha);
        extremes.alpha_min.value = fmin(extremes.alpha_min.value, motion->alpha);
    }
    return extremes;
}

static void add_bodies(CheckAdd *work, const Trajectory *run, BackendKind backend)
{
    static const char *const NAMES[2][4] = {
        {"omega_max_rad_s", "omega_min_rad_s", "alpha_max_rad_s2", "alpha_min_rad_s2"},
        {"omega_max_at_samples_rad_s", "omega_min_at_samples_rad_s", "alpha_max_at_samples_rad_s2",
         "alpha_min_at_samples_rad_s2"},
    };
    const char *const *names = NAMES[is_by_samples(backend) ? 1 : 0];
    for (size_t i = 0; i < run->body_count; i++) {
        if ((int)i == run->driven_body) {
            continue;
        }
        const char *name = work->scenario->linkage.bodies[i].name;
        const BodyExtremes body =
            is_by_samples(backend) ? extremes_of_samples(run, i) : run->bodies[i];
        const double scale = work->speeds.turning[i];
        add_real(work, run, name, names[0], body.omega_max.value, scale);
        add_real(work, run, name, names[1], body.omega_min.value, scale);
        add_alpha(work, run, i, names[2], body.alpha_max.value, &body);
        add_alpha(work, run, i, names[3], body.alpha_min.value, &body);
    }
}

static double force_at_samples(const Trajectory *run, size_t joint)
{
    double force = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        force = fmax(force, trajectory_state(run, k, joint)->force);
    }
    return force;
}

static void add_joints(CheckAdd *work, const Trajectory *run, BackendKind backend)
{
    for (size_t i = 0; i < run->joint_count; i++) {
        const Joint *joint = &work->scenario->linkage.joints[i];
        const JointExtremes *extremes = &run->joints[i];
        const bool is_turning = linkage_is_torsional(joint);
        // the reference looks for the peak of a contact between its steps
        if (is_by_samples(backend) && !linkage_has_play(joint)) {
            add_force(work, run, joint, "force_max_at_samples_N", force_at_samples(run, i), 0.0);
        } else {
            add_force(work, run, joint, is_turning ? "force_max_N_m" : "force_max_N",
                      extremes->force_max.value, 0.0);
        }
        if (!linkage_has_play(joint) || !OPTIONS_BACKEND_HAS_PLAY[backend]) {
            continue;
        }
        add_count(work, run, joint->name, "impacts", extremes->impacts);
        add_real(work, run, joint->name, is_turning ? "impulse_N_m_s" : "impulse_N_s",
                 extremes->impulse, 0.0);
        add_real(work, run, joint->name, is_turning ? "penetration_max_rad" : "penetration_max_m",
                 extremes->penetration_max.value, 0.0);
        add_real(work, run, joint->name, "contact_fraction_1", trajectory_contact_share(run, i),
                 0.0);
    }
}

// Of the signals that were looked at for spikes: how many there are, and the mean size of the
// strongest. Widths and impulses come from a history that is thinned where it is nearly straight,
// so that rounding now and then moves them by what the thinning allows.
static double mean_size(const SignalSpikes *found)
{
    double sum = 0.0;
    for (size_t i = 0; i < found->kept; i++) {
        sum += fabs(found->spikes[i].value) / (double)found->kept;
    }
    return sum;
}

static void add_spikes(CheckAdd *work, const Trajectory *run, BackendKind backend)
{
    const Linkage *linkage = &work->scenario->linkage;
    // the reference's chosen steps meet the peak of a spike at varying distances
    for (size_t i = 0; !is_by_samples(backend) && i < run->body_count; i++) {
        const char *name = linkage->bodies[i].name;
        const SignalSpikes *found = &run->alpha_spikes[i];
        if ((int)i != run->driven_body && found->is_known) {
            add_count(work, run, name, "alpha_spikes", found->count);
            add_real(work, run, name, "alpha_spikes_mean_rad_s2", mean_size(found),
                     found->threshold);
        }
    }
    for (size_t i = 0; !is_by_samples(backend) && i < run->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const SignalSpikes *found = &run->force_spikes[i];
        if (found->is_known) {
            add_count(work, run, joint->name, "force_spikes", found->count);
            add_force(work, run, joint,
                      linkage_is_torsional(joint) ? "force_spikes_mean_N_m" : "force_spikes_mean_N",
                      mean_size(found), found->threshold);
        }
    }
}

static void add_energy(CheckAdd *work, const Trajectory *run)
{
    const Energy *energy = &run->energy;
    const double scale = fmax(fabs(energy->drive_work), work->energy);
    add_real(work, run, "energy", "drive_work_J", energy->drive_work, scale);
    add_real(work, run, "energy", "dissipated_J", energy->dissipated, scale);
    add_real(work, run, "energy", "change_J", energy->change, scale);
    add_real(work, run, "energy", "residual_J", energy->residual, scale);
    if (law_has_friction(work->scenario)) {
        add_real(work, run, "energy", "friction_J", energy->friction, scale);
    }
}

// Steps that a solver chooses by itself differ by a percent or so after a rounding.
static void add_effort(CheckAdd *work, const Trajectory *run, const char *name, size_t value)
{
    const double floor = run->step_s > 0.0 ? 0.0 : CHOSEN_STEPS * (double)value;
    add(work, run, "cost", name,
        (CheckMetric){
            .kind = CHECK_EFFORT, .value = (double)value, .scale = (double)value, .floor = floor});
}

static void add_cost(CheckAdd *work, const Trajectory *run)
{
    add_effort(work, run, "steps", run->steps);
    add_effort(work, run, "evaluations", run->evaluations);
    add_count(work, run, "cost", "constraint_rows", run->constraint_rows);
    add_count(work, run, "cost", "contact_rows", run->contact_rows);
    add_count(work, run, "cost", "fallback_rows", run->fallback_rows);
    add(work, run, "", "hash", (CheckMetric){.kind = CHECK_HASH, .hash = run->hash});
}

// Errors are shares already: what rounding may change of them is a share of 1, and the truth that
// they are against may itself be off by its uncertainty.
void check_add_error(CheckAdd *work, const Trajectory *run, const TrajectoryError *error,
                     double uncertainty)
{
    const double values[] = {error->max, error->omega_max, error->omega_rms, error->alpha_max};
    static const char *const NAMES[] = {"max_1", "omega_max_1", "omega_rms_1", "alpha_max_1"};
    for (int i = 0; i < 4; i++) {
        add(work, run, "error", NAMES[i],
            (CheckMetric){.kind = CHECK_REAL,
                          .value = values[i],
                          .scale = values[i],
                          .floor =
                              ROUNDING + uncertainty + (i == 3 ? alpha_rounding(run, 1.0) : 0.0)});
    }
}

void check_add_order(CheckAdd *work, const Trajectory *run, const char *name, double error,
                     double finer)
{
    // the quotient of two errors, each known to ROUNDING
    const double floor = 2.0 * ROUNDING / (finer * M_LN2);
    add(work, run, "error", name,
        (CheckMetric){.kind = CHECK_REAL,
                      .is_slow = true,
                      .value = log2(error / finer),
                      .scale = 1.0,
                      .floor = floor});
}

CheckAdd check_add_begin(const Scenario *scenario, const char *group, CheckMeasure *measure)
{
    CheckAdd work = {
        .scenario = scenario, .measure = measure, .group = group, .speeds = scale_speeds(scenario)};
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        const Body *body = &scenario->linkage.bodies[i];
        work.energy += 0.5 * body->mass * work.speeds.moving * work.speeds.moving;
        work.force += body->mass * work.speeds.changing;
    }
    return work;
}

void check_add_end(CheckAdd *work)
{
    scale_free(&work->speeds);
}

void check_add_run(CheckAdd *work, const Trajectory *run, BackendKind backend)
{
    add_bodies(work, run, backend);
    add_joints(work, run, backend);
    add_spikes(work, run, backend);
    add_energy(work, run);
    add_cost(work, run);
}
