// Steps a planar linkage in ODE as its manual says.
//
// Plain stepping, step n from t = n h:
//     the driven body is put on its exact path at t, contacts are looked for there,
//     v' = v + h M^-1 (forces + J^T lambda),  x' = x + h v'      (dWorldStep or dWorldQuickStep)
//     read at the end: positions, omega at t + h; alpha = (omega' - omega) / h
// ODE is first order read like this. In between, positions and speeds are taken as linear; where a
// load jumps within a step, speeds are linear on each side, with the acceleration of the step
// before up to the jump. Where every joint is ideal the run starts `settle_steps` early: the joint
// rows lag behind the start by a share (1 - ERP)^n, which would stand in the accelerations at any
// step size.
#include "base/zeroed.h"
#include "model/loads.h"
#include "ode/plane/contact_rows.h"
#include "ode/stepping.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The mean accelerations of a body in a step.
typedef struct PlainRates {
    Vec2 velocity; // m/s^2
    double omega;  // rad/s^2
} PlainRates;

typedef struct Plain {
    const Scenario *scenario;
    World world;
    ContactRows contacts;
    double step_s;
    long index; // of the next step: it starts at index times step_s
    size_t steps;
    Snapshot *before;  // at the start of the last step; owned, as are the arrays below
    PlainRates *rates; // of the step before it
    double *omega;     // at its end
    double *alpha;
    JointState *joints;
    double *impulse;
    double *approach;
    Vec2 *offsets;       // by joint, to work with
    double drive_work;   // J, in the last step
    double rubbed;       // J, in the friction of ideal joints in the last step
    AppliedWork applied; // in the last step
} Plain;

static void plain_close(void *state)
{
    Plain *plain = state;
    if (plain == NULL) {
        return;
    }
    contact_rows_finish(&plain->contacts);
    world_finish(&plain->world);
    free(plain->before);
    free(plain->rates);
    free(plain->omega);
    free(plain->alpha);
    free(plain->joints);
    free(plain->impulse);
    free(plain->approach);
    free(plain->offsets);
    free(plain);
}

static void read_velocities(Plain *plain)
{
    for (size_t i = 0; i < plain->scenario->linkage.body_count; i++) {
        plain->omega[i] = dBodyGetAngularVel(plain->world.bodies[i])[2];
        plain->alpha[i] = (plain->omega[i] - plain->before[i].omega) / plain->step_s;
    }
    const double end_s = (double)(plain->index + 1) * plain->step_s;
    const Linkage *linkage = &plain->scenario->linkage;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const int body = linkage_drive_body(linkage, i);
        const DriveState drive = drive_at(linkage_drive(linkage, i), end_s);
        plain->omega[body] = drive.omega;
        plain->alpha[body] = drive.alpha;
    }
}

static PlainRates rates_between(const Snapshot *first, const Snapshot *last, double step_s)
{
    return (PlainRates){
        vec2_scale(1.0 / step_s, vec2_sub(last->velocity, first->velocity)),
        (last->omega - first->omega) / step_s,
    };
}

static bool advance_plain(Plain *plain, Err *err)
{
    const double start_s = (double)plain->index * plain->step_s;
    const Linkage *linkage = &plain->scenario->linkage;
    world_place_driven(&plain->world, start_s, start_s, 1);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Snapshot now = snapshot_of(plain->world.bodies[i]);
        plain->rates[i] = rates_between(&plain->before[i], &now, plain->step_s);
        plain->before[i] = now;
    }
    applied_push(&plain->world.applied, start_s, plain->step_s, APPLIED_AT_END, 1);
    Rubbing *rubbing = plain->world.rubbing.count > 0 ? &plain->world.rubbing : NULL;
    if (rubbing != NULL) {
        rubbing_push(rubbing, plain->step_s, APPLIED_AT_END);
    }
    const bool is_quick = plain->scenario->ode.solver == ODE_QUICK;
    if (!contact_rows_make(&plain->contacts, plain->step_s, plain->joints, plain->approach, err) ||
        !world_step(&plain->world, plain->step_s, is_quick, err)) {
        return stepping_fail(plain->scenario, start_s, plain->steps + 1, plain->step_s, err);
    }
    // friction comes from the joints' forces
    const bool is_lean = plain->scenario->run.is_lean && rubbing == NULL;
    if (!is_lean) {
        world_joint_forces(&plain->world, plain->joints);
    }
    contact_rows_clear(&plain->contacts, plain->step_s, plain->joints);
    read_velocities(plain);
    if (!is_lean) {
        plain->applied = applied_book(&plain->world.applied, plain->step_s);
        if (rubbing != NULL) {
            plain->rubbed =
                rubbing_book(rubbing, plain->step_s, plain->world.applied.loads, plain->joints);
        }
        plain->drive_work =
            contact_rows_drive_power(&plain->contacts, start_s, plain->offsets, plain->joints) *
                plain->step_s +
            plain->applied.torque + plain->applied.slope;
        if (rubbing != NULL) {
            rubbing_note(rubbing, plain->joints);
        }
    }
    for (size_t i = 0; i < plain->scenario->linkage.joint_count; i++) {
        plain->impulse[i] = plain->joints[i].force * plain->step_s;
    }
    if (!world_check(&plain->world, err)) {
        return stepping_fail(plain->scenario, start_s, plain->steps + 1, plain->step_s, err);
    }
    plain->index++;
    plain->steps++;
    return true;
}

