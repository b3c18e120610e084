// Steps a planar linkage in ODE with contacts integrated within the step: ode/impulse.c with the
// steps of ode/plane/impulse_step.c.
#include "ode/impulse.h"
#include "base/zeroed.h"
#include "model/independent.h"
#include "model/space_flat.h"
#include "ode/plane/impulse_step.h"
#include "ode/stepping.h"

#include <math.h>
#include <stdlib.h>

typedef struct PlaneImpulse {
    ImpulseStep step;
    Motion *motions; // by body; owned, as the arrays below
    JointState *joints;
    double *depths; // m, by place
    // of a linkage in space that never leaves the plane
    const Linkage *spatial; // else NULL
    Scenario flat;          // the same in the plane; owned
    SpaceJointState *space_joints;
} PlaneImpulse;

static bool plane_open(const Scenario *scenario, void **own, ImpulseView *view, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    PlaneImpulse *impulse = zeroed(1, sizeof *impulse);
    ImpulseStep *step = &impulse->step;
    *own = impulse;
    const Scenario *spatial = linkage->is_spatial ? scenario : NULL;
    if (spatial != NULL) {
        impulse->spatial = linkage;
        impulse->flat = space_flat_scenario(scenario);
        impulse->space_joints = zeroed(linkage->joint_count, sizeof *impulse->space_joints);
    }
    if (!impulse_step_init(spatial != NULL ? &impulse->flat : scenario, spatial, step, err)) {
        return false;
    }
    impulse->motions = zeroed(linkage->body_count, sizeof *impulse->motions);
    impulse->joints = zeroed(linkage->joint_count, sizeof *impulse->joints);
    impulse->depths = zeroed(step->place_count, sizeof *impulse->depths);
    *view = (ImpulseView){
        .scenario = scenario,
        .world = step->world.id,
        .constraint_rows = step->world.constraint_rows,
        .kernel = &step->scheme.kernel,
        .islands = step->scheme.islands,
        .groups = &step->groups,
        .whole = &step->whole,
        .depths = impulse->depths,
        .joints = impulse->joints,
        .space_joints = impulse->space_joints,
        .is_flat = spatial != NULL,
    };
    return true;
}

static void plane_close(void *own)
{
    PlaneImpulse *impulse = own;
    impulse_step_finish(&impulse->step);
    free(impulse->motions);
    free(impulse->joints);
    free(impulse->depths);
    free(impulse->space_joints);
    if (impulse->spatial != NULL) {
        scenario_free(&impulse->flat);
    }
    free(impulse);
}

static bool plane_take(void *own, ImpulseSpan *span, Err *err)
{
    PlaneImpulse *impulse = own;
    const ImpulseStep *step = &impulse->step;
    if (!impulse_step_take(&impulse->step, err)) {
        return false;
    }
    *span = (ImpulseSpan){step->scheme.start_s, step->scheme.end_s, step->scheme.width_s,
                          step->drive_work,     step->load_work,    step->damped,
                          step->rubbed};
    return true;
}

static void plane_look(void *own, const ImpulseScope *scope, ImpulseTime at, const KernelSums *sums,
                       double *omega, double *alpha)
{
    PlaneImpulse *impulse = own;
    impulse_step_inside(&impulse->step, scope, at, sums, impulse->motions, impulse->joints,
                        impulse->depths);
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        omega[i] = impulse->motions[i].omega;
        alpha[i] = impulse->motions[i].alpha;
    }
    if (impulse->spatial != NULL) {
        for (size_t n = 0; n < scope->joint_count; n++) {
            const size_t i = scope->joints[n];
            impulse->space_joints[i] =
                space_flat_joint(&impulse->spatial->joints[i], &impulse->joints[i]);
        }
    }
}

// Lifts what a scope has of a sample into space.
static void lift(const PlaneImpulse *impulse, const ImpulseScope *scope, bool wants_joints,
                 Sample *sample)
{
    if (impulse->spatial == NULL) {
        return;
    }
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        sample->space_bodies[i] =
            space_flat_motion(&impulse->spatial->bodies[i], &sample->bodies[i]);
        // in one turn, as space_planar has it
        sample->bodies[i].angle = remainder(sample->bodies[i].angle, 2.0 * M_PI);
    }
    for (size_t n = 0; n < scope->joint_count && wants_joints; n++) {
        const size_t i = scope->joints[n];
        sample->space_joints[i] =
            space_flat_joint(&impulse->spatial->joints[i], &sample->joints[i]);
    }
}

