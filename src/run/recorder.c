// Which extremes and which contacts did a run have, whatever its samples show?
//
// Every step counts: extremes of omega (at the step's end) and alpha (its mean), each contact from
// the first step with overlap to the last: force maximum, impulse, depth, duration; and the energy
// that went in and out. Extremes and contacts are those of the reported time alone. The ranges hold
// the same values, and every value that is shown, over the whole run; a step that crosses the
// border of two stretches belongs to both where its values are means.
#include "run/recorder.h"

#include "base/hash.h"
#include "base/sorted.h"
#include "base/zeroed.h"

Recorder recorder_start(const Scenario *scenario, Trajectory *trajectory)
{
    trajectory->hash = HASH_START;
    const Linkage *linkage = &scenario->linkage;
    Recorder recorder = {
        .scenario = scenario,
        .trajectory = trajectory,
        .has_body = zeroed(linkage->body_count, sizeof *recorder.has_body),
        .has_joint = zeroed(linkage->joint_count, sizeof *recorder.has_joint),
        .was_touching = zeroed(linkage->joint_count, sizeof *recorder.was_touching),
        .open = zeroed(linkage->joint_count, sizeof *recorder.open),
        .ranges = recorder_ranges_start(scenario, trajectory),
    };
    return recorder;
}

static inline void raise_to(Extreme *extreme, bool is_first, double value, double time_s)
{
    if (is_first || value > extreme->value) {
        extreme->value = value;
        extreme->time_s = time_s;
    }
}

static inline void lower_to(Extreme *extreme, bool is_first, double value, double time_s)
{
    if (is_first || value < extreme->value) {
        extreme->value = value;
        extreme->time_s = time_s;
    }
}

// Whether a step that ends then belongs to the reported time. The first of all may have no length.
static bool is_after_start(const Recorder *recorder, double end_s)
{
    const double from_s = recorder->trajectory->report_from_s;
    return end_s > from_s || from_s == 0.0;
}

static bool is_stronger(const void *a, const void *b)
{
    return ((const Spike *)a)->force_max > ((const Spike *)b)->force_max;
}

// One that began before the reported time is not a contact of it.
static void end_contact(Recorder *recorder, size_t number)
{
    if (recorder->open[number].onset_s >= recorder->trajectory->report_from_s) {
        JointExtremes *joint = &recorder->trajectory->joints[number];
        sorted_insert(joint->spikes, &joint->spike_count, TRAJECTORY_SPIKE_MAX,
                      &recorder->open[number], sizeof(Spike), is_stronger);
    }
}

// The force and depth of a joint at a time.
static JointTop top_at(const JointState *state, double time_s)
{
    return (JointTop){state->force, joint_state_depth(state), time_s, time_s};
}

// The largest force and depth of a joint in a step, as far as it knows.
static JointTop top_of(const StepRecord *step, size_t index)
{
    JointTop top = top_at(&step->joints[index], step->joint_s);
    if (step->tops == NULL) {
        return top;
    }
    const JointTop *between = &step->tops[index];
    if (between->force > top.force) {
        top.force = between->force;
        top.force_s = between->force_s > 0.0 ? between->force_s : step->joint_s;
    }
    if (between->depth > top.depth) {
        top.depth = between->depth;
        top.depth_s = between->depth_s > 0.0 ? between->depth_s : step->joint_s;
    }
    return top;
}

