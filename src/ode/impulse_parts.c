// How do mechanisms that share nothing but the ground move side by side, contacts integrated within
// the step?
//
// Each by itself (ode/impulse.c), in a world of its own: a contact of one shortens no local step of
// another, and nothing is solved for all of them together. A step of all is handed on in parts, in
// order of time. A part is one mechanism's up to its next mark. The others stand in its record as
// they were at their last marks, but for whether their joints touch from there on: that is constant
// from mark to mark, so that contacts begin, last and end in the record when they do.
#include "ode/impulse_parts.h"

#include "base/zeroed.h"
#include "ode/impulse_members.h"
#include "ode/stepping.h"

#include <math.h>

typedef struct Parts {
    const Scenario *scenario;
    const ImpulsePartsOf *of;
    size_t count;
    Member *members;
    size_t ahead_count; // members whose next part does not end with the step
    size_t *ahead;      // a heap, the next part first; owned, as are the arrays below
    size_t delivered;   // the member whose part was handed on last; all of them: count
    double *omega;      // by body and by joint of the whole
    double *alpha;
    JointState *joints;
    SpaceJointState *space_joints; // NULL in the plane
    double *impulse;
    double *approach;
    StepRecord record;
} Parts;

static bool is_whole(const Scenario *scenario)
{
    // steps of all end together only where none is shortened
    return scenario->ode.gear > 1 || scenario->linkage.driver.speeds.count > 0;
}

size_t impulse_parts_count(const Scenario *scenario)
{
    if (is_whole(scenario) || scenario->linkage.body_count == 0) {
        return 1;
    }
    return impulse_members_count(&scenario->linkage);
}

void impulse_parts_close(void *state)
{
    Parts *parts = state;
    if (parts != NULL) {
        impulse_members_free(parts->members, parts->count, parts->of->solver);
        free(parts->ahead);
        free(parts->omega);
        free(parts->alpha);
        free(parts->joints);
        free(parts->space_joints);
        free(parts->impulse);
        free(parts->approach);
        free(parts);
    }
}

bool impulse_parts_open(const Scenario *scenario, const ImpulsePartsOf *of, void **state, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    Parts *parts = zeroed(1, sizeof *parts);
    parts->scenario = scenario;
    parts->of = of;
    parts->members = impulse_members_make(scenario, &parts->count);
    parts->delivered = parts->count;
    parts->ahead = zeroed(parts->count, sizeof *parts->ahead);
    parts->omega = zeroed(linkage->body_count, sizeof *parts->omega);
    parts->alpha = zeroed(linkage->body_count, sizeof *parts->alpha);
    parts->joints = zeroed(linkage->joint_count, sizeof *parts->joints);
    if (linkage->is_spatial) {
        parts->space_joints = zeroed(linkage->joint_count, sizeof *parts->space_joints);
    }
    parts->impulse = zeroed(linkage->joint_count, sizeof *parts->impulse);
    parts->approach = zeroed(linkage->joint_count, sizeof *parts->approach);
    for (size_t i = 0; i < parts->count; i++) {
        Member *member = &parts->members[i];
        if (!of->solver->open(member->scenario, &member->state, err)) {
            impulse_parts_close(parts);
            return false;
        }
    }
    *state = parts;
    return true;
}

// Takes the next part of a member. In the record its joints touch as they do from now on.
static bool fetch(Parts *parts, size_t number, Err *err)
{
    Member *member = &parts->members[number];
    if (!parts->of->solver->step(member->state, 0.0, err)) {
        return false;
    }
    member->next = parts->of->solver->record(member->state);
    for (size_t i = 0; i < member->scenario->linkage.joint_count; i++) {
        const int joint = member->joints[i];
        parts->joints[joint].is_touching = member->next.joints[i].is_touching;
        parts->approach[joint] = member->next.approach[i];
    }
    return true;
}

// Puts the next part of a member into the record; or takes its impulses out again.
static void deliver(Parts *parts, Member *member)
{
    const StepRecord *next = &member->next;
    for (size_t i = 0; i < member->scenario->linkage.body_count; i++) {
        parts->omega[member->bodies[i]] = next->omega[i];
        parts->alpha[member->bodies[i]] = next->alpha[i];
    }
    for (size_t i = 0; i < member->scenario->linkage.joint_count; i++) {
        parts->joints[member->joints[i]] = next->joints[i];
        if (parts->space_joints != NULL) {
            parts->space_joints[member->joints[i]] = next->space_joints[i];
        }
        parts->impulse[member->joints[i]] = next->impulse[i];
    }
    parts->record.drive_work += next->drive_work;
    parts->record.dissipated += next->dissipated;
    parts->record.friction += next->friction;
    parts->record.elastic += next->elastic - member->elastic;
    member->elastic = next->elastic;
}

static void forget_impulses(Parts *parts, const Member *member)
{
    for (size_t i = 0; i < member->scenario->linkage.joint_count; i++) {
        parts->impulse[member->joints[i]] = 0.0;
    }
}

// Of two members, which has the part that is handed on first.
static bool is_before(const Parts *parts, size_t a, size_t b)
{
    const double end_a = parts->members[a].next.end_s;
    const double end_b = parts->members[b].next.end_s;
    return end_a < end_b || (end_a == end_b && a < b);
}

