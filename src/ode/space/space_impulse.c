// Steps a linkage in space in ODE with contacts integrated within the step: ode/impulse.c with the
// steps of ode/space/space_impulse_step.c.
#include "base/zeroed.h"
#include "model/independent.h"
#include "model/space_flat.h"
#include "ode/impulse.h"
#include "ode/space/space_impulse_step.h"
#include "ode/stepping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct SpaceImpulse {
    SpaceImpulseStep step;
    SpaceJoints joints;
    SpaceJoints seen;     // at the time that is asked for
    SpaceMotion *motions; // owned, like the next two
    double *depths;       // m, by place
    bool *are_ends;       // whether a place is one, and no collar
} SpaceImpulse;

static bool space_open(const Scenario *scenario, void **own, ImpulseView *view, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    SpaceImpulse *impulse = zeroed(1, sizeof *impulse);
    SpaceImpulseStep *step = &impulse->step;
    *own = impulse;
    if (!space_impulse_step_init(scenario, step, err)) {
        return false;
    }
    impulse->joints = space_joints_create(linkage);
    impulse->seen = space_joints_create(linkage);
    impulse->motions = zeroed(linkage->body_count, sizeof *impulse->motions);
    impulse->depths = zeroed(step->place_count, sizeof *impulse->depths);
    impulse->are_ends = zeroed(step->place_count, sizeof *impulse->are_ends);
    for (size_t i = 0; i < step->place_count; i++) {
        impulse->are_ends[i] = i >= step->pin_count || step->places[i].place != PIN_SPACE_COLLAR;
    }
    *view = (ImpulseView){
        .scenario = scenario,
        .world = step->world.id,
        .constraint_rows = step->world.constraint_rows,
        .kernel = &step->scheme.kernel,
        .islands = step->scheme.islands,
        .groups = &step->groups,
        .whole = &step->whole,
        .counts = impulse->are_ends,
        .depths = impulse->depths,
        .joints = impulse->joints.plane,
        .space_joints = impulse->joints.space,
    };
    return true;
}

static void space_close(void *own)
{
    SpaceImpulse *impulse = own;
    space_impulse_step_finish(&impulse->step);
    space_joints_free(&impulse->joints);
    space_joints_free(&impulse->seen);
    free(impulse->motions);
    free(impulse->depths);
    free(impulse->are_ends);
    free(impulse);
}

static bool space_take(void *own, ImpulseSpan *span, Err *err)
{
    SpaceImpulse *impulse = own;
    const SpaceImpulseStep *step = &impulse->step;
    if (!space_impulse_step_take(&impulse->step, err)) {
        return false;
    }
    *span = (ImpulseSpan){
        .start_s = step->scheme.start_s,
        .end_s = step->scheme.end_s,
        .width_s = step->scheme.width_s,
        .drive_work = step->drive_work,
    };
    return true;
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

static void space_look(void *own, const ImpulseScope *scope, ImpulseTime at, const KernelSums *sums,
                       double *omega, double *alpha)
{
    SpaceImpulse *impulse = own;
    space_impulse_step_inside(&impulse->step, scope, at, sums, impulse->motions, &impulse->joints);
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        omega[i] = impulse->motions[i].omega.z;
        alpha[i] = impulse->motions[i].alpha.z;
    }
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        impulse->depths[i] = depth_at(impulse, i);
    }
}

static void space_observe(const void *own, ImpulseTime at, const KernelSums *sums, Sample *sample)
{
    const SpaceImpulse *impulse = own;
    const SpaceImpulseStep *step = &impulse->step;
    const Linkage *linkage = &step->scenario->linkage;
    SpaceJoints joints = impulse->seen; // which owns the arrays
    space_impulse_step_inside(step, &step->whole, at, sums, sample->space_bodies, &joints);
    for (size_t i = 0; i < linkage->body_count; i++) {
        sample->bodies[i] = space_planar(&sample->space_bodies[i]);
    }
    memcpy(sample->joints, joints.plane, linkage->joint_count * sizeof *sample->joints);
    memcpy(sample->space_joints, joints.space, linkage->joint_count * sizeof *sample->space_joints);
}

static double space_mean(const void *own, size_t joint)
{
    const SpaceImpulse *impulse = own;
    return linkage_is_ideal(&impulse->step.scenario->linkage, joint)
               ? vec3_length(impulse->step.mean[joint])
               : impulse->joints.plane[joint].force;
}

static void space_impulse_step_carry(SpaceImpulseStep *step, Carry *carry)
{
    const Linkage *linkage = &step->scenario->linkage;
    world_carry(&step->world, carry);
    impulse_carry_scheme(&step->scheme, &step->ticks, carry);
    CARRY_ARRAY(carry, step->angles, linkage->joint_count);
    CARRY_ARRAY(carry, step->after, linkage->body_count);
    CARRY_ARRAY(carry, step->gyration, linkage->body_count);
}

static void space_carry(void *own, Carry *carry)
{
    SpaceImpulse *impulse = own;
    space_impulse_step_carry(&impulse->step, carry);
}

static int space_place(const void *own, size_t place)
{
    const SpaceImpulse *impulse = own;
    const StopSpace *stop = space_impulse_step_stop(&impulse->step, place);
    return stop != NULL ? stop_space_place(stop) : (int)impulse->step.places[place].place;
}

static const ImpulseKind SPACE_KIND = {
    .open = space_open,
    .close = space_close,
    .take = space_take,
    .look = space_look,
    .observe = space_observe,
    .mean = space_mean,
    .carry = space_carry,
    .place = space_place,
};

static bool open_space(const Scenario *scenario, void **state, Err *err)
{
    Err redundant = {0};
    if (space_flat_is(scenario) && impulse_open(&IMPULSE_PLANE, scenario, state, &redundant)) {
        return true;
    }
    // what cannot be solved is said with the words of space
    return impulse_open(&SPACE_KIND, scenario, state, err);
}

const Solver SPACE_IMPULSE = {
    .name = "impulse",
    .open = open_space,
    .step = impulse_step,
    .record = impulse_record,
    .observe = impulse_observe,
    .observe_some = impulse_observe_some,
    .contacts = impulse_contacts,
    .carry = impulse_carry,
    .model = impulse_model,
    .close = impulse_close,
};

static bool open_space_parts(const Scenario *scenario, void **state, Err *err)
{
    return impulse_parts_open(scenario, &SPACE_IMPULSE, state, err);
}

const Solver SPACE_IMPULSE_PARTS = {
    .name = "impulse",
    .open = open_space_parts,
    .model = independent_model,
    INDEPENDENT_FUNCTIONS,
};
