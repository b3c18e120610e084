// How does a linkage in space move in ODE if its contacts are integrated within the step? (The
// steps themselves: ode/space/space_impulse_step.c.)
//
// A step is handed on in parts (ode/impulse_part.c).
#include "base/zeroed.h"
#include "contact/law.h"
#include "ode/impulse_islands.h"
#include "ode/impulse_parts.h"
#include "ode/space/space_impulse_step.h"
#include "ode/stepping.h"

#include <string.h>

typedef struct SpaceImpulse {
    SpaceImpulseStep step;
    ImpulsePart part;        // of it, the one that is handed on
    ImpulseIslands *islands; // where the step has them; owned
    SpaceJoints joints;
    SpaceJoints seen;     // at the time that is asked for
    SpaceMotion *motions; // owned, like the next two
    double *depths;       // m, by place
    bool *are_ends;       // whether a place is one, and no collar
    KernelSums sums;      // at the time that is asked for
} SpaceImpulse;

static void space_impulse_close(void *state)
{
    SpaceImpulse *impulse = state;
    if (impulse != NULL) {
        impulse_part_finish(&impulse->part);
        impulse_islands_destroy(impulse->islands);
        space_impulse_step_finish(&impulse->step);
        kernel_sums_free(&impulse->sums);
        space_joints_free(&impulse->joints);
        space_joints_free(&impulse->seen);
        free(impulse->motions);
        free(impulse->depths);
        free(impulse->are_ends);
        free(impulse);
    }
}

// How deep the pin is at a place at the time that was looked at last, m.
static double depth_at(const SpaceImpulse *impulse, size_t place)
{
    const StopSpace *stop = space_impulse_step_stop(&impulse->step, place);
    if (stop != NULL) {
        return -stop_space_gap(stop, impulse->joints.plane[stop->joint].tilt);
    }
    const PinSpace *of = &impulse->step.places[place];
    const SpaceJointState *state = &impulse->joints.space[of->joint];
    return of->place == PIN_SPACE_COLLAR ? fabs(state->axial) - of->clearance
                                         : -state->end_gaps[of->place];
}

// Looks at a scope of the step, and tells how its bodies turn.
static void look_inside(void *context, const ImpulseScope *scope, ImpulseTime at,
                        const KernelSums *sums)
{
    SpaceImpulse *impulse = context;
    space_impulse_step_inside(&impulse->step, scope, at, sums, impulse->motions, &impulse->joints);
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        impulse->part.omega[i] = impulse->motions[i].omega.z;
        impulse->part.alpha[i] = impulse->motions[i].alpha.z;
    }
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        impulse->depths[i] = depth_at(impulse, i);
    }
}

static ImpulseSpan span_of(const void *context)
{
    const SpaceImpulse *impulse = context;
    const SpaceImpulseStep *step = &impulse->step;
    return (ImpulseSpan){step->start_s, step->end_s, step->width_s, step->drive_work, 0.0};
}

static double mean_of(const void *context, size_t joint)
{
    const SpaceImpulse *impulse = context;
    return linkage_is_ideal(&impulse->step.scenario->linkage, joint)
               ? vec3_length(impulse->step.mean[joint])
               : impulse->joints.plane[joint].force;
}

static ImpulseIslands *open_islands(SpaceImpulse *impulse)
{
    const SpaceImpulseStep *step = &impulse->step;
    return impulse_islands_create(&(ImpulseIslandsOf){
        .linkage = &step->scenario->linkage,
        .islands = step->islands,
        .groups = &step->groups,
        .whole = &step->whole,
        .counts = impulse->are_ends,
        .depths = impulse->depths,
        .joints = impulse->joints.plane,
        .space_joints = impulse->joints.space,
        .context = impulse,
        .span = span_of,
        .inside = look_inside,
        .mean = mean_of,
    });
}

static bool space_impulse_open(const Scenario *scenario, void **state, Err *err)
{
    SpaceImpulse *impulse = zeroed(1, sizeof *impulse);
    if (space_impulse_step_init(scenario, &impulse->step, err)) {
        const size_t places = impulse->step.place_count;
        const size_t rows = kernel_rows(&impulse->step.kernel);
        impulse_part_init(&impulse->part, &scenario->linkage, rows);
        impulse->sums = kernel_sums(rows);
        impulse->joints = space_joints_create(&scenario->linkage);
        impulse->seen = space_joints_create(&scenario->linkage);
        impulse->motions = zeroed(scenario->linkage.body_count, sizeof *impulse->motions);
        impulse->depths = zeroed(places, sizeof *impulse->depths);
        impulse->are_ends = zeroed(places, sizeof *impulse->are_ends);
        for (size_t i = 0; i < places; i++) {
            impulse->are_ends[i] =
                i >= impulse->step.pin_count || impulse->step.places[i].place != PIN_SPACE_COLLAR;
        }
        if (impulse->step.islands != NULL) {
            impulse->islands = open_islands(impulse);
        }
        *state = impulse;
        return true;
    }
    space_impulse_close(impulse);
    return false;
}