// Restores the order of `ahead`, a heap with the first on top, below a place whose part has become
// a later one.
static void sink(Parts *parts, size_t at)
{
    size_t *ahead = parts->ahead;
    for (size_t child = 2 * at + 1; child < parts->ahead_count; child = 2 * at + 1) {
        if (child + 1 < parts->ahead_count && is_before(parts, ahead[child + 1], ahead[child])) {
            child++;
        }
        if (!is_before(parts, ahead[child], ahead[at])) {
            return;
        }
        const size_t moved = ahead[at];
        ahead[at] = ahead[child];
        ahead[child] = moved;
        at = child;
    }
}

// Begins a step of all members.
static bool begin(Parts *parts, Err *err)
{
    parts->ahead_count = 0;
    for (size_t i = 0; i < parts->count; i++) {
        if (!fetch(parts, i, err)) {
            return false;
        }
        if (!parts->of->is_at_end(parts->members[i].state)) {
            parts->ahead[parts->ahead_count++] = i;
        }
    }
    for (size_t i = parts->ahead_count / 2; i-- > 0;) {
        sink(parts, i);
    }
    return true;
}

// Goes on behind the part that was handed on last: with the same member's next one, or with all.
static bool go_on(Parts *parts, Err *err)
{
    const size_t last = parts->delivered;
    if (last == parts->count) {
        for (size_t i = 0; i < parts->count; i++) {
            forget_impulses(parts, &parts->members[i]);
        }
        return begin(parts, err);
    }
    forget_impulses(parts, &parts->members[last]);
    if (!fetch(parts, last, err)) {
        return false;
    }
    // it is on top; one whose part has been taken up to the step's end waits for the others
    if (parts->of->is_at_end(parts->members[last].state)) {
        parts->ahead[0] = parts->ahead[--parts->ahead_count];
    }
    sink(parts, 0);
    return true;
}

bool impulse_parts_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    Parts *parts = state;
    const double start_s = parts->record.end_s;
    const double elastic = parts->record.elastic;
    if (!go_on(parts, err)) {
        return false;
    }
    parts->record = (StepRecord){.start_s = start_s, .elastic = elastic};
    if (parts->ahead_count > 0) {
        parts->delivered = parts->ahead[0];
        deliver(parts, &parts->members[parts->delivered]);
    } else {
        parts->delivered = parts->count;
        for (size_t i = 0; i < parts->count; i++) {
            deliver(parts, &parts->members[i]);
        }
    }
    const size_t latest = parts->delivered == parts->count ? 0 : parts->delivered;
    StepRecord *record = &parts->record;
    record->end_s = record->joint_s = parts->members[latest].next.end_s;
    record->omega = parts->omega;
    record->alpha = parts->alpha;
    record->joints = parts->joints;
    record->space_joints = parts->space_joints;
    record->impulse = parts->impulse;
    record->approach = parts->approach;
    return true;
}

StepRecord impulse_parts_record(const void *state)
{
    const Parts *parts = state;
    return parts->record;
}

void impulse_parts_observe(const void *state, double time_s, Sample *sample)
{
    const Parts *parts = state;
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(&parts->scenario->linkage, time_s);
    for (size_t i = 0; i < parts->count; i++) {
        Member *member = &parts->members[i];
        const Linkage *linkage = &member->scenario->linkage;
        parts->of->solver->observe(member->state, time_s, &member->sample);
        for (size_t k = 0; k < linkage->body_count; k++) {
            sample->bodies[member->bodies[k]] = member->sample.bodies[k];
            if (linkage->is_spatial) {
                sample->space_bodies[member->bodies[k]] = member->sample.space_bodies[k];
            }
        }
        for (size_t k = 0; k < linkage->joint_count; k++) {
            sample->joints[member->joints[k]] = member->sample.joints[k];
            if (linkage->is_spatial) {
                sample->space_joints[member->joints[k]] = member->sample.space_joints[k];
            }
        }
    }
}

// Rows, steps and evaluations are those of all members.
SolverModel impulse_parts_model(const void *state)
{
    const Parts *parts = state;
    SolverModel model = parts->of->solver->model(parts->members[0].state);
    for (size_t i = 1; i < parts->count; i++) {
        const SolverModel of = parts->of->solver->model(parts->members[i].state);
        model.constraint_rows += of.constraint_rows;
        model.contact_rows += of.contact_rows;
        model.evaluations += of.evaluations;
    }
    stepping_label(parts->scenario, "staggered", "impulse", model.label);
    return model;
}

static bool open_plane(const Scenario *scenario, void **state, Err *err)
{
    static const ImpulsePartsOf PLANE = {&STEPPING_IMPULSE, impulse_is_at_end};
    return impulse_parts_open(scenario, &PLANE, state, err);
}

const Solver STEPPING_IMPULSE_PARTS = {
    .name = "impulse",
    .open = open_plane,
    .step = impulse_parts_step,
    .record = impulse_parts_record,
    .observe = impulse_parts_observe,
    .model = impulse_parts_model,
    .close = impulse_parts_close,
};
