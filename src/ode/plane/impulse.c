// Steps a planar linkage in ODE with contacts integrated within the step: ode/impulse.c with the
// steps of ode/plane/impulse_step.c.
#include "ode/impulse.h"
#include "base/zeroed.h"
#include "model/independent.h"
#include "ode/plane/impulse_step.h"
#include "ode/stepping.h"

#include <stdlib.h>

typedef struct PlaneImpulse {
    ImpulseStep step;
    Motion *motions; // by body; owned, as the next two
    JointState *joints;
    double *depths; // m, by place
} PlaneImpulse;

static bool plane_open(const Scenario *scenario, void **own, ImpulseView *view, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    PlaneImpulse *impulse = zeroed(1, sizeof *impulse);
    ImpulseStep *step = &impulse->step;
    *own = impulse;
    if (!impulse_step_init(scenario, step, err)) {
        return false;
    }
    impulse->motions = zeroed(linkage->body_count, sizeof *impulse->motions);
    impulse->joints = zeroed(linkage->joint_count, sizeof *impulse->joints);
    impulse->depths = zeroed(step->place_count, sizeof *impulse->depths);
    *view = (ImpulseView){
        .scenario = scenario,
        .world = step->world.id,
        .constraint_rows = step->world.constraint_rows,
        .kernel = &step->kernel,
        .islands = step->islands,
        .groups = &step->groups,
        .whole = &step->whole,
        .depths = impulse->depths,
        .joints = impulse->joints,
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
    free(impulse);
}

static bool plane_take(void *own, ImpulseSpan *span, Err *err)
{
    PlaneImpulse *impulse = own;
    const ImpulseStep *step = &impulse->step;
    if (!impulse_step_take(&impulse->step, err)) {
        return false;
    }
    *span = (ImpulseSpan){step->start_s,    step->end_s,     step->width_s,
                          step->drive_work, step->load_work, step->damped};
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
}

static void plane_observe(const void *own, ImpulseTime at, const KernelSums *sums, Sample *sample)
{
    const PlaneImpulse *impulse = own;
    impulse_step_inside(&impulse->step, &impulse->step.whole, at, sums, sample->bodies,
                        sample->joints, impulse->depths);
}

static void plane_observe_some(const void *own, const ImpulseScope *scope, ImpulseTime at,
                               const KernelSums *sums, bool wants_joints, Sample *sample)
{
    const PlaneImpulse *impulse = own;
    impulse_step_inside_some(&impulse->step, scope, at, sums, sample->bodies,
                             wants_joints ? sample->joints : NULL, impulse->depths);
}

static double plane_mean(const void *own, size_t joint)
{
    const PlaneImpulse *impulse = own;
    return impulse->step.mean[joint].force;
}

static void carry_few_rows(ImpulseStep *step, Carry *carry)
{
    const size_t count = 3 * step->scenario->linkage.body_count * kernel_rows(&step->kernel);
    for (size_t i = 0; i < IMPULSE_COLUMNS; i++) {
        CARRY_ARRAY(carry, step->columns[i], count);
    }
    CARRY(carry, step->middles_s);
    CARRY_ARRAY(carry, step->drift.rates, count);
    CARRY_ARRAY(carry, step->drift.drift, kernel_rows(&step->kernel) * kernel_rows(&step->kernel));
    impulse_curves_carry(&step->curves, carry);
}

static void impulse_step_carry(ImpulseStep *step, Carry *carry)
{
    const size_t bodies = step->scenario->linkage.body_count;
    world_carry(&step->world, carry);
    impulse_carry_contacts(step->islands, &step->kernel, &step->tick, carry);
    CARRY(carry, step->is_kink);
    CARRY(carry, step->end_s);
    CARRY(carry, step->count);
    CARRY(carry, step->start_s);
    CARRY(carry, step->width_s);
    CARRY(carry, step->arms);
    CARRY(carry, step->steady);
    CARRY(carry, step->is_calm);
    CARRY_ARRAY(carry, step->middle, bodies);
    CARRY_ARRAY(carry, step->after, bodies);
    CARRY_ARRAY(carry, step->free, 3 * bodies);
    CARRY_ARRAY(carry, step->free_rate, 3 * bodies);
    CARRY_ARRAY(carry, step->total.impulse, kernel_rows(&step->kernel));
    CARRY_ARRAY(carry, step->mean, step->scenario->linkage.joint_count);
    if (step->has_few_rows) {
        carry_few_rows(step, carry);
    }
    if (carry->is_back && step->count > 0) {
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

static const ImpulseKind PLANE_KIND = {
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
    return impulse_open(&PLANE_KIND, scenario, state, err);
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
