// Where is what a run found kept?
#include "model/trajectory.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

Trajectory *trajectory_create(const Scenario *scenario, const char *backend)
{
    Trajectory *trajectory = calloc(1, sizeof *trajectory);
    assert(trajectory != NULL);
    const size_t samples = scenario_sample_count(scenario);
    trajectory->body_count = scenario->linkage.body_count;
    trajectory->joint_count = scenario->linkage.joint_count;
    trajectory->driven_body = linkage_driven_body(&scenario->linkage);
    for (size_t i = 0; i < trajectory->body_count; i++) {
        trajectory->reach[i] = linkage_reach(&scenario->linkage, (int)i);
    }
    trajectory->sample_count = samples;
    trajectory->times = calloc(samples, sizeof *trajectory->times);
    trajectory->crank_angles = calloc(samples, sizeof *trajectory->crank_angles);
    trajectory->motions = calloc(samples * trajectory->body_count + 1, sizeof *trajectory->motions);
    trajectory->states = calloc(samples * trajectory->joint_count + 1, sizeof *trajectory->states);
    snprintf(trajectory->backend, sizeof trajectory->backend, "%s", backend);
    snprintf(trajectory->label, sizeof trajectory->label, "%s", backend);
    if (trajectory->times == NULL || trajectory->crank_angles == NULL ||
        trajectory->motions == NULL || trajectory->states == NULL) {
        trajectory->sample_count = 0;
        snprintf(trajectory->message, sizeof trajectory->message,
                 "there is no memory for %zu samples", samples);
    }
    return trajectory;
}

void trajectory_destroy(Trajectory *trajectory)
{
    if (trajectory == NULL) {
        return;
    }
    free(trajectory->times);
    free(trajectory->crank_angles);
    free(trajectory->motions);
    free(trajectory->states);
    free(trajectory);
}

void trajectory_store(Trajectory *trajectory, size_t sample_index, const Sample *sample)
{
    assert(sample_index < trajectory->sample_count);
    trajectory->times[sample_index] = sample->time_s;
    trajectory->crank_angles[sample_index] = sample->crank_rad;
    for (size_t i = 0; i < trajectory->body_count; i++) {
        trajectory->motions[sample_index * trajectory->body_count + i] = sample->bodies[i];
    }
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        trajectory->states[sample_index * trajectory->joint_count + i] = sample->joints[i];
    }
}

const Motion *trajectory_motion(const Trajectory *trajectory, size_t sample, size_t body)
{
    return trajectory->motions + sample * trajectory->body_count + body;
}

const JointState *trajectory_state(const Trajectory *trajectory, size_t sample, size_t joint)
{
    return trajectory->states + sample * trajectory->joint_count + joint;
}

bool trajectory_feels_play(const Trajectory *trajectory, const Joint *joint)
{
    return trajectory->is_complete && joint->kind == JOINT_CLEARANCE &&
           strcmp(trajectory->backend, OPTIONS_BACKENDS[BACKEND_ANALYTIC]) != 0;
}

double trajectory_omega_scale(const Trajectory *trajectory, size_t body)
{
    double largest = 0.0;
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        largest = fmax(largest, fabs(trajectory_motion(trajectory, k, body)->omega));
    }
    return largest;
}
