// Which forces keep the ideal joints of a world in space closed?
//
// Those of ode/plane/world_hold.c, J v' = -(ERP / h) phi, from the response of the linkage.
//
// Plain stepping has ODE's own torque of turning inertias, implicit Euler's, that depends on the
// body alone. It has to be known before the step and is worked out here, with L = I omega:
//     (I - h [L]x) omega' = L,   T = (I omega' - L) / h
//
// Source: C. Lacoursiere, Stabilizing gyroscopic forces in rigid multibody simulations, Umea 2006,
// as ODE's step.cpp has it.
#include "ode/space_hold.h"

#include "base/zeroed.h"
#include "ode/plane/world_hold.h"

struct SpaceHold {
    double gravity;
    double erp;
    bool is_plain;
    SpaceMotion *loose; // with the speeds behind the step if nothing held the joints
    double *openings;   // by ideal row, of as many as there can be
    double *impulses;   // N s, likewise
    SpaceChange *loads; // of the impulses, by body
};

SpaceHold *space_hold_make(const Scenario *scenario, const SpaceResponse *response)
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
            Vec3 gained = vec3_scale(1.0 / linkage->bodies[i].mass, force);
            gained.y -= hold->gravity;
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
static void gyrate(const SpaceResponse *response, double step_s, const World *world)
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
        gyrate(response, step_s, world);
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
