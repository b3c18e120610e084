// How is a planar linkage built in a three-dimensional engine with as few rows as it needs?
//
// Every centre of mass, anchor and force lies in the plane z = 0 and every axis along z. Then
// nothing in the equations reaches z, omega_x or omega_y: they stay zero to the last bit, and no
// row has to hold them. An ideal joint is a ball (3 rows, its z row idle), a driven body is
// kinematic (no rows), a prismatic joint has two rows (ode/sliding.c), and a joint with play is
// nothing but a contact row while it touches.
// Four hinges in a loop would be 20 rows on 18 freedoms, which ODE cannot solve with CFM 0.
#include "ode/world.h"

#include "base/zeroed.h"
#include "ode/engine.h"
#include "ode/world_rows.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static void make_bodies(const Scenario *scenario, const Motion *motions, World *world)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        const dBodyID made = dBodyCreate(world->id);
        // moments about x and y never enter; the one about z in all three entries is positive
        // definite
        dMass mass;
        dMassSetParameters(&mass, body->mass, 0, 0, 0, body->inertia, body->inertia, body->inertia,
                           0, 0, 0);
        dBodySetMass(made, &mass);
        // a rotation over a finite step, not its first order
        dBodySetFiniteRotationMode(made, 1);
        dBodySetGyroscopicMode(made, 0);
        world->bodies[i] = made;
        world_place(world, i, &motions[i]);
    }
    const int driven = linkage_driven_body(linkage);
    if (driven >= 0) {
        dBodySetKinematic(world->bodies[driven]);
    }
}

static dBodyID body_of(const World *world, int body)
{
    return body == LINKAGE_GROUND ? 0 : world->bodies[body];
}

static void make_ball(const Scenario *scenario, const Motion *motions, size_t number, World *world)
{
    const OdeOptions *options = &scenario->ode;
    const Joint *joint = &scenario->linkage.joints[number];
    const dJointID ball = dJointCreateBall(world->id, 0);
    dJointAttach(ball, body_of(world, joint->body_a), body_of(world, joint->body_b));
    const Vec2 anchor = linkage_point(motions, joint->body_a, joint->anchor_a);
    dJointSetBallAnchor(ball, anchor.x, anchor.y, 0.0);
    dJointSetBallParam(ball, dParamERP, world_hold_erp(options));
    dJointSetBallParam(ball, dParamCFM, options->cfm);
    if (!scenario->run.is_lean) {
        dJointSetFeedback(ball, &world->feedback[number]);
    }
}

static void make_sliding(const Linkage *linkage, int number, const OdeOptions *options,
                         World *world)
{
    sliding_make(linkage, number, world->id, world->bodies, world_hold_erp(options), options->cfm,
                 &world->sliding[world->sliding_count++]);
}

static bool make_pairs(const Scenario *scenario, int number, World *world, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[number];
    Touch places[TOUCH_CORNERS];
    const size_t count = touch_places(joint, number, places);
    const dBodyID bodies[2] = {body_of(world, joint->body_a), body_of(world, joint->body_b)};
    for (size_t i = 0; i < count; i++) {
        WorldPair *pair = &world->pairs[world->pair_count++];
        if (joint->limits.kind != LIMIT_NONE) {
            pair_make_end(scenario, &places[i], bodies, world->id, world->ends, pair);
            continue;
        }
        if (!pair_make(scenario, &places[i], bodies, world->collider, pair, err)) {
            return false;
        }
    }
    return true;
}

void world_start(const Scenario *scenario, World *world)
{
    const OdeOptions *options = &scenario->ode;
    const Linkage *linkage = &scenario->linkage;
    memset(world, 0, sizeof *world);
    world->bodies = zeroed(linkage->body_count, sizeof *world->bodies);
    world->feedback = zeroed(linkage->joint_count, sizeof *world->feedback);
    engine_start();
    engine_seed(options->seed);
    const dWorldID id = dWorldCreate();
    world->id = id;
    world->jobs = jobs_make(id);
    world->linkage = linkage;
    dWorldSetGravity(id, 0.0, -scenario->gravity, 0.0);
    dWorldSetERP(id, world_hold_erp(options));
    dWorldSetCFM(id, options->cfm);
    dWorldSetAutoDisableFlag(id, 0);
    dWorldSetLinearDamping(id, 0.0);
    dWorldSetAngularDamping(id, 0.0);
    dWorldSetMaxAngularSpeed(id, dInfinity);
    dWorldSetContactSurfaceLayer(id, 0.0);
    dWorldSetContactMaxCorrectingVel(id, dInfinity);
    // room to step in as far as it is needed: ODE would take 64 KiB for each world
    const dWorldStepReserveInfo reserve = {sizeof reserve, dWORLDSTEP_RESERVEFACTOR_DEFAULT, 0};
    dWorldSetStepMemoryReservationPolicy(id, &reserve);
    dWorldSetQuickStepNumIterations(id, (int)options->iterations);
    dWorldSetQuickStepW(id, options->over_relaxation);
}

