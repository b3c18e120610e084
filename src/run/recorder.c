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

// of a stretch: what ends so little behind its border ends there
static const double BORDER_ROUNDING = 1e-9;

static void empty_stretch(Recorder *recorder)
{
    for (size_t i = 0; i < recorder->trajectory->ranges.signal_count; i++) {
        recorder->now[i] = RANGE_EMPTY;
    }
}

// The end of a stretch, with room for rounding; the last one has none.
static void set_stretch_end(Recorder *recorder)
{
    const Ranges *ranges = &recorder->trajectory->ranges;
    recorder->stretch_end_s =
        recorder->stretch + 1 < ranges->count
            ? ((double)(recorder->stretch + 1) + BORDER_ROUNDING) * ranges->width_s
            : INFINITY;
}

Recorder recorder_start(const Scenario *scenario, Trajectory *trajectory)
{
    trajectory->hash = HASH_START;
    const Linkage *linkage = &scenario->linkage;
    Recorder recorder = {
        .scenario = scenario,
        .trajectory = trajectory,
        .is_empty = true,
        .was_touching = zeroed(linkage->joint_count, sizeof *recorder.was_touching),
        .open = zeroed(linkage->joint_count, sizeof *recorder.open),
        .now = zeroed(trajectory->ranges.signal_count, sizeof *recorder.now),
        .forces = zeroed(linkage->body_count, sizeof *recorder.forces),
    };
    set_stretch_end(&recorder);
    empty_stretch(&recorder);
    return recorder;
}

// The force on each body's centre of mass: its weight, and what its joints do.
static void add_up_forces(const Scenario *scenario, const StepRecord *step, Vec2 *forces)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        forces[i] = (Vec2){0.0, -linkage->bodies[i].mass * scenario->gravity};
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const Vec2 force = step->joints[i].force_on_b;
        if (joint->body_b != LINKAGE_GROUND) {
            forces[joint->body_b] = vec2_add(forces[joint->body_b], force);
        }
        if (joint->body_a != LINKAGE_GROUND) {
            forces[joint->body_a] = vec2_sub(forces[joint->body_a], force);
        }
    }
}

// Takes a step into the stretch under way.
static void add_to_stretch(Recorder *recorder, const StepRecord *step)
{
    const Linkage *linkage = &recorder->scenario->linkage;
    Range *range = recorder->now;
    // without a drive the centres may be all that moves
    const bool has_accelerations = !linkage->driver.is_present;
    if (has_accelerations) {
        add_up_forces(recorder->scenario, step, recorder->forces);
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        range_add(&range[RANGES_OMEGA], step->omega[i]);
        range_add(&range[RANGES_ALPHA], step->alpha[i]);
        if (has_accelerations) {
            range_add(&range[RANGES_ACCELERATION],
                      vec2_length(recorder->forces[i]) / linkage->bodies[i].mass);
        }
        range += RANGES_OF_BODY;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        range_add(&range[RANGES_FORCE], step->joints[i].force);
        range_add(&range[RANGES_GAP], step->joints[i].gap);
        range += RANGES_OF_JOINT;
    }
}

static void close_stretch(Recorder *recorder)
{
    Ranges *ranges = &recorder->trajectory->ranges;
    Range *values = ranges->values + recorder->stretch * ranges->signal_count;
    for (size_t i = 0; i < ranges->signal_count; i++) {
        range_join(&values[i], &recorder->now[i]);
    }
    empty_stretch(recorder);
}

// Goes on to the stretch in which a step ends.
static void turn_to_stretch(Recorder *recorder, const StepRecord *step)
{
    const Ranges *ranges = &recorder->trajectory->ranges;
    const size_t target = ranges_find(ranges, step->end_s - BORDER_ROUNDING * ranges->width_s);
    while (recorder->stretch < target) {
        if (step->is_mean) {
            add_to_stretch(recorder, step);
        }
        close_stretch(recorder);
        recorder->stretch = step->is_mean ? recorder->stretch + 1 : target;
    }
    set_stretch_end(recorder);
}

static void add_ranges(Recorder *recorder, const StepRecord *step)
{
    if (recorder->trajectory->ranges.count == 0) {
        return;
    }
    if (step->end_s > recorder->stretch_end_s) {
        turn_to_stretch(recorder, step);
    }
    add_to_stretch(recorder, step);
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

static double depth_of(const JointState *state)
{
    return state->is_touching && state->gap < 0.0 ? -state->gap : 0.0;
}

// The largest force and depth of a joint in a step, as far as it knows.
static JointTop top_of(const StepRecord *step, size_t number)
{
    const JointState *state = &step->joints[number];
    const JointTop top = {.force = state->force, .depth = depth_of(state)};
    if (step->tops == NULL) {
        return top;
    }
    const JointTop *between = &step->tops[number];
    return (JointTop){fmax(top.force, between->force), fmax(top.depth, between->depth)};
}

static void add_contact(Recorder *recorder, size_t number, const StepRecord *step)
{
    const JointState *state = &step->joints[number];
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
            .approach_speed = step->approach[number],
        };
    }
    if (state->is_touching) {
        spike->duration_s += duration;
        spike->impulse += step->impulse[number];
        const JointTop top = top_of(step, number);
        spike->force_max = fmax(spike->force_max, top.force);
        spike->penetration_max = fmax(spike->penetration_max, top.depth);
        joint->contact_time += is_reported ? duration : 0.0;
        joint->impulse += is_reported ? step->impulse[number] : 0.0;
    } else if (recorder->was_touching[number]) {
        end_contact(recorder, number);
    }
    recorder->was_touching[number] = state->is_touching;
}

