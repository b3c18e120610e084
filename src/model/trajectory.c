// Keeps what a run found.
#include "model/trajectory.h"

#include "base/hermite.h"
#include "base/zeroed.h"

#include <stdio.h>
#include <string.h>

// stretches of a whole run at the least: twice the columns of a panel of a picture
enum { STRETCHES_LEAST = 800 };

Sample sample_create(const Linkage *linkage)
{
    Sample sample = {
        .bodies = zeroed(linkage->body_count, sizeof *sample.bodies),
        .joints = zeroed(linkage->joint_count, sizeof *sample.joints),
    };
    if (linkage->is_spatial) {
        sample.space_bodies = zeroed(linkage->body_count, sizeof *sample.space_bodies);
        sample.space_joints = zeroed(linkage->joint_count, sizeof *sample.space_joints);
    }
    return sample;
}

void sample_free(Sample *sample)
{
    free(sample->bodies);
    free(sample->joints);
    free(sample->space_bodies);
    free(sample->space_joints);
    *sample = (Sample){.bodies = NULL};
}

void sample_copy(const Linkage *linkage, const Sample *from, Sample *to)
{
    to->time_s = from->time_s;
    to->crank_rad = from->crank_rad;
    memcpy(to->bodies, from->bodies, linkage->body_count * sizeof *to->bodies);
    memcpy(to->joints, from->joints, linkage->joint_count * sizeof *to->joints);
    if (linkage->is_spatial) {
        memcpy(to->space_bodies, from->space_bodies,
               linkage->body_count * sizeof *to->space_bodies);
        memcpy(to->space_joints, from->space_joints,
               linkage->joint_count * sizeof *to->space_joints);
    }
}

static void refuse_memory(Trajectory *trajectory, size_t samples)
{
    trajectory->sample_count = 0;
    snprintf(trajectory->message, sizeof trajectory->message, "there is no memory for %zu samples",
             samples);
}

// Room for all but the bodies' motions at the samples; false where there is no memory for it.
static bool make_states(const Scenario *scenario, Trajectory *trajectory)
{
    const size_t samples = trajectory->sample_count;
    const size_t states = samples * trajectory->joint_count + 1;
    trajectory->crank_angles = calloc(samples, sizeof *trajectory->crank_angles);
    trajectory->states = calloc(states, sizeof *trajectory->states);
    bool has_memory = trajectory->crank_angles != NULL && trajectory->states != NULL;
    if (scenario->linkage.is_spatial) {
        trajectory->space_states = calloc(states, sizeof *trajectory->space_states);
        has_memory = has_memory && trajectory->space_states != NULL;
    }
    return has_memory;
}

// With room for them, or without.
static Trajectory *create(const Scenario *scenario, const char *backend, bool has_states)
{
    Trajectory *trajectory = calloc(1, sizeof *trajectory);
    assert(trajectory != NULL);
    const size_t samples = scenario_sample_count(scenario);
    trajectory->body_count = scenario->linkage.body_count;
    trajectory->joint_count = scenario->linkage.joint_count;
    trajectory->reach = zeroed(trajectory->body_count, sizeof *trajectory->reach);
    trajectory->bodies = zeroed(trajectory->body_count, sizeof *trajectory->bodies);
    trajectory->joints = zeroed(trajectory->joint_count, sizeof *trajectory->joints);
    trajectory->alpha_spikes = zeroed(trajectory->body_count, sizeof(SignalSpikes));
    trajectory->force_spikes = zeroed(trajectory->joint_count, sizeof(SignalSpikes));
    linkage_reaches(&scenario->linkage, trajectory->reach);
    trajectory->floor = scale_floor(scenario);
    trajectory->linkage = linkage_copy(&scenario->linkage);
    trajectory->sample_count = samples;
    trajectory->times = calloc(samples, sizeof *trajectory->times);
    trajectory->motions = calloc(samples * trajectory->body_count + 1, sizeof *trajectory->motions);
    bool has_memory = trajectory->times != NULL && trajectory->motions != NULL;
    if (scenario->linkage.is_spatial) {
        trajectory->space_motions =
            calloc(samples * trajectory->body_count + 1, sizeof *trajectory->space_motions);
        has_memory = has_memory && trajectory->space_motions != NULL;
    }
    if (has_states) {
        has_memory = make_states(scenario, trajectory) && has_memory;
    }
    snprintf(trajectory->backend, sizeof trajectory->backend, "%s", backend);
    snprintf(trajectory->label, sizeof trajectory->label, "%s", backend);
    if (!has_memory) {
        refuse_memory(trajectory, samples);
    }
    trajectory->report_from_s = scenario_report_from(scenario);
    return trajectory;
}

Trajectory *trajectory_create(const Scenario *scenario, const char *backend)
{
    return create(scenario, backend, true);
}

Trajectory *trajectory_create_motion(const Scenario *scenario, const char *backend)
{
    return create(scenario, backend, false);
}

void trajectory_keep_ranges(Trajectory *trajectory, const Scenario *scenario)
{
    const size_t samples = trajectory->sample_count;
    if (samples < 2) {
        return;
    }
    const double interval_s = scenario_sample_time(scenario, 1);
    trajectory->parts = (STRETCHES_LEAST + samples - 2) / (samples - 1);
    // what is left of the run behind the last sample is shorter than an interval
    trajectory->ranges = ranges_create(&scenario->linkage, samples * trajectory->parts,
                                       interval_s / (double)trajectory->parts);
    if (trajectory->ranges.count == 0) {
        refuse_memory(trajectory, samples);
    }
}