// Of a joint in a step, by its place there.
static void add_contact(Recorder *recorder, const StepRecord *step, size_t index)
{
    const size_t number = solver_joint(step->part, index);
    const JointState *state = &step->joints[index];
    JointExtremes *joint = &recorder->trajectory->joints[number];
    Spike *spike = &recorder->open[number];
    const double duration = step->end_s - step->start_s;
    const double from_s = recorder->trajectory->report_from_s;
    const bool is_reported = is_after_start(recorder, step->end_s);
    if (state->is_touching && !recorder->was_touching[number]) {
        joint->impacts += step->start_s >= from_s ? 1 : 0;
        *spike = (Spike){
            .onset_s = step->start_s,
            .crank_rad = linkage_crank_angle(&recorder->scenario->linkage, step->start_s),
            .approach_speed = step->approach[index],
        };
    }
    if (state->is_touching) {
        spike->duration_s += duration;
        spike->impulse += step->impulse[index];
        const JointTop top = top_of(step, index);
        spike->force_max = fmax(spike->force_max, top.force);
        spike->penetration_max = fmax(spike->penetration_max, top.depth);
        joint->contact_time += is_reported ? duration : 0.0;
        joint->impulse += is_reported ? step->impulse[index] : 0.0;
    } else if (recorder->was_touching[number]) {
        end_contact(recorder, number);
    }
    recorder->was_touching[number] = state->is_touching;
}

// Raises the extremes of one body and one joint to what they are at a time.
static inline void raise_body(BodyExtremes *body, bool is_first, double omega, double alpha,
                              double time_s)
{
    raise_to(&body->omega_max, is_first, omega, time_s);
    lower_to(&body->omega_min, is_first, omega, time_s);
    raise_to(&body->alpha_max, is_first, alpha, time_s);
    lower_to(&body->alpha_min, is_first, alpha, time_s);
}

// The tilt is that of a block between guides.
static inline void raise_joint(JointExtremes *extremes, bool is_first, const Joint *joint,
                               const JointTop *top, double tilt, double time_s)
{
    raise_to(&extremes->force_max, is_first, top->force, top->force_s);
    raise_to(&extremes->penetration_max, is_first, top->depth, top->depth_s);
    if (joint->kind == JOINT_GUIDE) {
        raise_to(&extremes->tilt_max, is_first, fabs(tilt), time_s);
    }
}

static void raise_joint_space(JointExtremes *joint, bool is_first, const SpaceJointState *state,
                              double time_s)
{
    raise_to(&joint->tilt_max, is_first, state->tilt, time_s);
    raise_to(&joint->axial_max, is_first, fabs(state->axial), time_s);
}

static void raise_all(Recorder *recorder, const StepRecord *step)
{
    Trajectory *trajectory = recorder->trajectory;
    const Linkage *linkage = &recorder->scenario->linkage;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(step->part, k);
        raise_body(&trajectory->bodies[i], !recorder->has_body[i], step->omega[k], step->alpha[k],
                   step->end_s);
        recorder->has_body[i] = true;
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t i = solver_joint(step->part, k);
        const JointTop top = top_of(step, k);
        const bool is_first = !recorder->has_joint[i];
        JointExtremes *joint = &trajectory->joints[i];
        if (step->space_joints != NULL) {
            raise_joint_space(joint, is_first, &step->space_joints[k], step->joint_s);
        }
        raise_joint(joint, is_first, &linkage->joints[i], &top, step->joints[k].tilt,
                    step->joint_s);
        recorder->has_joint[i] = true;
    }
}

void recorder_add(Recorder *recorder, const StepRecord *step)
{
    Trajectory *trajectory = recorder->trajectory;
    const Linkage *linkage = &recorder->scenario->linkage;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    uint64_t hash = trajectory->hash;
    for (size_t k = 0; k < body_count; k++) {
        hash = hash_number(hash_number(hash, step->omega[k]), step->alpha[k]);
    }
    for (size_t k = 0; k < joint_count; k++) {
        hash = hash_number(hash, step->joints[k].force);
        if (linkage_has_play(&linkage->joints[solver_joint(step->part, k)])) {
            add_contact(recorder, step, k);
        }
    }
    trajectory->hash = hash;
    if (is_after_start(recorder, step->end_s)) {
        raise_all(recorder, step);
    }
    recorder_ranges_add(&recorder->ranges, step);
    trajectory->energy.drive_work += step->drive_work;
    trajectory->energy.dissipated += step->dissipated;
    trajectory->energy.friction += step->friction;
}

