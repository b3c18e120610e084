// How does the linkage move in ODE, stepped as its manual says? (A solver.)
//
// Plain stepping, step n from t = n h:
//     the driven body is put on its exact path at t, contacts are looked for there,
//     v' = v + h M^-1 (forces + J^T lambda),  x' = x + h v'      (dWorldStep or dWorldQuickStep)
//     read at the end: positions, omega at t + h; alpha = (omega' - omega) / h
// ODE is first order read like this. In between, positions and speeds are taken as linear.
// Where every joint is ideal the run starts `settle_steps` early: the joint rows lag behind the
// start by a share (1 - ERP)^n, which would stand in the accelerations at any step size.
#include "ode/ode_solver.h"

#include "model/kinematics.h"
#include "ode/contact_rows.h"
#include "ode/engine.h"
#include "ode/world.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Ode {
    const Scenario *scenario;
    World world;
    ContactRows contacts;
    double step_s;
    long index; // of the next step: it starts at index times step_s
    size_t steps;
    int driven;                        // body, or LINKAGE_GROUND
    Snapshot before[LINKAGE_BODY_MAX]; // at the start of the last step
    double omega[LINKAGE_BODY_MAX];    // at its end
    double alpha[LINKAGE_BODY_MAX];
    JointState joints[LINKAGE_JOINT_MAX];
    double impulse[LINKAGE_JOINT_MAX];
    double approach[LINKAGE_JOINT_MAX];
    double drive_work; // J, in the last step
} Ode;

// The driven body turns about its joint with the ground: exact at any time.
static Motion driven_motion(const Ode *ode, double time_s)
{
    const Linkage *linkage = &ode->scenario->linkage;
    const Joint *joint = &linkage->joints[linkage->driver.joint];
    const double omega = linkage->driver.speed;
    Motion motion = {.angle = linkage_crank_angle(linkage, time_s), .omega = omega};
    const Vec2 arm = vec2_scale(-1.0, vec2_rotate(motion.angle, joint->anchor_b));
    motion.position = vec2_add(joint->anchor_a, arm);
    motion.velocity = vec2_scale(omega, vec2_perp(arm));
    motion.acceleration = vec2_scale(-omega * omega, arm);
    return motion;
}

// Where the bodies stand at the start of the run, at most so many steps before time zero: fewer
// where the linkage does not close that far back. Returns the number of those steps.
static long start_motions(const Scenario *scenario, long settle_steps, Motion *motions)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i] = linkage->bodies[i].start;
    }
    // step by step backwards, so that the loop stays closed the same way round
    for (long back = 1; back <= settle_steps; back++) {
        Err unused = {ERR_NONE, ""};
        const double time_s = -(double)back * scenario->run.step;
        if (!kinematics_solve(linkage, linkage_crank_angle(linkage, time_s), motions, &unused)) {
            return back - 1;
        }
    }
    return settle_steps;
}

static void ode_close(void *state)
{
    Ode *ode = state;
    if (ode == NULL) {
        return;
    }
    contact_rows_finish(&ode->contacts);
    world_finish(&ode->world);
    free(ode);
}

// Time and crank angle in front of what went wrong there.
static bool fail_at(const Ode *ode, double time_s, Err *err)
{
    char where[128];
    const double crank = linkage_crank_angle(&ode->scenario->linkage, time_s) * 180.0 / M_PI;
    snprintf(where, sizeof where, "at %.6g ms, crank angle %.5g deg, step %zu of %.4g us",
             1e3 * time_s, crank, ode->steps + 1, 1e6 * ode->step_s);
    err_prefix(err, where);
    return false;
}

// Numbers must stay finite, and the plane is only kept while nothing ever leaves it.
static bool check_state(const Ode *ode, Err *err)
{
    const Linkage *linkage = &ode->scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const dReal *velocity = dBodyGetLinearVel(ode->world.bodies[i]);
        const dReal *omega = dBodyGetAngularVel(ode->world.bodies[i]);
        if (!isfinite(velocity[0] + velocity[1] + omega[2])) {
            return err_set(err, ERR_SOLVER, "the velocity of the %s is no longer finite",
                           linkage->bodies[i].name);
        }
        if (velocity[2] != 0.0 || omega[0] != 0.0 || omega[1] != 0.0) {
            return err_set(err, ERR_SOLVER, "the %s has left the plane", linkage->bodies[i].name);
        }
    }
    return true;
}

