// How does a linkage in space move in ODE if its contacts are integrated within the step? (The
// steps themselves: ode/space_impulse_step.c.)
//
// A step is handed on in parts (ode/impulse_part.c).
#include "base/zeroed.h"
#include "contact/law.h"
#include "ode/impulse_part.h"
#include "ode/impulse_parts.h"
#include "ode/space_impulse_means.h"
#include "ode/space_stepping.h"
#include "ode/stepping.h"

#include <string.h>

typedef struct SpaceImpulse {
    SpaceImpulseStep step;
    ImpulsePart part; // of it, the one that is handed on
    SpaceJoints joints;
    SpaceJoints seen;     // at the time that is asked for
    SpaceMotion *motions; // owned, like the next two
    double *depths;       // m, by place
    bool *are_ends;       // whether a place is one, and no collar
    EncounterSums sums;   // at the time that is asked for
} SpaceImpulse;

static void space_impulse_close(void *state)
{
    SpaceImpulse *impulse = state;
    if (impulse != NULL) {
        impulse_part_finish(&impulse->part);
        space_impulse_step_finish(&impulse->step);
        encounter_sums_free(&impulse->sums);
        space_joints_free(&impulse->joints);
        space_joints_free(&impulse->seen);
        free(impulse->motions);
        free(impulse->depths);
        free(impulse->are_ends);
        free(impulse);
    }
}

static bool space_impulse_open(const Scenario *scenario, void **state, Err *err)
{
    SpaceImpulse *impulse = zeroed(1, sizeof *impulse);
    if (space_impulse_step_init(scenario, &impulse->step, err)) {
        const size_t rows = encounter_rows(&impulse->step.encounter);
        impulse_part_init(&impulse->part, &scenario->linkage, rows);
        impulse->sums = encounter_sums(rows);
        impulse->joints = space_joints_create(&scenario->linkage);
        impulse->seen = space_joints_create(&scenario->linkage);
        impulse->motions = zeroed(scenario->linkage.body_count, sizeof *impulse->motions);
        impulse->depths = zeroed(impulse->step.place_count, sizeof *impulse->depths);
        impulse->are_ends = zeroed(impulse->step.place_count, sizeof *impulse->are_ends);
        *state = impulse;
        return true;
    }
    space_impulse_close(impulse);
    return false;
}

// How deep the pin is at a place at the end of the part, m.
static double depth_at(const SpaceImpulse *impulse, size_t place)
{
    const PinSpace *of = &impulse->step.places[place];
    const SpaceJointState *state = &impulse->joints.space[of->joint];
    return of->place == PIN_SPACE_COLLAR ? fabs(state->axial) - of->clearance
                                         : -state->end_gaps[of->place];
}

static bool check_depths(const SpaceImpulse *impulse, Err *err)
{
    for (size_t i = 0; i < impulse->step.place_count; i++) {
        const PinSpace *place = &impulse->step.places[i];
        if (!law_check_depth(&place->law, &impulse->step.scenario->linkage.joints[place->joint],
                             impulse->depths[i], 1.0, err)) {
            return false;
        }
    }
    return true;
}

// Hands on the part of the step up to its next mark.
static void take_part(SpaceImpulse *impulse)
{
    const SpaceImpulseStep *step = &impulse->step;
    const Linkage *linkage = &step->scenario->linkage;
    ImpulsePart *part = &impulse->part;
    SpaceMotion *motions = impulse->motions;
    const Mark *mark = impulse_part_next(part, &step->encounter, step->start_s, step->end_s);
    space_impulse_step_inside(step, mark->node, mark->time_s, !part->is_last, &part->sums, motions,
                              &impulse->joints);
    impulse_part_record(part, linkage, impulse->joints.plane);
    part->record.space_joints = impulse->joints.space;
    for (size_t i = 0; i < linkage->body_count; i++) {
        part->omega[i] = motions[i].omega.z;
        part->alpha[i] = motions[i].alpha.z;
    }
    for (size_t i = 0; i < step->place_count; i++) {
        impulse->depths[i] = depth_at(impulse, i);
        impulse->are_ends[i] = step->places[i].place != PIN_SPACE_COLLAR;
    }
    impulse_part_add_contacts(part, &step->encounter, mark, impulse->depths, impulse->are_ends);
    part->record.drive_work = part->is_last ? step->drive_work : 0.0;
}

static bool space_impulse_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    SpaceImpulse *impulse = state;
    SpaceImpulseStep *step = &impulse->step;
    if (impulse_part_needs_step(&impulse->part)) {
        if (!space_impulse_step_take(step, err)) {
            return false;
        }
        space_impulse_means_find(step);
        impulse_part_begin(&impulse->part, &step->encounter, step->start_s);
    }
    take_part(impulse);
    return check_depths(impulse, err) ||
           stepping_fail(step->scenario, impulse->part.end_s, step->count, step->width_s, err);
}

static StepRecord space_impulse_record(const void *state)
{
    const SpaceImpulse *impulse = state;
    return impulse->part.record;
}

static void space_impulse_observe(const void *state, double time_s, Sample *sample)
{
    const SpaceImpulse *impulse = state;
    const SpaceImpulseStep *step = &impulse->step;
    const Linkage *linkage = &step->scenario->linkage;
    const double since_s = fmin(fmax(time_s - step->start_s, 0.0), step->width_s);
    const size_t node = encounter_node(&step->encounter, since_s);
    EncounterSums sums = impulse->sums; // which owns the arrays
    SpaceJoints joints = impulse->seen; // likewise
    encounter_at(&step->encounter, node, since_s, &sums);
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    space_impulse_step_inside(step, node, since_s, true, &sums, sample->space_bodies, &joints);
    for (size_t i = 0; i < linkage->body_count; i++) {
        sample->bodies[i] = space_planar(&sample->space_bodies[i]);
    }
    memcpy(sample->joints, joints.plane, linkage->joint_count * sizeof *sample->joints);
    memcpy(sample->space_joints, joints.space, linkage->joint_count * sizeof *sample->space_joints);
}

static SolverModel space_impulse_model(const void *state)
{
    const SpaceImpulse *impulse = state;
    SolverModel model = {
        .step_s = impulse->step.scenario->run.step,
        .constraint_rows = impulse->step.world.constraint_rows,
        .contact_rows = impulse->part.most_rows,
        .steps = impulse->step.count,
        .evaluations = impulse->step.encounter.evaluations,
    };
    stepping_label(impulse->step.scenario, "staggered", "impulse", model.label);
    return model;
}

static bool space_impulse_is_at_end(const void *state)
{
    const SpaceImpulse *impulse = state;
    return impulse->part.is_last;
}

static bool open_parts(const Scenario *scenario, void **state, Err *err)
{
    static const ImpulsePartsOf SPACE = {&SPACE_IMPULSE, space_impulse_is_at_end};
    return impulse_parts_open(scenario, &SPACE, state, err);
}

const Solver SPACE_IMPULSE_PARTS = {
    .name = "impulse",
    .open = open_parts,
    .step = impulse_parts_step,
    .record = impulse_parts_record,
    .observe = impulse_parts_observe,
    .model = impulse_parts_model,
    .close = impulse_parts_close,
};

const Solver SPACE_IMPULSE = {
    .name = "impulse",
    .open = space_impulse_open,
    .step = space_impulse_step,
    .record = space_impulse_record,
    .observe = space_impulse_observe,
    .model = space_impulse_model,
    .close = space_impulse_close,
};