void recorder_see(Recorder *recorder, const SolverPart *part, const Sample *sample)
{
    Trajectory *trajectory = recorder->trajectory;
    const Linkage *linkage = &recorder->scenario->linkage;
    const size_t body_count = solver_body_count(part, linkage);
    const size_t joint_count = solver_joint_count(part, linkage);
    const double time_s = sample->time_s;
    recorder_ranges_see(&recorder->ranges, part, sample);
    if (time_s < trajectory->report_from_s) {
        return;
    }
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(part, k);
        if (recorder->has_body[i]) {
            raise_body(&trajectory->bodies[i], false, sample->bodies[i].omega,
                       sample->bodies[i].alpha, time_s);
        }
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t i = solver_joint(part, k);
        if (!recorder->has_joint[i]) {
            continue;
        }
        const JointState *state = &sample->joints[i];
        const JointTop top = top_at(state, time_s);
        raise_joint(&trajectory->joints[i], false, &linkage->joints[i], &top, state->tilt, time_s);
        if (linkage->is_spatial) {
            raise_joint_space(&trajectory->joints[i], false, &sample->space_joints[i], time_s);
        }
    }
}

// The same, to be changed.
static Extreme *find_extreme(Trajectory *trajectory, RecorderSignal signal, size_t number,
                             double sign)
{
    BodyExtremes *body = &trajectory->bodies[number];
    switch (signal) {
    case RECORDER_OMEGA:
        return sign > 0.0 ? &body->omega_max : &body->omega_min;
    case RECORDER_ALPHA:
        return sign > 0.0 ? &body->alpha_max : &body->alpha_min;
    default:
        return &trajectory->joints[number].force_max;
    }
}

const Extreme *recorder_extreme(const Recorder *recorder, RecorderSignal signal, size_t number,
                                double sign)
{
    return find_extreme(recorder->trajectory, signal, number, sign);
}

void recorder_raise(Recorder *recorder, RecorderSignal signal, size_t number, double sign,
                    Extreme extreme)
{
    Trajectory *trajectory = recorder->trajectory;
    const bool is_force = signal == RECORDER_FORCE;
    const RangesOfBody of_body = signal == RECORDER_OMEGA ? RANGES_OMEGA : RANGES_ALPHA;
    if (trajectory->ranges.count > 0) {
        ranges_add(&trajectory->ranges,
                   is_force ? ranges_of_joint(&trajectory->ranges, number, RANGES_FORCE)
                            : ranges_of_body(number, of_body),
                   extreme.time_s, extreme.value);
    }
    if (extreme.time_s >= trajectory->report_from_s &&
        (is_force ? recorder->has_joint : recorder->has_body)[number]) {
        *find_extreme(trajectory, signal, number, sign) = extreme;
    }
}

static void set_crank(const Linkage *linkage, Extreme *extreme)
{
    extreme->crank_rad = linkage_crank_angle(linkage, extreme->time_s);
}

void recorder_finish(Recorder *recorder)
{
    Trajectory *trajectory = recorder->trajectory;
    const Linkage *linkage = &recorder->scenario->linkage;
    recorder_ranges_finish(&recorder->ranges);
    for (size_t i = 0; i < trajectory->body_count; i++) {
        set_crank(linkage, &trajectory->bodies[i].omega_max);
        set_crank(linkage, &trajectory->bodies[i].omega_min);
        set_crank(linkage, &trajectory->bodies[i].alpha_max);
        set_crank(linkage, &trajectory->bodies[i].alpha_min);
    }
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        if (recorder->was_touching[i]) {
            end_contact(recorder, i);
        }
        set_crank(linkage, &trajectory->joints[i].force_max);
        set_crank(linkage, &trajectory->joints[i].penetration_max);
        set_crank(linkage, &trajectory->joints[i].tilt_max);
        set_crank(linkage, &trajectory->joints[i].axial_max);
    }
    free(recorder->has_body);
    free(recorder->has_joint);
    free(recorder->was_touching);
    free(recorder->open);
}