static void read_velocities(Ode *ode)
{
    for (size_t i = 0; i < ode->scenario->linkage.body_count; i++) {
        ode->omega[i] = dBodyGetAngularVel(ode->world.bodies[i])[2];
        ode->alpha[i] = (ode->omega[i] - ode->before[i].omega) / ode->step_s;
    }
    if (ode->driven >= 0) {
        ode->omega[ode->driven] = ode->scenario->linkage.driver.speed;
        ode->alpha[ode->driven] = 0.0;
    }
}

static void read_ideal_forces(Ode *ode)
{
    const Linkage *linkage = &ode->scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint->kind == JOINT_REVOLUTE) {
            // ODE gives the force on the first body attached: a, if it is no ground
            const double sign = joint->body_a != LINKAGE_GROUND ? -1.0 : 1.0;
            const dReal *force = ode->world.feedback[i].f1;
            ode->joints[i].force_on_b = (Vec2){sign * force[0], sign * force[1]};
            ode->joints[i].force = vec2_length(ode->joints[i].force_on_b);
        }
    }
}

// The driven body's own equations give the force in its joint and the work of the drive: all other
// forces on it are known.
static void find_drive(Ode *ode, const Motion *driven)
{
    const Linkage *linkage = &ode->scenario->linkage;
    if (ode->driven < 0) {
        return;
    }
    const double mass = linkage->bodies[ode->driven].mass;
    const Vec2 needed =
        vec2_scale(mass, vec2_add(driven->acceleration, (Vec2){0.0, ode->scenario->gravity}));
    Vec2 others = {0.0, 0.0};
    double power = vec2_dot(needed, driven->velocity);
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool is_on_a = joint->body_a == ode->driven;
        if (i == linkage->driver.joint || (!is_on_a && joint->body_b != ode->driven)) {
            continue;
        }
        const Vec2 force = vec2_scale(is_on_a ? -1.0 : 1.0, ode->joints[i].force_on_b);
        const Vec2 anchor = vec2_rotate(driven->angle, is_on_a ? joint->anchor_a : joint->anchor_b);
        const Vec2 arm = vec2_add(anchor, contact_rows_offset(&ode->contacts, i, is_on_a));
        const Vec2 velocity = vec2_add(driven->velocity, vec2_scale(driven->omega, vec2_perp(arm)));
        others = vec2_add(others, force);
        power -= vec2_dot(force, velocity);
    }
    JointState *drive = &ode->joints[linkage->driver.joint];
    drive->force_on_b = vec2_sub(needed, others);
    drive->force = vec2_length(drive->force_on_b);
    ode->drive_work = power * ode->step_s;
}

static bool advance(Ode *ode, Err *err)
{
    const double start_s = (double)ode->index * ode->step_s;
    Motion driven = {.angle = 0.0};
    if (ode->driven >= 0) {
        driven = driven_motion(ode, start_s);
        world_place(&ode->world, (size_t)ode->driven, &driven);
    }
    for (size_t i = 0; i < ode->scenario->linkage.body_count; i++) {
        ode->before[i] = world_snapshot(&ode->world, i);
    }
    const bool is_quick = ode->scenario->ode.solver == ODE_QUICK;
    if (!contact_rows_make(&ode->contacts, ode->step_s, ode->joints, ode->approach, err) ||
        !engine_step(ode->world.id, ode->step_s, is_quick, err)) {
        return fail_at(ode, start_s, err);
    }
    contact_rows_clear(&ode->contacts, ode->step_s, ode->joints);
    read_velocities(ode);
    read_ideal_forces(ode);
    find_drive(ode, &driven);
    for (size_t i = 0; i < ode->scenario->linkage.joint_count; i++) {
        ode->impulse[i] = ode->joints[i].force * ode->step_s;
    }
    if (!check_state(ode, err)) {
        return fail_at(ode, start_s, err);
    }
    ode->index++;
    ode->steps++;
    return true;
}

// Takes the steps before time zero, with the first one asked for, so that they are timed with it.
static bool settle(Ode *ode, Err *err)
{
    while (ode->index < 0) {
        if (!advance(ode, err)) {
            return false;
        }
    }
    return true;
}

