// Which extremes and which contacts did a run have, whatever its samples show?
//
// Every step counts: extremes of omega (at the step's end) and alpha (its mean), each contact from
// the first step with overlap to the last: force maximum, impulse, depth, duration; and the energy
// that went in and out.
#include "run/recorder.h"

#include "base/hash.h"

#include <string.h>

Recorder recorder_start(const Scenario *scenario, Trajectory *trajectory)
{
    trajectory->hash = HASH_START;
    return (Recorder){.scenario = scenario, .trajectory = trajectory, .is_empty = true};
}

static inline void raise_to(Extreme *extreme, bool is_first, double value, double sign,
                            double time_s)
{
    if (is_first || sign * value > sign * extreme->value) {
        extreme->value = value;
        extreme->time_s = time_s;
    }
}

// Puts a finished contact among the strongest, in order of force.
static void keep_spike(JointExtremes *joint, const Spike *spike)
{
    size_t place = joint->spike_count;
    while (place > 0 && joint->spikes[place - 1].force_max < spike->force_max) {
        place--;
    }
    if (place == TRAJECTORY_SPIKE_MAX) {
        return;
    }
    if (joint->spike_count < TRAJECTORY_SPIKE_MAX) {
        joint->spike_count++;
    }
    const size_t moved = joint->spike_count - 1 - place;
    memmove(&joint->spikes[place + 1], &joint->spikes[place], moved * sizeof *spike);
    joint->spikes[place] = *spike;
}

static void add_contact(Recorder *recorder, size_t number, const StepRecord *step)
{
    const JointState *state = &step->joints[number];
    JointExtremes *joint = &recorder->trajectory->joints[number];
    Spike *spike = &recorder->open[number];
    const double duration = step->end_s - step->start_s;
    if (state->is_touching && !recorder->was_touching[number]) {
        joint->impacts++;
        *spike = (Spike){
            .onset_s = step->start_s,
            .crank_rad = linkage_crank_angle(&recorder->scenario->linkage, step->start_s),
            .approach_speed = step->approach[number],
        };
    }
    if (state->is_touching) {
        spike->duration_s += duration;
        spike->impulse += step->impulse[number];
        spike->force_max = fmax(spike->force_max, state->force);
        spike->penetration_max = fmax(spike->penetration_max, -state->gap);
        joint->contact_time += duration;
        joint->impulse += step->impulse[number];
    } else if (recorder->was_touching[number]) {
        keep_spike(joint, spike);
    }
    recorder->was_touching[number] = state->is_touching;
}

static void add_joint(Recorder *recorder, size_t number, const StepRecord *step)
{
    const JointState *state = &step->joints[number];
    JointExtremes *joint = &recorder->trajectory->joints[number];
    const double depth = state->is_touching ? fmax(0.0, -state->gap) : 0.0;
    raise_to(&joint->force_max, recorder->is_empty, state->force, 1.0, step->joint_s);
    raise_to(&joint->penetration_max, recorder->is_empty, depth, 1.0, step->joint_s);
    if (recorder->scenario->linkage.joints[number].kind == JOINT_CLEARANCE) {
        add_contact(recorder, number, step);
    }
}

void recorder_add(Recorder *recorder, const StepRecord *step)
{
    Trajectory *trajectory = recorder->trajectory;
    uint64_t hash = trajectory->hash;
    for (size_t i = 0; i < trajectory->body_count; i++) {
        BodyExtremes *body = &trajectory->bodies[i];
        raise_to(&body->omega_max, recorder->is_empty, step->omega[i], 1.0, step->end_s);
        raise_to(&body->omega_min, recorder->is_empty, step->omega[i], -1.0, step->end_s);
        raise_to(&body->alpha_max, recorder->is_empty, step->alpha[i], 1.0, step->end_s);
        raise_to(&body->alpha_min, recorder->is_empty, step->alpha[i], -1.0, step->end_s);
        hash = hash_number(hash_number(hash, step->omega[i]), step->alpha[i]);
    }
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        add_joint(recorder, i, step);
        hash = hash_number(hash, step->joints[i].force);
    }
    trajectory->hash = hash;
    trajectory->energy.drive_work += step->drive_work;
    trajectory->energy.dissipated += step->dissipated;
    trajectory->energy.friction += step->friction;
    recorder->is_empty = false;
}

static void set_crank(const Linkage *linkage, Extreme *extreme)
{
    extreme->crank_rad = linkage_crank_angle(linkage, extreme->time_s);
}

void recorder_finish(Recorder *recorder)
{
    Trajectory *trajectory = recorder->trajectory;
    const Linkage *linkage = &recorder->scenario->linkage;
    for (size_t i = 0; i < trajectory->body_count; i++) {
        set_crank(linkage, &trajectory->bodies[i].omega_max);
        set_crank(linkage, &trajectory->bodies[i].omega_min);
        set_crank(linkage, &trajectory->bodies[i].alpha_max);
        set_crank(linkage, &trajectory->bodies[i].alpha_min);
    }
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        if (recorder->was_touching[i]) {
            keep_spike(&trajectory->joints[i], &recorder->open[i]);
        }
        set_crank(linkage, &trajectory->joints[i].force_max);
        set_crank(linkage, &trajectory->joints[i].penetration_max);
    }
}