static void plane_observe(const void *own, ImpulseTime at, const KernelSums *sums, Sample *sample)
{
    const PlaneImpulse *impulse = own;
    impulse_step_inside(&impulse->step, &impulse->step.whole, at, sums, sample->bodies,
                        sample->joints, impulse->depths);
    lift(impulse, &impulse->step.whole, true, sample);
}

static void plane_observe_some(const void *own, const ImpulseScope *scope, ImpulseTime at,
                               const KernelSums *sums, bool wants_joints, Sample *sample)
{
    const PlaneImpulse *impulse = own;
    impulse_step_inside_some(&impulse->step, scope, at, sums, sample->bodies,
                             wants_joints ? sample->joints : NULL, impulse->depths);
    lift(impulse, scope, wants_joints, sample);
}

static double plane_mean(const void *own, size_t joint)
{
    const PlaneImpulse *impulse = own;
    return impulse->step.mean[joint].force;
}

// What lives on of few rows beside the scheme.
static void carry_few_rows(ImpulseStep *step, Carry *carry)
{
    const size_t rows = kernel_rows(&step->scheme.kernel);
    CARRY_ARRAY(carry, step->drift.rates, 3 * step->scenario->linkage.body_count * rows);
    CARRY_ARRAY(carry, step->drift.drift, rows * rows);
    impulse_curves_carry(&step->curves, carry);
}

static void impulse_step_carry(ImpulseStep *step, Carry *carry)
{
    const size_t bodies = step->scenario->linkage.body_count;
    world_carry(&step->world, carry);
    impulse_carry_scheme(&step->scheme, &step->ticks, carry);
    CARRY(carry, step->arms);
    CARRY_ARRAY(carry, step->middle, bodies);
    CARRY_ARRAY(carry, step->after, bodies);
    CARRY_ARRAY(carry, step->mean, step->scenario->linkage.joint_count);
    CARRY_ARRAY(carry, step->hold, step->scenario->linkage.joint_count);
    if (step->scheme.has_drift) {
        carry_few_rows(step, carry);
    }
    if (step->rubs.count > 0) {
        impulse_rubs_carry(&step->rubs, &step->scheme.kernel, carry);
    }
    if (carry->is_back && step->scheme.count > 0) {
        response_place(&step->response, step->middle);
    }
}

static void plane_carry(void *own, Carry *carry)
{
    PlaneImpulse *impulse = own;
    impulse_step_carry(&impulse->step, carry);
}

static int plane_place(const void *own, size_t place)
{
    const PlaneImpulse *impulse = own;
    return impulse->step.places[place].place;
}

const ImpulseKind IMPULSE_PLANE = {
    .open = plane_open,
    .close = plane_close,
    .take = plane_take,
    .look = plane_look,
    .observe = plane_observe,
    .observe_some = plane_observe_some,
    .mean = plane_mean,
    .carry = plane_carry,
    .place = plane_place,
};

static bool open_plane(const Scenario *scenario, void **state, Err *err)
{
    return impulse_open(&IMPULSE_PLANE, scenario, state, err);
}

const Solver STEPPING_IMPULSE = {
    .name = "impulse",
    .open = open_plane,
    .step = impulse_step,
    .record = impulse_record,
    .observe = impulse_observe,
    .observe_some = impulse_observe_some,
    .contacts = impulse_contacts,
    .carry = impulse_carry,
    .model = impulse_model,
    .close = impulse_close,
};

static bool open_plane_parts(const Scenario *scenario, void **state, Err *err)
{
    return impulse_parts_open(scenario, &STEPPING_IMPULSE, state, err);
}

const Solver STEPPING_IMPULSE_PARTS = {
    .name = "impulse",
    .open = open_plane_parts,
    .model = independent_model,
    INDEPENDENT_FUNCTIONS,
};