// Raises the extremes of one body and one joint to what they are at a time.
static void raise_body(Recorder *recorder, size_t number, double omega, double alpha, double time_s)
{
    BodyExtremes *body = &recorder->trajectory->bodies[number];
    raise_to(&body->omega_max, recorder->is_empty, omega, time_s);
    lower_to(&body->omega_min, recorder->is_empty, omega, time_s);
    raise_to(&body->alpha_max, recorder->is_empty, alpha, time_s);
    lower_to(&body->alpha_min, recorder->is_empty, alpha, time_s);
}

static void raise_joint(Recorder *recorder, size_t number, const JointTop *top, double time_s)
{
    JointExtremes *joint = &recorder->trajectory->joints[number];
    raise_to(&joint->force_max, recorder->is_empty, top->force, time_s);
    raise_to(&joint->penetration_max, recorder->is_empty, top->depth, time_s);
}

// Of a block between guides.
static void raise_tilt(Recorder *recorder, size_t number, const JointState *state, double time_s)
{
    if (recorder->scenario->linkage.joints[number].kind == JOINT_GUIDE) {
        raise_to(&recorder->trajectory->joints[number].tilt_max, recorder->is_empty,
                 fabs(state->tilt), time_s);
    }
}

static void raise_joint_space(Recorder *recorder, size_t number, const SpaceJointState *state,
                              double time_s)
{
    JointExtremes *joint = &recorder->trajectory->joints[number];
    raise_to(&joint->tilt_max, recorder->is_empty, state->tilt, time_s);
    raise_to(&joint->axial_max, recorder->is_empty, fabs(state->axial), time_s);
}

static void raise_all(Recorder *recorder, const StepRecord *step)
{
    for (size_t i = 0; step->space_joints != NULL && i < recorder->trajectory->joint_count; i++) {
        raise_joint_space(recorder, i, &step->space_joints[i], step->joint_s);
    }
    for (size_t i = 0; i < recorder->trajectory->body_count; i++) {
        raise_body(recorder, i, step->omega[i], step->alpha[i], step->end_s);
    }
    for (size_t i = 0; i < recorder->trajectory->joint_count; i++) {
        const JointTop top = top_of(step, i);
        raise_joint(recorder, i, &top, step->joint_s);
        raise_tilt(recorder, i, &step->joints[i], step->joint_s);
    }
    recorder->is_empty = false;
}

void recorder_add(Recorder *recorder, const StepRecord *step)
{
    Trajectory *trajectory = recorder->trajectory;
    uint64_t hash = trajectory->hash;
    for (size_t i = 0; i < trajectory->body_count; i++) {
        hash = hash_number(hash_number(hash, step->omega[i]), step->alpha[i]);
    }
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        hash = hash_number(hash, step->joints[i].force);
        if (linkage_has_play(&recorder->scenario->linkage.joints[i])) {
            add_contact(recorder, i, step);
        }
    }
    trajectory->hash = hash;
    if (is_after_start(recorder, step->end_s)) {
        raise_all(recorder, step);
    }
    add_ranges(recorder, step);
    trajectory->energy.drive_work += step->drive_work;
    trajectory->energy.dissipated += step->dissipated;
    trajectory->energy.friction += step->friction;
}

void recorder_see(Recorder *recorder, const Sample *sample)
{
    Trajectory *trajectory = recorder->trajectory;
    Ranges *ranges = &trajectory->ranges;
    const double time_s = sample->time_s;
    for (size_t i = 0; ranges->count > 0 && i < trajectory->body_count; i++) {
        const Motion *motion = &sample->bodies[i];
        ranges_add(ranges, ranges_of_body(i, RANGES_OMEGA), time_s, motion->omega);
        ranges_add(ranges, ranges_of_body(i, RANGES_ALPHA), time_s, motion->alpha);
        ranges_add(ranges, ranges_of_body(i, RANGES_ACCELERATION), time_s,
                   vec2_length(motion->acceleration));
    }
    for (size_t i = 0; ranges->count > 0 && i < trajectory->joint_count; i++) {
        const JointState *state = &sample->joints[i];
        ranges_add(ranges, ranges_of_joint(ranges, i, RANGES_FORCE), time_s, state->force);
        ranges_add(ranges, ranges_of_joint(ranges, i, RANGES_GAP), time_s, state->gap);
    }
    if (recorder->is_empty || time_s < trajectory->report_from_s) {
        return;
    }
    for (size_t i = 0; i < trajectory->body_count; i++) {
        raise_body(recorder, i, sample->bodies[i].omega, sample->bodies[i].alpha, time_s);
    }
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        const JointState *state = &sample->joints[i];
        const JointTop top = {.force = state->force, .depth = depth_of(state)};
        raise_joint(recorder, i, &top, time_s);
        raise_tilt(recorder, i, &sample->joints[i], time_s);
        if (recorder->scenario->linkage.is_spatial) {
            raise_joint_space(recorder, i, &sample->space_joints[i], time_s);
        }
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
    if (trajectory->ranges.count > 0) {
        close_stretch(recorder);
    }
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
    free(recorder->was_touching);
    free(recorder->open);
    free(recorder->now);
    free(recorder->forces);
}