static bool check_depths(const SpaceImpulse *impulse, Err *err)
{
    const SpaceImpulseStep *step = &impulse->step;
    const ImpulseScope *scope =
        impulse->islands != NULL ? impulse_islands_scope(impulse->islands) : &step->whole;
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        const KernelContact *place = &step->kernel.contacts[i];
        if (!law_check_depth(&place->law, &step->scenario->linkage.joints[place->joint],
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
    ImpulsePart *part = &impulse->part;
    const Mark *mark = impulse_part_next(part, &step->kernel, step->start_s, step->end_s);
    const ImpulseTime at = {mark->time_s, mark->node, !part->is_last};
    look_inside(impulse, &step->whole, at, &part->sums);
    impulse_part_record(part, &step->scenario->linkage, impulse->joints.plane);
    part->record.space_joints = impulse->joints.space;
    impulse_part_add_contacts(part, &step->kernel, mark, impulse->depths, impulse->are_ends);
    part->record.drive_work = part->is_last ? step->drive_work : 0.0;
}

// Takes the next step and begins to hand it on.
static bool begin_step_of(SpaceImpulse *impulse, Err *err)
{
    SpaceImpulseStep *step = &impulse->step;
    if (!space_impulse_step_take(step, err)) {
        return false;
    }
    space_impulse_means_find(step);
    if (impulse->islands != NULL) {
        impulse_islands_begin(impulse->islands, &impulse->part);
    } else {
        impulse_part_begin(&impulse->part, &step->kernel, step->start_s);
    }
    return true;
}

static bool space_impulse_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // samples are looked up inside the step
    SpaceImpulse *impulse = state;
    const SpaceImpulseStep *step = &impulse->step;
    const bool needs_step = impulse->islands != NULL ? impulse_islands_need_step(impulse->islands)
                                                     : impulse_part_needs_step(&impulse->part);
    if (needs_step && !begin_step_of(impulse, err)) {
        return false;
    }
    if (impulse->islands != NULL) {
        impulse_islands_next(impulse->islands, &impulse->part);
    } else {
        take_part(impulse);
    }
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
    ImpulseTime at = {since_s, 0, true};
    KernelSums sums = impulse->sums;    // which owns the arrays
    SpaceJoints joints = impulse->seen; // likewise
    if (step->islands != NULL) {
        kernel_islands_look(step->islands, since_s, &sums);
    } else {
        at.node = kernel_node(&step->kernel, since_s);
        kernel_at(&step->kernel, at.node, since_s, &sums);
    }
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    space_impulse_step_inside(step, &step->whole, at, &sums, sample->space_bodies, &joints);
    for (size_t i = 0; i < linkage->body_count; i++) {
        sample->bodies[i] = space_planar(&sample->space_bodies[i]);
    }
    memcpy(sample->joints, joints.plane, linkage->joint_count * sizeof *sample->joints);
    memcpy(sample->space_joints, joints.space, linkage->joint_count * sizeof *sample->space_joints);
}

static void space_impulse_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    const SpaceImpulseStep *step = &((const SpaceImpulse *)state)->step;
    for (size_t i = 0; i < step->place_count; i++) {
        const StopSpace *stop = space_impulse_step_stop(step, i);
        const int place = stop != NULL ? stop_space_place(stop) : step->places[i].place;
        states[space_impulse_step_joint(step, i)][place] = step->kernel.contacts[i].state;
    }
}

static SolverModel space_impulse_model(const void *state)
{
    const SpaceImpulse *impulse = state;
    SolverModel model = {
        .step_s = impulse->step.scenario->run.step,
        .constraint_rows = impulse->step.world.constraint_rows,
        .contact_rows = impulse->part.most_rows,
        .steps = impulse->step.count,
        .evaluations = impulse->step.kernel.evaluations,
    };
    stepping_label(impulse->step.scenario, "staggered", "impulse", model.label);
    return model;
}

static dWorldID space_impulse_world(const void *state)
{
    const SpaceImpulse *impulse = state;
    return impulse->step.world.id;
}

static bool open_parts(const Scenario *scenario, void **state, Err *err)
{
    return impulse_parts_open(scenario, &SPACE_IMPULSE, space_impulse_world, state, err);
}

const Solver SPACE_IMPULSE_PARTS = {
    .name = "impulse",
    .open = open_parts,
    .step = several_step,
    .record = several_record,
    .observe = several_observe,
    .observe_part = several_observe_part,
    .contacts = several_contacts,
    .model = several_model,
    .close = several_close,
};

const Solver SPACE_IMPULSE = {
    .name = "impulse",
    .open = space_impulse_open,
    .step = space_impulse_step,
    .record = space_impulse_record,
    .observe = space_impulse_observe,
    .contacts = space_impulse_contacts,
    .model = space_impulse_model,
    .close = space_impulse_close,
};
