// How does a linkage in space move in ODE if its contacts are integrated within the step? (The
// steps themselves: ode/space_impulse_step.c.)
//
// A step is handed on in parts, as in ode/impulse.c.
#include "contact/law.h"
#include "ode/marks.h"
#include "ode/space_impulse_means.h"
#include "ode/space_stepping.h"
#include "ode/stepping.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

typedef struct SpaceImpulse {
    SpaceImpulseStep step;
    Marks marks; // of it
    size_t most_rows;

    // the part of the step that is handed on
    double part_start_s;
    double part_end_s;
    EncounterSums sums; // at its end
    double omega[LINKAGE_BODY_MAX];
    double alpha[LINKAGE_BODY_MAX];
    SpaceJoints joints;
    double impulse[LINKAGE_JOINT_MAX];
    double approach[LINKAGE_JOINT_MAX];
    StepRecord record;
} SpaceImpulse;

static void space_impulse_close(void *state)
{
    SpaceImpulse *impulse = state;
    if (impulse != NULL) {
        marks_finish(&impulse->marks);
        space_impulse_step_finish(&impulse->step);
        free(impulse);
    }
}

static bool space_impulse_open(const Scenario *scenario, void **state, Err *err)
{
    SpaceImpulse *impulse = calloc(1, sizeof *impulse);
    assert(impulse != NULL);
    if (space_impulse_step_init(scenario, &impulse->step, err)) {
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
                             depth_at(impulse, i), 1.0, err)) {
            return false;
        }
    }
    return true;
}

// The impulses of the contacts in the part, by joint, and the speeds at which they began: of the
// end that touches since the shortest time.
static void sum_contacts(SpaceImpulse *impulse, uint32_t touching, const EncounterSums *before)
{
    const SpaceImpulseStep *step = &impulse->step;
    double since_s = 0.0;
    size_t rows = 0;
    for (size_t i = 0; i < step->place_count; i++) {
        const PinSpace *place = &step->places[i];
        const EncounterJoint *joint = &step->encounter.joints[i];
        const bool is_touching = (touching >> i & 1) != 0;
        if (is_touching) {
            impulse->record.elastic += force_law_energy(&place->law, depth_at(impulse, i));
            rows++;
        }
        if (place->place == PIN_SPACE_COLLAR) {
            continue;
        }
        const size_t row = joint->first_row;
        const double pushed = hypot(impulse->sums.impulse[row] - before->impulse[row],
                                    impulse->sums.impulse[row + 1] - before->impulse[row + 1]);
        double *const all = &impulse->impulse[place->joint];
        *all = place->place == 0 ? pushed : *all + pushed;
        const double touching_s = is_touching ? joint->touching_s : INFINITY;
        if (place->place == 0 || touching_s < since_s) {
            impulse->approach[place->joint] = joint->impact_speed;
            since_s = touching_s;
        }
    }
    impulse->most_rows = rows > impulse->most_rows ? rows : impulse->most_rows;
}

// Hands on the part of the step up to its next mark.
static void take_part(SpaceImpulse *impulse, const Mark *mark, const EncounterSums *before)
{
    const SpaceImpulseStep *step = &impulse->step;
    const Linkage *linkage = &step->scenario->linkage;
    SpaceMotion motions[LINKAGE_BODY_MAX];
    const bool is_peak = impulse->marks.next < impulse->marks.count;
    space_impulse_step_inside(step, mark->node, mark->time_s, is_peak, &impulse->sums, motions,
                              &impulse->joints);
    impulse->record = (StepRecord){
        .start_s = impulse->part_start_s,
        .end_s = impulse->part_end_s,
        .joint_s = impulse->part_end_s,
        .omega = impulse->omega,
        .alpha = impulse->alpha,
        .joints = impulse->joints.plane,
        .space_joints = impulse->joints.space,
        .impulse = impulse->impulse,
        .approach = impulse->approach,
        .dissipated = impulse->sums.dissipated - before->dissipated,
        .friction = impulse->sums.friction - before->friction,
    };
    for (size_t i = 0; i < linkage->body_count; i++) {
        impulse->omega[i] = motions[i].omega.z;
        impulse->alpha[i] = motions[i].alpha.z;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        impulse->impulse[i] =
            impulse->joints.plane[i].force * (impulse->part_end_s - impulse->part_start_s);
    }
    sum_contacts(impulse, step->encounter.touching[mark->node], before);
}

static bool space_impulse_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    SpaceImpulse *impulse = state;
    Marks *marks = &impulse->marks;
    EncounterSums before = impulse->sums;
    if (marks->next == marks->count) {
        if (!space_impulse_step_take(&impulse->step, err)) {
            return false;
        }
        space_impulse_means_find(&impulse->step);
        marks_find(marks, &impulse->step.encounter);
        memset(&before, 0, sizeof before);
        impulse->part_end_s = impulse->step.start_s;
    }
    const Mark *mark = &marks->marks[marks->next++];
    const bool is_last = marks->next == marks->count;
    impulse->part_start_s = impulse->part_end_s;
    impulse->part_end_s = is_last ? impulse->step.end_s : impulse->step.start_s + mark->time_s;
    encounter_at(&impulse->step.encounter, mark->node, mark->time_s, &impulse->sums);
    take_part(impulse, mark, &before);
    impulse->record.drive_work = is_last ? impulse->step.drive_work : 0.0;
    return check_depths(impulse, err) ||
           stepping_fail(impulse->step.scenario, impulse->part_end_s, impulse->step.count,
                         impulse->step.width_s, err);
}

static StepRecord space_impulse_record(const void *state)
{
    const SpaceImpulse *impulse = state;
    return impulse->record;
}

static void space_impulse_observe(const void *state, double time_s, Sample *sample)
{
    const SpaceImpulse *impulse = state;
    const SpaceImpulseStep *step = &impulse->step;
    const Linkage *linkage = &step->scenario->linkage;
    const double since_s = fmin(fmax(time_s - step->start_s, 0.0), step->width_s);
    const size_t node = encounter_node(&step->encounter, since_s);
    EncounterSums sums;
    SpaceJoints joints;
    encounter_at(&step->encounter, node, since_s, &sums);
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    space_impulse_step_inside(step, node, since_s, true, &sums, sample->space_bodies, &joints);
    for (size_t i = 0; i < linkage->body_count; i++) {
        sample->bodies[i] = space_planar(&sample->space_bodies[i]);
    }
    memcpy(sample->joints, joints.plane, sizeof sample->joints);
    memcpy(sample->space_joints, joints.space, sizeof sample->space_joints);
}

static SolverModel space_impulse_model(const void *state)
{
    const SpaceImpulse *impulse = state;
    SolverModel model = {
        .step_s = impulse->step.scenario->run.step,
        .constraint_rows = impulse->step.world.constraint_rows,
        .contact_rows = impulse->most_rows,
        .steps = impulse->step.count,
        .evaluations = impulse->step.encounter.evaluations,
    };
    stepping_label(impulse->step.scenario, "staggered", "impulse", model.label);
    return model;
}

const Solver SPACE_IMPULSE = {
    .name = "impulse",
    .open = space_impulse_open,
    .step = space_impulse_step,
    .record = space_impulse_record,
    .observe = space_impulse_observe,
    .model = space_impulse_model,
    .close = space_impulse_close,
};
