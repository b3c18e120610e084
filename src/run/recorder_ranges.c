// What did every value that is shown do in each stretch of a run?
//
// A value of an instant belongs to the stretch in which its step ends, a mean over a step to every
// stretch that the step reaches into.
#include "run/recorder_ranges.h"

#include "base/zeroed.h"

// of a stretch: what ends so little behind its border ends there
static const double BORDER_ROUNDING = 1e-9;

static void empty_stretch(RecorderRanges *own)
{
    for (size_t i = 0; i < own->trajectory->ranges.signal_count; i++) {
        own->now[i] = RANGE_EMPTY;
    }
}

// The end of a stretch, with room for rounding; the last one has none.
static void set_stretch_end(RecorderRanges *own)
{
    const Ranges *ranges = &own->trajectory->ranges;
    own->stretch_end_s = own->stretch + 1 < ranges->count
                             ? ((double)(own->stretch + 1) + BORDER_ROUNDING) * ranges->width_s
                             : INFINITY;
}

RecorderRanges recorder_ranges_start(const Scenario *scenario, Trajectory *trajectory)
{
    RecorderRanges own = {
        .scenario = scenario,
        .trajectory = trajectory,
        .now = zeroed(trajectory->ranges.signal_count, sizeof *own.now),
        .forces = zeroed(scenario->linkage.body_count, sizeof *own.forces),
    };
    set_stretch_end(&own);
    empty_stretch(&own);
    return own;
}

// The force on each body's centre of mass: its weight, and what its joints do.
static void add_up_forces(const Scenario *scenario, const StepRecord *step, Vec2 *forces)
{
    const Linkage *linkage = &scenario->linkage;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(step->part, k);
        forces[i] = (Vec2){0.0, -linkage->bodies[i].mass * scenario->gravity};
    }
    for (size_t k = 0; k < joint_count; k++) {
        const Joint *joint = &linkage->joints[solver_joint(step->part, k)];
        const Vec2 force = step->joints[k].force_on_b;
        if (joint->body_b != LINKAGE_GROUND) {
            forces[joint->body_b] = vec2_add(forces[joint->body_b], force);
        }
        if (joint->body_a != LINKAGE_GROUND) {
            forces[joint->body_a] = vec2_sub(forces[joint->body_a], force);
        }
    }
}

// Takes a step into a stretch.
static void add_to_stretch(RecorderRanges *own, const StepRecord *step, Range *values)
{
    const Linkage *linkage = &own->scenario->linkage;
    const Ranges *ranges = &own->trajectory->ranges;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    // without a drive the centres may be all that moves
    const bool has_accelerations = !linkage->driver.is_present;
    if (has_accelerations) {
        add_up_forces(own->scenario, step, own->forces);
    }
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(step->part, k);
        Range *range = values + ranges_of_body(i, 0);
        range_add(&range[RANGES_OMEGA], step->omega[k]);
        range_add(&range[RANGES_ALPHA], step->alpha[k]);
        if (has_accelerations) {
            range_add(&range[RANGES_ACCELERATION],
                      vec2_length(own->forces[i]) / linkage->bodies[i].mass);
        }
    }
    for (size_t k = 0; k < joint_count; k++) {
        Range *range = values + ranges_of_joint(ranges, solver_joint(step->part, k), 0);
        range_add(&range[RANGES_FORCE], step->joints[k].force);
        range_add(&range[RANGES_GAP], step->joints[k].gap);
    }
}

static void close_stretch(RecorderRanges *own)
{
    Ranges *ranges = &own->trajectory->ranges;
    Range *values = ranges->values + own->stretch * ranges->signal_count;
    for (size_t i = 0; i < ranges->signal_count; i++) {
        range_join(&values[i], &own->now[i]);
    }
    empty_stretch(own);
}

// Goes on to the stretch in which a step ends.
static void turn_to_stretch(RecorderRanges *own, const StepRecord *step)
{
    const Ranges *ranges = &own->trajectory->ranges;
    const size_t target = ranges_find(ranges, step->end_s - BORDER_ROUNDING * ranges->width_s);
    while (own->stretch < target) {
        if (step->is_mean) {
            add_to_stretch(own, step, own->now);
        }
        close_stretch(own);
        own->stretch = step->is_mean ? own->stretch + 1 : target;
    }
    set_stretch_end(own);
}

void recorder_ranges_add(RecorderRanges *own, const StepRecord *step)
{
    const Ranges *ranges = &own->trajectory->ranges;
    if (ranges->count == 0) {
        return;
    }
    if (step->part != NULL) {
        // parts are not in the order of their times
        const size_t stretch = ranges_find(ranges, step->end_s - BORDER_ROUNDING * ranges->width_s);
        add_to_stretch(own, step, ranges->values + stretch * ranges->signal_count);
        return;
    }
    if (step->end_s > own->stretch_end_s) {
        turn_to_stretch(own, step);
    }
    add_to_stretch(own, step, own->now);
}

void recorder_ranges_see(RecorderRanges *own, const SolverPart *part, const Sample *sample)
{
    const Linkage *linkage = &own->scenario->linkage;
    Ranges *ranges = &own->trajectory->ranges;
    if (ranges->count == 0) {
        return;
    }
    const double time_s = sample->time_s;
    const size_t body_count = solver_body_count(part, linkage);
    const size_t joint_count = solver_joint_count(part, linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(part, k);
        const Motion *motion = &sample->bodies[i];
        ranges_add(ranges, ranges_of_body(i, RANGES_OMEGA), time_s, motion->omega);
        ranges_add(ranges, ranges_of_body(i, RANGES_ALPHA), time_s, motion->alpha);
        ranges_add(ranges, ranges_of_body(i, RANGES_ACCELERATION), time_s,
                   vec2_length(motion->acceleration));
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t i = solver_joint(part, k);
        const JointState *state = &sample->joints[i];
        ranges_add(ranges, ranges_of_joint(ranges, i, RANGES_FORCE), time_s, state->force);
        ranges_add(ranges, ranges_of_joint(ranges, i, RANGES_GAP), time_s, state->gap);
    }
}

void recorder_ranges_finish(RecorderRanges *own)
{
    if (own->trajectory->ranges.count > 0) {
        close_stretch(own);
    }
    free(own->now);
    free(own->forces);
}