static bool ode_open(const Scenario *scenario, void **state, Err *err)
{
    Ode *ode = calloc(1, sizeof *ode);
    assert(ode != NULL);
    ode->scenario = scenario;
    ode->step_s = scenario->run.step;
    ode->driven = linkage_driven_body(&scenario->linkage);
    const bool is_driven_wholly = ode->driven >= 0 && !scenario_has_clearance(scenario);
    Motion motions[LINKAGE_BODY_MAX];
    ode->index =
        -start_motions(scenario, is_driven_wholly ? (long)scenario->ode.settle_steps : 0, motions);
    if (world_build(scenario, motions, &ode->world, err) &&
        contact_rows_init(&ode->contacts, scenario, &ode->world, err)) {
        *state = ode;
        return true;
    }
    ode_close(ode);
    return false;
}

static bool ode_step(void *state, double stop_s, Err *err)
{
    (void)stop_s; // a fixed step: the sample is looked up inside it
    return settle(state, err) && advance(state, err);
}

static StepRecord ode_record(const void *state)
{
    const Ode *ode = state;
    StepRecord record = {
        .start_s = (double)(ode->index - 1) * ode->step_s,
        .end_s = (double)ode->index * ode->step_s,
        .joint_s = (double)(ode->index - 1) * ode->step_s,
        .omega = ode->omega,
        .alpha = ode->alpha,
        .joints = ode->joints,
        .impulse = ode->impulse,
        .approach = ode->approach,
        .drive_work = ode->drive_work,
    };
    for (size_t i = 0; i < ode->world.pair_count; i++) {
        record.dissipated += ode->contacts.rows[i].dissipated;
        record.friction += ode->contacts.rows[i].friction;
        record.elastic += ode->contacts.rows[i].elastic;
    }
    return record;
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

static void observe_joint(const Ode *ode, size_t number, Sample *sample)
{
    const Joint *joint = &ode->scenario->linkage.joints[number];
    const Vec2 hole = linkage_point(sample->bodies, joint->body_a, joint->anchor_a);
    const Vec2 pin = linkage_point(sample->bodies, joint->body_b, joint->anchor_b);
    const bool is_ideal = joint->kind == JOINT_REVOLUTE;
    JointState *state = &sample->joints[number];
    *state = ode->joints[number];
    state->eccentricity = vec2_sub(pin, hole);
    state->gap =
        is_ideal ? 0.0 : linkage_radial_clearance(joint) - vec2_length(state->eccentricity);
    state->is_touching = is_ideal || state->gap < 0.0;
}

static void ode_observe(const void *state, double time_s, Sample *sample)
{
    const Ode *ode = state;
    const Linkage *linkage = &ode->scenario->linkage;
    const double start_s = (double)(ode->index - 1) * ode->step_s;
    const double share = (time_s - start_s) / ode->step_s;
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Snapshot now = world_snapshot(&ode->world, i);
        sample->bodies[i] = between(&ode->before[i], &now, share, ode->step_s);
    }
    if (ode->driven >= 0) {
        sample->bodies[ode->driven] = driven_motion(ode, time_s);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        observe_joint(ode, i, sample);
    }
}

static SolverModel ode_model(const void *state)
{
    const Ode *ode = state;
    const OdeOptions *options = &ode->scenario->ode;
    SolverModel model = {
        .step_s = ode->step_s,
        .constraint_rows = ode->world.constraint_rows,
        .contact_rows = ode->contacts.most_rows,
        .steps = ode->steps,
    };
    const char *map = ode->scenario->contact.model == CONTACT_POISSON
                          ? "poisson"
                          : OPTIONS_ODE_MAPS[options->map];
    snprintf(model.label, sizeof model.label, "ode %s/%s/%s", OPTIONS_ODE_SOLVERS[options->solver],
             OPTIONS_ODE_STEPPINGS[options->stepping],
             scenario_has_clearance(ode->scenario) ? map : "ideal");
    return model;
}

const Solver ODE_SOLVER = {
    .name = "ode",
    .summary = "Open Dynamics Engine",
    .open = ode_open,
    .step = ode_step,
    .record = ode_record,
    .observe = ode_observe,
    .model = ode_model,
    .close = ode_close,
};
