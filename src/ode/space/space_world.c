// Builds a linkage in space in ODE, where rows of a loop may follow from others.
//
// A hinge has five rows. In a loop some follow from others: the parallel axes of a planar four-bar
// leave three too many. Which do changes as it moves, and rows chosen once lose its branch where
// they come to depend on each other (Bennett's linkage). So all hinges have all their rows, and
// redundant ones a compliance so small that their rates are those of least squares.
//
// Turning inertias: with I at mid-step, o and n the angular velocities at start and end, the
// angular momenta in the world's frame are
//     L = exp(-h/2 o) I o,   L' = exp(h/2 n) I n        exp(u) x: x turned by the vector u
// as the body turns by h/2 o up to mid-step and by h/2 n from there. ODE steps I (n - o) = h (T +
// others); L' - L = h (others) needs
//     h T = [1 - exp(h/2 n)] I n - [1 - exp(-h/2 o)] I o  = - h/2 (o x I o + n x I n) + O(h^2)
// of second order and symmetric in time. ODE's own term (dBodySetGyroscopicMode) is implicit Euler,
// of first order: a top that is let go loses its energy with the step.
#include "ode/space/space_world.h"

#include "base/zeroed.h"
#include "ode/engine.h"
#include "ode/plane/world_hold.h"

#include <math.h>
#include <string.h>

// The forces that keep the ideal joints of a world in space closed.
//
// Those of ode/plane/world_hold.c, J v' = -(ERP / h) phi, from the response of the linkage.
//
// Plain stepping has ODE's own torque of turning inertias, implicit Euler's, that depends on the
// body alone. It has to be known before the step and is worked out here, with L = I omega:
//     (I - h [L]x) omega' = L,   T = (I omega' - L) / h
//
// Source: C. Lacoursiere, Stabilizing gyroscopic forces in rigid multibody simulations, Umea 2006,
// as ODE's step.cpp has it.

struct SpaceHold {
    Vec3 gravity; // m/s^2
    double erp;
    bool is_plain;
    SpaceMotion *loose; // with the speeds behind the step if nothing held the joints
    double *openings;   // by ideal row, of as many as there can be
    double *impulses;   // N s, likewise
    SpaceChange *loads; // of the impulses, by body
};

// What holds the ideal joints of a scenario with that response; NULL where they are rows of ODE.
// For space_hold_free, which accepts NULL.
static SpaceHold *space_hold_make(const Scenario *scenario, const SpaceResponse *response)
{
    const Linkage *linkage = &scenario->linkage;
    const size_t rows = SPACE_JOINT_ROWS * linkage->joint_count;
    if (!world_hold_is_alone(scenario) || response->is_redundant ||
        response_matrix_largest(&response->matrix) <= WORLD_HOLD_ROWS) {
        return NULL;
    }
    SpaceHold *hold = zeroed(1, sizeof *hold);
    *hold = (SpaceHold){
        .gravity = scenario->gravity,
        .erp = world_hold_erp(&scenario->ode),
        .is_plain = scenario->ode.stepping == ODE_PLAIN,
        .loose = zeroed(linkage->body_count, sizeof *hold->loose),
        .openings = zeroed(rows, sizeof *hold->openings),
        .impulses = zeroed(rows, sizeof *hold->impulses),
        .loads = zeroed(linkage->body_count, sizeof *hold->loads),
    };
    return hold;
}

void space_hold_free(SpaceHold *hold)
{
    if (hold != NULL) {
        free(hold->loose);
        free(hold->openings);
        free(hold->impulses);
        free(hold->loads);
        free(hold);
    }
}

static Vec3 vector(const dReal *a)
{
    return (Vec3){a[0], a[1], a[2]};
}