// Takes the steps before time zero, with the first one asked for, so that they are timed with it.
static bool settle(Plain *plain, Err *err)
{
    while (plain->index < 0) {
        if (!advance_plain(plain, err)) {
            return false;
        }
    }
    return true;
}

static void make_plain(const Linkage *linkage, Plain *plain)
{
    plain->before = zeroed(linkage->body_count, sizeof *plain->before);
    plain->rates = zeroed(linkage->body_count, sizeof *plain->rates);
    plain->omega = zeroed(linkage->body_count, sizeof *plain->omega);
    plain->alpha = zeroed(linkage->body_count, sizeof *plain->alpha);
    plain->joints = zeroed(linkage->joint_count, sizeof *plain->joints);
    plain->impulse = zeroed(linkage->joint_count, sizeof *plain->impulse);
    plain->approach = zeroed(linkage->joint_count, sizeof *plain->approach);
    plain->offsets = zeroed(linkage->joint_count, sizeof *plain->offsets);
}

static bool plain_open(const Scenario *scenario, void **state, Err *err)
{
    Plain *plain = calloc(1, sizeof *plain);
    assert(plain != NULL);
    plain->scenario = scenario;
    plain->step_s = scenario->run.step;
    make_plain(&scenario->linkage, plain);
    Motion *motions = zeroed(scenario->linkage.body_count, sizeof *motions);
    plain->index =
        -stepping_start(scenario, plain->step_s, (long)scenario->ode.settle_steps, motions);
    const bool is_made = world_build(scenario, motions, &plain->world, err) &&
                         contact_rows_init(&plain->contacts, scenario, &plain->world, false, err);
    free(motions);
    if (!is_made) {
        plain_close(plain);
        return false;
    }
    for (size_t i = 0; scenario->run.is_lean && i < linkage_drive_count(&scenario->linkage); i++) {
        // it is put on its path at every step's start: only energies ask where a step leaves it
        dBodySetFiniteRotationMode(plain->world.bodies[linkage_drive_body(&scenario->linkage, i)],
                                   0);
    }
    *state = plain;
    return true;
}

static bool plain_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // a fixed step: the sample is looked up inside it
    return settle(state, err) && advance_plain(state, err);
}

static bool plain_carry(void *state, Carry *carry)
{
    Plain *plain = state;
    const Linkage *linkage = &plain->scenario->linkage;
    world_carry(&plain->world, carry);
    contact_rows_carry(&plain->contacts, carry);
    CARRY(carry, plain->index);
    CARRY(carry, plain->steps);
    CARRY_ARRAY(carry, plain->before, linkage->body_count);
    CARRY_ARRAY(carry, plain->rates, linkage->body_count);
    CARRY_ARRAY(carry, plain->joints, linkage->joint_count);
    return true;
}

static StepRecord plain_record(const void *state)
{
    const Plain *plain = state;
    const ContactEnergy energy = contact_rows_energy(&plain->contacts);
    return (StepRecord){
        .start_s = (double)(plain->index - 1) * plain->step_s,
        .end_s = (double)plain->index * plain->step_s,
        .joint_s = (double)(plain->index - 1) * plain->step_s,
        .is_mean = true,
        .omega = plain->omega,
        .alpha = plain->alpha,
        .joints = plain->joints,
        .impulse = plain->impulse,
        .approach = plain->approach,
        .drive_work = plain->drive_work,
        .load_work = plain->applied.loads,
        .dissipated = energy.dissipated + plain->applied.damping,
        .friction = energy.friction + plain->rubbed,
        .elastic = energy.elastic,
    };
}