void trajectory_destroy(Trajectory *trajectory)
{
    if (trajectory == NULL) {
        return;
    }
    free(trajectory->reach);
    linkage_free(&trajectory->linkage);
    free(trajectory->bodies);
    free(trajectory->joints);
    free(trajectory->contacts);
    free(trajectory->marked);
    free(trajectory->wear);
    free(trajectory->alpha_spikes);
    free(trajectory->force_spikes);
    free(trajectory->times);
    free(trajectory->crank_angles);
    free(trajectory->motions);
    free(trajectory->states);
    free(trajectory->space_motions);
    free(trajectory->space_states);
    ranges_finish(&trajectory->ranges);
    free(trajectory);
}

void trajectory_store_motion(Trajectory *trajectory, size_t sample_index, const Sample *sample)
{
    assert(sample_index < trajectory->sample_count);
    trajectory->times[sample_index] = sample->time_s;
    memcpy(trajectory->motions + sample_index * trajectory->body_count, sample->bodies,
           trajectory->body_count * sizeof *sample->bodies);
    if (trajectory->space_motions != NULL) {
        memcpy(trajectory->space_motions + sample_index * trajectory->body_count,
               sample->space_bodies, trajectory->body_count * sizeof *sample->space_bodies);
    }
}

void trajectory_store(Trajectory *trajectory, size_t sample_index, const Sample *sample)
{
    trajectory_store_motion(trajectory, sample_index, sample);
    trajectory->crank_angles[sample_index] = sample->crank_rad;
    memcpy(trajectory->states + sample_index * trajectory->joint_count, sample->joints,
           trajectory->joint_count * sizeof *sample->joints);
    if (trajectory->space_motions != NULL) {
        memcpy(trajectory->space_states + sample_index * trajectory->joint_count,
               sample->space_joints, trajectory->joint_count * sizeof *sample->space_joints);
    }
}

static Range range_of(const Trajectory *trajectory, size_t signal, size_t sample)
{
    const size_t first = sample * trajectory->parts;
    return ranges_over(&trajectory->ranges, signal, first, first + trajectory->parts);
}

// One quantity of a body at a sample.
static double body_value(const Trajectory *trajectory, size_t sample, size_t body,
                         RangesOfBody which)
{
    const Motion *motion = trajectory_motion(trajectory, sample, body);
    return which == RANGES_OMEGA   ? motion->omega
           : which == RANGES_ALPHA ? motion->alpha
                                   : vec2_length(motion->acceleration);
}

Range trajectory_body_range(const Trajectory *trajectory, size_t sample, size_t body,
                            RangesOfBody which)
{
    if (trajectory->ranges.count > 0) {
        return range_of(trajectory, ranges_of_body(body, which), sample);
    }
    Range range = RANGE_EMPTY;
    for (size_t i = sample; i <= sample + 1 && i < trajectory->sample_count; i++) {
        range_add(&range, body_value(trajectory, i, body, which));
    }
    return range;
}

Range trajectory_joint_range(const Trajectory *trajectory, size_t sample, size_t joint,
                             RangesOfJoint which)
{
    if (trajectory->ranges.count > 0) {
        return range_of(trajectory, ranges_of_joint(&trajectory->ranges, joint, which), sample);
    }
    Range range = RANGE_EMPTY;
    for (size_t i = sample; i <= sample + 1 && i < trajectory->sample_count; i++) {
        const JointState *state = trajectory_state(trajectory, i, joint);
        range_add(&range, which == RANGES_FORCE ? state->force : state->gap);
    }
    return range;
}

double trajectory_contact_share(const Trajectory *trajectory, size_t joint)
{
    const double share = trajectory->joints[joint].contact_time /
                         (trajectory->duration_s - trajectory->report_from_s);
    // a sum of steps may be longer than the time that they fill by its rounding
    return share > 1.0 ? 1.0 : share;
}

bool trajectory_feels_play(const Trajectory *trajectory, const Joint *joint)
{
    return trajectory->is_complete && linkage_has_play(joint) &&
           options_backend_has_play(trajectory->backend);
}

double trajectory_omega_scale(const Trajectory *trajectory, size_t body)
{
    double largest = 0.0;
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        largest = fmax(largest, fabs(trajectory_motion(trajectory, k, body)->omega));
    }
    return largest;
}

double trajectory_angle_at(const Trajectory *trajectory, int body, double time_s)
{
    if (body == LINKAGE_GROUND) {
        return 0.0;
    }
    const size_t samples = trajectory->sample_count;
    if (samples < 2) {
        return trajectory_motion(trajectory, 0, (size_t)body)->angle;
    }
    // samples are as far apart from each other as the first two
    const double *times = trajectory->times;
    const double number = floor(time_s / times[1]);
    const size_t before = number < (double)(samples - 2) ? (size_t)number : samples - 2;
    const Motion *a = trajectory_motion(trajectory, before, (size_t)body);
    const Motion *b = trajectory_motion(trajectory, before + 1, (size_t)body);
    const double angles[] = {a->angle, b->angle};
    const double speeds[] = {a->omega, b->omega};
    const Hermite between = hermite_fit(2, &times[before], angles, speeds);
    return hermite_at(&between, time_s).value;
}