// The speeds behind the step if nothing held the joints.
static void loosen(SpaceHold *hold, const SpaceResponse *response, const SpaceMotion *motions,
                   double step_s, const World *world)
{
    const Linkage *linkage = response->linkage;
    const int driven = linkage_driven_body(linkage);
    for (size_t i = 0; i < linkage->body_count; i++) {
        SpaceMotion *motion = &hold->loose[i];
        *motion = motions[i];
        motion->velocity = vector(dBodyGetLinearVel(world->bodies[i]));
        motion->omega = vector(dBodyGetAngularVel(world->bodies[i]));
        if ((int)i != driven) {
            const Vec3 force = vector(dBodyGetForce(world->bodies[i]));
            const Vec3 torque = vector(dBodyGetTorque(world->bodies[i]));
            const Vec3 pushed = vec3_scale(1.0 / linkage->bodies[i].mass, force);
            const Vec3 gained = vec3_add(pushed, hold->gravity);
            const Vec3 spun = mat3_apply(&response->inverse[i], torque);
            motion->velocity = vec3_add(motion->velocity, vec3_scale(step_s, gained));
            motion->omega = vec3_add(motion->omega, vec3_scale(step_s, spun));
        }
    }
}

// Adds what an impulse in a row does to its bodies, and to the feedback of its joint.
static void add_row(const SpaceResponse *response, size_t number, double impulse, double step_s,
                    SpaceChange *loads, World *world)
{
    const SpaceRow *row = &response->rows[number].row;
    dJointFeedback *feedback = &world->feedback[response->joint_of[number]];
    // ODE's first body is a, or b where a is the ground
    const int first = row->body[0] != LINKAGE_GROUND ? 0 : 1;
    for (int side = 0; side < 2; side++) {
        if (row->body[side] == LINKAGE_GROUND) {
            continue;
        }
        const Vec3 force = vec3_scale(impulse / step_s, row->linear[side]);
        const Vec3 moment = vec3_scale(impulse / step_s, row->angular[side]);
        SpaceChange *load = &loads[row->body[side]];
        load->move = vec3_add(load->move, force);
        load->turn = vec3_add(load->turn, moment);
        dReal *f = side == first ? feedback->f1 : feedback->f2;
        dReal *t = side == first ? feedback->t1 : feedback->t2;
        const double forces[3] = {force.x, force.y, force.z};
        const double moments[3] = {moment.x, moment.y, moment.z};
        for (int k = 0; k < 3; k++) {
            f[k] += forces[k];
            t[k] += moments[k];
        }
    }
}

// Lets the turning of inertias act as ODE does, which is not to do it again.
static void gyrate_as_ode(const SpaceResponse *response, double step_s, const World *world)
{
    const int driven = linkage_driven_body(response->linkage);
    for (size_t i = 0; i < response->linkage->body_count; i++) {
        if ((int)i == driven) {
            continue;
        }
        const dBodyID body = world->bodies[i];
        const Mat3 *turn = &response->turns[i];
        const Mat3 *own = &response->own_inertia[i];
        const Vec3 omega = mat3_apply_back(turn, vector(dBodyGetAngularVel(body)));
        const Vec3 momentum = mat3_apply(own, omega);
        // in the body's frame, column by column of what is crossed with the momentum
        const Vec3 l = vec3_scale(step_s, momentum);
        Mat3 matrix = *own;
        matrix.row[0] = vec3_add(matrix.row[0], (Vec3){0.0, l.z, -l.y});
        matrix.row[1] = vec3_add(matrix.row[1], (Vec3){-l.z, 0.0, l.x});
        matrix.row[2] = vec3_add(matrix.row[2], (Vec3){l.y, -l.x, 0.0});
        const Mat3 inverse = mat3_inverse(&matrix);
        const Vec3 after = mat3_apply(own, mat3_apply(&inverse, momentum));
        const Vec3 torque = mat3_apply(turn, vec3_scale(1.0 / step_s, vec3_sub(after, momentum)));
        dBodySetGyroscopicMode(body, 0);
        dBodyAddTorque(body, torque.x, torque.y, torque.z);
    }
}