// The motion at a share of the step between two snapshots.
static Motion between(const Snapshot *first, const Snapshot *last, double share, double step_s)
{
    const double turn = atan2(vec2_cross(first->direction, last->direction),
                              vec2_dot(first->direction, last->direction));
    const Vec2 moved = vec2_sub(last->position, first->position);
    const Vec2 change = vec2_sub(last->velocity, first->velocity);
    return (Motion){
        .position = vec2_add(first->position, vec2_scale(share, moved)),
        .angle = atan2(first->direction.y, first->direction.x) + share * turn,
        .velocity = vec2_add(first->velocity, vec2_scale(share, change)),
        .omega = first->omega + share * (last->omega - first->omega),
        .acceleration = vec2_scale(1.0 / step_s, change),
        .alpha = (last->omega - first->omega) / step_s,
    };
}

// When a load jumps within the last step, s after its start; 0: none does, or there is no step
// before.
static double plain_jump(const Plain *plain)
{
    const double start_s = (double)(plain->index - 1) * plain->step_s;
    const double rounding_s = STEPPING_ROUNDING * plain->step_s;
    const double jump_s =
        loads_next_jump(&plain->scenario->linkage, start_s + rounding_s) - start_s;
    return plain->steps > 1 && jump_s < plain->step_s - rounding_s ? jump_s : 0.0;
}

// Puts the rates of a body's motion onto their side of a jump.
static void plain_set_beside_jump(const Plain *plain, size_t body, double jump_s, double since_s,
                                  Motion *motion)
{
    const double step_s = plain->step_s;
    const Snapshot *first = &plain->before[body];
    const Snapshot last = world_snapshot(&plain->world, body);
    const PlainRates before = plain->rates[body];
    const PlainRates mean = rates_between(first, &last, step_s);
    const SteppingRate x =
        stepping_beside_jump(before.velocity.x, mean.velocity.x, jump_s, step_s, since_s);
    const SteppingRate y =
        stepping_beside_jump(before.velocity.y, mean.velocity.y, jump_s, step_s, since_s);
    const SteppingRate turning =
        stepping_beside_jump(before.omega, mean.omega, jump_s, step_s, since_s);
    motion->velocity = vec2_add(first->velocity, (Vec2){x.gain, y.gain});
    motion->acceleration = (Vec2){x.slope, y.slope};
    motion->omega = first->omega + turning.gain;
    motion->alpha = turning.slope;
}

static void plain_observe(const void *state, double time_s, Sample *sample)
{
    const Plain *plain = state;
    const Linkage *linkage = &plain->scenario->linkage;
    const double start_s = (double)(plain->index - 1) * plain->step_s;
    const double share = (time_s - start_s) / plain->step_s;
    const double jump_s = plain_jump(plain);
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Snapshot now = world_snapshot(&plain->world, i);
        Motion *motion = &sample->bodies[i];
        *motion = between(&plain->before[i], &now, share, plain->step_s);
        if (jump_s > 0.0) {
            plain_set_beside_jump(plain, i, jump_s, time_s - start_s, motion);
        }
        motion->angle = world_count_turns(&plain->world, i, motion->angle);
    }
    stepping_set_driven(linkage, time_s, sample->bodies);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        sample->joints[i] = plain->joints[i];
        stepping_observe_joint(linkage, i, sample);
    }
}

static void plain_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    contact_rows_states(&((const Plain *)state)->contacts, states);
}

static SolverModel plain_model(const void *state)
{
    const Plain *plain = state;
    SolverModel model = {
        .step_s = plain->step_s,
        .constraint_rows = plain->world.constraint_rows,
        .contact_rows = plain->contacts.most_rows,
        .fallback_rows = plain->contacts.fallback_count,
        .steps = plain->steps,
    };
    stepping_label(plain->scenario, "plain", OPTIONS_ODE_MAPS[plain->scenario->ode.map],
                   model.label);
    return model;
}

const Solver STEPPING_PLAIN = {
    .name = "plain",
    .open = plain_open,
    .step = plain_step,
    .record = plain_record,
    .observe = plain_observe,
    .contacts = plain_contacts,
    .carry = plain_carry,
    .model = plain_model,
    .close = plain_close,
};