// Room for what only a world in the plane has: it may be one of many, each small.
static void make_pair_room(const Linkage *linkage, World *world)
{
    size_t pairs = 0;
    size_t slidings = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Touch places[TOUCH_CORNERS];
        const Joint *joint = &linkage->joints[i];
        pairs += linkage_has_play(joint) ? touch_places(joint, (int)i, places) : 0;
        slidings += joint->kind == JOINT_PRISMATIC ? 1 : 0;
    }
    world->sliding = zeroed(slidings, sizeof *world->sliding);
    world->pairs = zeroed(pairs, sizeof *world->pairs);
}

bool world_build(const Scenario *scenario, const Motion *motions, World *world, Err *err)
{
    memset(world, 0, sizeof *world);
    size_t rows = 0;
    if (!world_rows_check(scenario, motions, &rows, err)) {
        return false;
    }
    world_start(scenario, world);
    world->constraint_rows = rows;
    world->collider = collider_get(scenario->ode.collider);
    world->hold = world_hold_make(scenario);
    make_pair_room(&scenario->linkage, world);
    make_bodies(scenario, motions, world);
    world->ends = ends_make(&scenario->linkage, world->bodies, motions);
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_PRISMATIC && world->hold == NULL) {
            make_sliding(linkage, (int)i, &scenario->ode, world);
        } else if (linkage_is_ideal(linkage, i) && world->hold == NULL) {
            make_ball(scenario, motions, i, world);
        }
        if (linkage_has_play(&linkage->joints[i]) && !make_pairs(scenario, (int)i, world, err)) {
            return false;
        }
    }
    applied_make(linkage, world->id, world->bodies, motions, &world->applied);
    return true;
}

void world_finish(World *world)
{
    for (size_t i = 0; i < world->pair_count; i++) {
        pair_finish(world->collider, &world->pairs[i]);
    }
    if (world->id != NULL) {
        dWorldDestroy(world->id);
    }
    jobs_free(world->jobs);
    free(world->bodies);
    free(world->feedback);
    free(world->sliding);
    free(world->pairs);
    applied_finish(&world->applied);
    world_hold_free(world->hold);
    ends_free(world->ends);
    memset(world, 0, sizeof *world);
}

static_assert(ODE_SOLVER_COUNT == 2, "a step is quick or direct, as whoever calls world_step and "
                                     "engine_step says by ODE_QUICK");
bool world_step(World *world, double step_s, bool is_quick, Err *err)
{
    for (size_t i = 0; i < world->sliding_count; i++) {
        sliding_set(&world->sliding[i], step_s);
    }
    if (world->hold != NULL) {
        world_motions(world, world_hold_motions(world->hold));
        if (!world_hold_push(world->hold, world->bodies, step_s, err)) {
            return false;
        }
    }
    return engine_step(world->id, step_s, is_quick, err);
}

void world_offsets(const World *world, int body, Vec2 *offsets)
{
    for (size_t i = 0; i < world->sliding_count; i++) {
        const int joint = world->sliding[i].joint;
        if (world->linkage->joints[joint].body_a == body) {
            offsets[joint] = world->sliding[i].offset;
        }
    }
    if (world->hold != NULL) {
        world_hold_offsets(world->hold, body, offsets);
    }
}

bool world_check(const World *world, Err *err)
{
    const Linkage *linkage = world->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const dReal *velocity = dBodyGetLinearVel(world->bodies[i]);
        const dReal *omega = dBodyGetAngularVel(world->bodies[i]);
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

void world_joint_forces(const World *world, JointState *joints)
{
    const Linkage *linkage = world->linkage;
    if (world->hold != NULL) {
        world_hold_forces(world->hold, joints);
        return;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint->kind == JOINT_REVOLUTE) {
            // ODE gives the force on the first body attached: a, if it is no ground
            const double sign = joint->body_a != LINKAGE_GROUND ? -1.0 : 1.0;
            const dReal *force = world->feedback[i].f1;
            joints[i].force_on_b = (Vec2){sign * force[0], sign * force[1]};
            joints[i].force = vec2_length(joints[i].force_on_b);
        }
    }
    for (size_t i = 0; i < world->sliding_count; i++) {
        sliding_force(&world->sliding[i], &joints[world->sliding[i].joint]);
    }
}

void world_place(World *world, size_t body, const Motion *motion)
{
    const dBodyID id = world->bodies[body];
    const dQuaternion turn = {cos(0.5 * motion->angle), 0.0, 0.0, sin(0.5 * motion->angle)};
    dBodySetPosition(id, motion->position.x, motion->position.y, 0.0);
    dBodySetQuaternion(id, turn);
    dBodySetLinearVel(id, motion->velocity.x, motion->velocity.y, 0.0);
    dBodySetAngularVel(id, 0.0, 0.0, motion->omega);
}

Snapshot world_snapshot(const World *world, size_t body)
{
    return snapshot_of(world->bodies[body]);
}

void world_motions(const World *world, Motion *motions)
{
    for (size_t i = 0; i < world->linkage->body_count; i++) {
        const Snapshot now = world_snapshot(world, i);
        motions[i] = (Motion){
            .position = now.position,
            .angle = atan2(now.direction.y, now.direction.x),
            .velocity = now.velocity,
            .omega = now.omega,
        };
    }
}