void space_hold_push(SpaceHold *hold, const SpaceResponse *response, const SpaceMotion *motions,
                     double step_s, World *world)
{
    const Linkage *linkage = response->linkage;
    const int driven = linkage_driven_body(linkage);
    if (hold->is_plain) {
        gyrate_as_ode(response, step_s, world);
    }
    loosen(hold, response, motions, step_s, world);
    space_response_openings(response, hold->loose, hold->openings, hold->impulses);
    for (size_t i = 0; i < response->ideal_rows; i++) {
        const double speed = space_row_speed(&response->rows[i].row, hold->loose);
        hold->impulses[i] = -(speed + hold->erp / step_s * hold->openings[i]);
        world->feedback[response->joint_of[i]] = (dJointFeedback){.f1 = {0.0}};
    }
    space_response_solve(response, hold->impulses);
    for (size_t i = 0; i < linkage->body_count; i++) {
        hold->loads[i] = (SpaceChange){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    }
    for (size_t i = 0; i < response->ideal_rows; i++) {
        add_row(response, i, hold->impulses[i], step_s, hold->loads, world);
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        if ((int)i != driven) {
            const SpaceChange *load = &hold->loads[i];
            dBodyAddForce(world->bodies[i], load->move.x, load->move.y, load->move.z);
            dBodyAddTorque(world->bodies[i], load->turn.x, load->turn.y, load->turn.z);
        }
    }
}

// each iteration leaves about the step's angle of the error before
enum { GYRATION_STEPS = 12 };
static const double GYRATION_ROUNDING = 1e-15;

// rows of the plane, two a joint, of as many joints as have WORLD_HOLD_ROWS in space
enum { FLAT_HOLD_ROWS = 2 * WORLD_HOLD_ROWS / SPACE_JOINT_ROWS };

// what the rows of redundant joints give way, as a share of what a body's mass does: less lets
// forces between them grow that are mere rounding, more is felt by the motion
static const double REDUNDANT_SHARE = 1e-4;

static void make_body(const Scenario *scenario, size_t number, const SpaceMotion *motion,
                      World *world)
{
    const Body *body = &scenario->linkage.bodies[number];
    const Mat3 inertia = space_inertia(body);
    const dBodyID made = dBodyCreate(world->id);
    dMass mass;
    dMassSetParameters(&mass, body->mass, 0, 0, 0, inertia.row[0].x, inertia.row[1].y,
                       inertia.row[2].z, inertia.row[0].y, inertia.row[0].z, inertia.row[1].z);
    dBodySetMass(made, &mass);
    dBodySetFiniteRotationMode(made, 1);
    // plain stepping is what ODE's manual says
    dBodySetGyroscopicMode(made, scenario->ode.stepping == ODE_PLAIN);
    world->bodies[number] = made;
    space_world_place(world, number, motion);
}

static void make_ideal(const Scenario *scenario, const SpaceMotion *motions, size_t number,
                       const SpaceResponse *response, World *world)
{
    const SpaceEnd *ends = response->ends[number];
    const Vec3 point = space_point(motions, ends[0].body, ends[0].anchor);
    const Vec3 axis = space_direction(motions, ends[0].body, ends[0].axis);
    const Joint *joint = &scenario->linkage.joints[number];
    const dJointID made = dJointCreateHinge(world->id, 0);
    dJointAttach(made, world_body(world, joint->body_a), world_body(world, joint->body_b));
    dJointSetHingeAnchor(made, point.x, point.y, point.z);
    dJointSetHingeAxis(made, axis.x, axis.y, axis.z);
    dJointSetFeedback(made, &world->feedback[number]);
}

// A CFM that lets redundant rows share what they hold together: the rates of rows are then those of
// least squares, wherever in the motion some of them come to depend on each other.
static double redundant_cfm(const Scenario *scenario)
{
    double sum = 0.0;
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        sum += 1.0 / scenario->linkage.bodies[i].mass;
    }
    return REDUNDANT_SHARE * scenario->run.step * sum / (double)scenario->linkage.body_count;
}

static void make_bodies(const Scenario *scenario, const SpaceMotion *motions,
                        const SpaceResponse *response, World *world)
{
    const Linkage *linkage = &scenario->linkage;
    world_start(scenario, world);
    world->constraint_rows =
        response->is_redundant ? SPACE_JOINT_ROWS * response->ideal_count : response->ideal_rows;
    for (size_t i = 0; i < linkage->body_count; i++) {
        make_body(scenario, i, &motions[i], world);
    }
    const int driven = linkage_driven_body(linkage);
    if (driven >= 0) {
        dBodySetKinematic(world->bodies[driven]);
    }
    if (response->is_redundant) {
        dWorldSetCFM(world->id, fmax(dWorldGetCFM(world->id), redundant_cfm(scenario)));
    }
}

static void make_hinges(const Scenario *scenario, const SpaceMotion *motions,
                        const SpaceResponse *response, World *world)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (linkage_is_ideal(&scenario->linkage, i)) {
            make_ideal(scenario, motions, i, response, world);
        }
    }
}

bool space_world_build(const Scenario *scenario, const SpaceMotion *motions,
                       const SpaceResponsePlace *places, size_t count, World *world,
                       SpaceResponse *response, SpaceHold **hold, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    memset(world, 0, sizeof *world);
    if (!space_response_init(linkage, motions, places, count, response, err)) {
        return false;
    }
    if (!space_response_place(response, motions, NULL)) {
        return err_set(err, ERR_SOLVER,
                       "the ideal joints are redundant at the start: give one joint of the loop "
                       "some play");
    }
    make_bodies(scenario, motions, response, world);
    *hold = space_hold_make(scenario, response);
    if (*hold == NULL) {
        make_hinges(scenario, motions, response, world);
    }
    return true;
}

bool space_world_build_flat(const Scenario *scenario, const Scenario *flat, const Motion *planar,
                            World *world, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    memset(world, 0, sizeof *world);
    size_t rows = 0;
    if (!world_rows_check(flat, planar, &rows, err)) {
        return false;
    }
    SpaceMotion *motions = zeroed(linkage->body_count, sizeof *motions);
    SpaceResponse response = {.linkage = NULL};
    space_lift(linkage, planar, motions);
    const bool is_held = space_response_init(linkage, motions, NULL, 0, &response, err);
    if (is_held) {
        make_bodies(scenario, motions, &response, world);
        applied_make(&flat->linkage, world->id, world->bodies, planar, &world->applied);
        world->hold =
            world_hold_make(flat, response.is_redundant ? WORLD_HOLD_ROWS : FLAT_HOLD_ROWS);
        if (world->hold == NULL) {
            make_hinges(scenario, motions, &response, world);
        }
        for (size_t i = 0; i < linkage->body_count; i++) {
            // about an axis of its own nothing turns a body, or its hinges hold it
            dBodySetGyroscopicMode(world->bodies[i], 0);
        }
    }
    space_response_finish(&response);
    free(motions);
    return is_held;
}

void space_world_place(World *world, size_t body, const SpaceMotion *motion)
{
    const dBodyID id = world->bodies[body];
    const dQuaternion turn = {motion->turn.w, motion->turn.x, motion->turn.y, motion->turn.z};
    dBodySetPosition(id, motion->position.x, motion->position.y, motion->position.z);
    dBodySetQuaternion(id, turn);
    dBodySetLinearVel(id, motion->velocity.x, motion->velocity.y, motion->velocity.z);
    dBodySetAngularVel(id, motion->omega.x, motion->omega.y, motion->omega.z);
}

SpaceMotion space_world_motion(const World *world, size_t body)
{
    const dBodyID id = world->bodies[body];
    const dReal *turn = dBodyGetQuaternion(id);
    return (SpaceMotion){
        .position = vector(dBodyGetPosition(id)),
        .turn = {turn[0], turn[1], turn[2], turn[3]},
        .velocity = vector(dBodyGetLinearVel(id)),
        .omega = vector(dBodyGetAngularVel(id)),
    };
}

bool space_world_check(const World *world, Err *err)
{
    for (size_t i = 0; i < world->linkage->body_count; i++) {
        const dReal *v = dBodyGetLinearVel(world->bodies[i]);
        const dReal *w = dBodyGetAngularVel(world->bodies[i]);
        if (!isfinite(v[0] + v[1] + v[2] + w[0] + w[1] + w[2])) {
            return err_set(err, ERR_SOLVER, "the velocity of the %s is no longer finite",
                           world->linkage->bodies[i].name);
        }
    }
    return true;
}

SpaceChange space_world_load(const World *world, size_t joint, int body)
{
    const Joint *data = &world->linkage->joints[joint];
    const dJointFeedback *feedback = &world->feedback[joint];
    // ODE's first body is a, or b where a is the ground
    const bool is_first = body == data->body_a || data->body_a == LINKAGE_GROUND;
    return is_first ? (SpaceChange){vector(feedback->f1), vector(feedback->t1)}
                    : (SpaceChange){vector(feedback->f2), vector(feedback->t2)};
}

Vec3 space_world_force(const World *world, size_t joint)
{
    const Joint *data = &world->linkage->joints[joint];
    const double sign = data->body_a != LINKAGE_GROUND ? -1.0 : 1.0;
    return vec3_scale(sign, vector(world->feedback[joint].f1));
}

// x less x turned by a vector u, with all its digits: -(sin u / u) u x x - ((1 - cos u) / u^2) u x
// (u x x).
static Vec3 turned_away(Vec3 u, Vec3 x)
{
    const double square = vec3_dot(u, u);
    const double angle = sqrt(square);
    const bool is_small = angle < 1e-4;
    const double first = is_small ? 1.0 - square / 6.0 : sin(angle) / angle;
    const double half = is_small ? 1.0 - square / 24.0 : sin(0.5 * angle) / (0.5 * angle);
    const Vec3 across = vec3_cross(u, x);
    return vec3_scale(-1.0, vec3_add(vec3_scale(first, across),
                                     vec3_scale(0.5 * half * half, vec3_cross(u, across))));
}

Vec3 space_world_gyration(const SpaceResponse *response, size_t body, const SpaceMotion *middle,
                          Vec3 rest, double step_s, Vec3 *alpha)
{
    const Mat3 turn = quat_matrix(middle->turn);
    const Mat3 *inertia = &response->own_inertia[body];
    const double half_s = 0.5 * step_s;
    // all in the body's frame
    const Vec3 omega = mat3_apply_back(&turn, middle->omega);
    const Vec3 start = turned_away(vec3_scale(-half_s, omega), mat3_apply(inertia, omega));
    const Vec3 unturned = vec3_add(omega, vec3_scale(step_s, mat3_apply_back(&turn, rest)));
    const double rounding = GYRATION_ROUNDING * vec3_length(unturned);
    Vec3 torque = {0.0, 0.0, 0.0};
    Vec3 turning = {0.0, 0.0, 0.0};
    double change = INFINITY;
    for (int i = 0; i < GYRATION_STEPS && change > rounding; i++) {
        const Vec3 next = vec3_add(unturned, vec3_scale(step_s, turning));
        const Vec3 end = turned_away(vec3_scale(half_s, next), mat3_apply(inertia, next));
        torque = vec3_scale(1.0 / step_s, vec3_sub(end, start));
        const Vec3 before = turning;
        turning = mat3_apply(&response->own_inverse[body], torque);
        change = step_s * vec3_length(vec3_sub(turning, before));
    }
    *alpha = mat3_apply(&turn, turning);
    return mat3_apply(&turn, torque);
}

bool space_world_move_on(World *world, SpaceResponse *response, double step_s, SpaceMotion *motions,
                         Err *err)
{
    const Linkage *linkage = world->linkage;
    const int driven = linkage_driven_body(linkage);
    const double half_s = 0.5 * step_s;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const SpaceChange moved = {vec3_scale(half_s, motions[i].velocity),
                                   vec3_scale(half_s, motions[i].omega)};
        space_change(&motions[i], &moved, NULL);
        motions[i].acceleration = motions[i].alpha = (Vec3){0.0, 0.0, 0.0};
    }
    if (driven >= 0) {
        motions[driven] = space_driven(linkage, half_s);
        motions[driven].acceleration = (Vec3){0.0, 0.0, 0.0};
    }
    if (!space_response_place(response, motions, NULL)) {
        return err_set(err, ERR_SOLVER,
                       "the ideal joints are redundant at the start: give one joint of the "
                       "loop some play");
    }
    const size_t ideal = response->ideal_rows;
    double *openings = zeroed(3 * ideal, sizeof *openings);
    double *rates = openings + ideal;
    double *drift = rates + ideal;
    SpaceChange *changes = zeroed(linkage->body_count, sizeof *changes);
    space_response_openings(response, motions, openings, rates);
    space_response_drift(response, motions, drift);
    for (size_t i = 0; i < ideal; i++) {
        openings[i] -= 2.0 * half_s * half_s * drift[i];
    }
    space_response_close(response, openings, rates, changes);
    for (size_t i = 0; i < linkage->body_count; i++) {
        if ((int)i != driven) {
            space_change(&motions[i], &changes[i], NULL);
        }
        space_world_place(world, i, &motions[i]);
    }
    free(changes);
    free(openings);
    return true;
}
