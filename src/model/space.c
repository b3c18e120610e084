// Puts into space what the plane says of a linkage.
#include "model/space.h"

#include "base/zeroed.h"

// of a principal moment: rounding of the numbers of a case
static const double INERTIA_ROUNDING = 1e-9;

// moment of inertia of a slender body about its length, over that about the axes across it
static const double SLENDER = 1e-2;

static Vec3 lift(Vec2 a, double z)
{
    return (Vec3){a.x, a.y, z};
}

static Quat turn_about_z(double angle)
{
    return (Quat){cos(0.5 * angle), 0.0, 0.0, sin(0.5 * angle)};
}

void space_lift(const Linkage *linkage, const Motion *planar, SpaceMotion *motions)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i] = (SpaceMotion){
            .position = lift(planar[i].position, linkage->bodies[i].space.height),
            .turn = turn_about_z(planar[i].angle),
            .velocity = lift(planar[i].velocity, 0.0),
            .omega = {0.0, 0.0, planar[i].omega},
            .acceleration = lift(planar[i].acceleration, 0.0),
            .alpha = {0.0, 0.0, planar[i].alpha},
        };
    }
}

void space_start(const Linkage *linkage, SpaceMotion *motions)
{
    Motion *planar = zeroed(linkage->body_count, sizeof *planar);
    linkage_start(linkage, planar);
    space_lift(linkage, planar, motions);
    free(planar);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const BodySpace *space = &linkage->bodies[i].space;
        if (space->is_elsewhere) {
            motions[i].position = space->position;
            motions[i].turn = space->turn;
        }
        motions[i].velocity.z = space->velocity_z;
        motions[i].omega.x = space->omega_x;
        motions[i].omega.y = space->omega_y;
    }
}

void space_set_start(const SpaceMotion *motion, Body *body)
{
    body->start.velocity = (Vec2){motion->velocity.x, motion->velocity.y};
    body->start.omega = motion->omega.z;
    body->space.velocity_z = motion->velocity.z;
    body->space.omega_x = motion->omega.x;
    body->space.omega_y = motion->omega.y;
}

void space_set_place(const SpaceMotion *motion, Body *body)
{
    space_set_start(motion, body);
    body->space.is_elsewhere = true;
    body->space.position = motion->position;
    body->space.turn = motion->turn;
}

bool space_starts_elsewhere(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (linkage->bodies[i].space.is_elsewhere) {
            return true;
        }
    }
    return false;
}

SpaceMotion space_driven(const Linkage *linkage, double time_s)
{
    const Driver *driver = &linkage->driver;
    const Joint *joint = &linkage->joints[driver->joint];
    const Body *body = &linkage->bodies[joint->body_b];
    const Vec3 axis = joint->space.axis;
    const Vec3 pivot = lift(joint->anchor_a, joint->space.height);
    const SpaceEnd end = space_end(linkage, (size_t)driver->joint, 1);
    const Quat turned = quat_of_turn(vec3_scale(driver->speed * time_s, axis));
    const Quat turn = quat_unit(quat_product(turned, turn_about_z(body->start.angle)));
    const Vec3 arm = vec3_scale(-1.0, quat_rotate(turn, end.anchor));
    const Vec3 omega = vec3_scale(driver->speed, axis);
    const Vec3 velocity = vec3_cross(omega, arm);
    return (SpaceMotion){
        .position = vec3_add(pivot, arm),
        .turn = turn,
        .velocity = velocity,
        .omega = omega,
        .acceleration = vec3_cross(omega, velocity),
    };
}

Motion space_planar(const SpaceMotion *motion)
{
    const Mat3 turn = quat_matrix(motion->turn);
    return (Motion){
        .position = {motion->position.x, motion->position.y},
        .angle = atan2(turn.row[1].x, turn.row[0].x),
        .velocity = {motion->velocity.x, motion->velocity.y},
        .omega = motion->omega.z,
        .acceleration = {motion->acceleration.x, motion->acceleration.y},
        .alpha = motion->alpha.z,
    };
}

Mat3 space_inertia(const Body *body)
{
    const BodySpace *space = &body->space;
    return (Mat3){{
        {space->inertia_x, -space->product_xy, -space->product_xz},
        {-space->product_xy, space->inertia_y, -space->product_yz},
        {-space->product_xz, -space->product_yz, body->inertia},
    }};
}

Mat3 space_world_inertia(const Body *body, Quat turn)
{
    const Mat3 own = space_inertia(body);
    const Mat3 r = quat_matrix(turn);
    Mat3 world;
    for (int i = 0; i < 3; i++) {
        // row i of R I, then of its product with R'
        world.row[i] = mat3_apply(&r, mat3_apply(&own, r.row[i]));
    }
    return world;
}

Vec3 space_own_direction(const Body *body, Vec3 axis)
{
    const bool is_z = axis.x == 0.0 && axis.y == 0.0;
    return is_z ? axis : quat_rotate_back(turn_about_z(body->start.angle), axis);
}

SpaceEnd space_end(const Linkage *linkage, size_t joint, int side)
{
    const Joint *data = &linkage->joints[joint];
    const JointEnd end = linkage_end(data, side);
    if (end.body == LINKAGE_GROUND) {
        return (SpaceEnd){LINKAGE_GROUND, lift(end.anchor, data->space.height), data->space.axis};
    }
    const Body *body = &linkage->bodies[end.body];
    return (SpaceEnd){
        .body = end.body,
        .anchor = lift(end.anchor, data->space.height - body->space.height),
        .axis = space_own_direction(body, data->space.axis),
    };
}

Vec3 space_direction(const SpaceMotion *motions, int body, Vec3 local)
{
    return body == LINKAGE_GROUND ? local : quat_rotate(motions[body].turn, local);
}

Vec3 space_point(const SpaceMotion *motions, int body, Vec3 local)
{
    return body == LINKAGE_GROUND
               ? local
               : vec3_add(motions[body].position, quat_rotate(motions[body].turn, local));
}

Vec3 space_velocity_at(const SpaceMotion *motions, int body, Vec3 point)
{
    if (body == LINKAGE_GROUND) {
        return (Vec3){0.0, 0.0, 0.0};
    }
    const SpaceMotion *motion = &motions[body];
    return vec3_add(motion->velocity, vec3_cross(motion->omega, vec3_sub(point, motion->position)));
}

Vec3 space_acceleration_at(const SpaceMotion *motions, int body, Vec3 point)
{
    if (body == LINKAGE_GROUND) {
        return (Vec3){0.0, 0.0, 0.0};
    }
    const SpaceMotion *motion = &motions[body];
    const Vec3 arm = vec3_sub(point, motion->position);
    return vec3_add(motion->acceleration,
                    vec3_add(vec3_cross(motion->alpha, arm),
                             vec3_cross(motion->omega, vec3_cross(motion->omega, arm))));
}

double space_kinetic_energy(const Linkage *linkage, const SpaceMotion *motions)
{
    double sum = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Mat3 inertia = space_world_inertia(&linkage->bodies[i], motions[i].turn);
        const Vec3 v = motions[i].velocity;
        const Vec3 w = motions[i].omega;
        sum += 0.5 * linkage->bodies[i].mass * vec3_dot(v, v) +
               0.5 * vec3_dot(w, mat3_apply(&inertia, w));
    }
    return sum;
}

double space_potential_energy(const Linkage *linkage, const SpaceMotion *motions, Vec3 gravity)
{
    double sum = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        sum -= vec3_dot(vec3_scale(linkage->bodies[i].mass, gravity), motions[i].position);
    }
    return sum;
}

// Its second moments, sums of m x x, m x y and so on, make a positive semidefinite matrix.
bool space_is_possible(const Body *body)
{
    const BodySpace *space = &body->space;
    const double half = 0.5 * (space->inertia_x + space->inertia_y + body->inertia);
    const double xx = half - space->inertia_x;
    const double yy = half - space->inertia_y;
    const double zz = half - body->inertia;
    const double xy = space->product_xy;
    const double xz = space->product_xz;
    const double yz = space->product_yz;
    const double rounding = INERTIA_ROUNDING * half;
    const double determinant =
        xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    return xx >= -rounding && yy >= -rounding && zz >= -rounding &&
           xx * yy - xy * xy >= -rounding * half && xx * zz - xz * xz >= -rounding * half &&
           yy * zz - yz * yz >= -rounding * half && determinant >= -rounding * half * half;
}

bool space_is_upright(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Vec3 axis = linkage->joints[i].space.axis;
        if (axis.x != 0.0 || axis.y != 0.0 || axis.z < 0.0) {
            return false;
        }
    }
    return true;
}

bool space_has_plane(const Linkage *linkage)
{
    return !linkage->is_spatial || space_is_upright(linkage);
}

void space_complete(Linkage *linkage)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        Body *body = &linkage->bodies[i];
        body->space.inertia_x =
            body->space.inertia_x > 0.0 ? body->space.inertia_x : SLENDER * body->inertia;
        body->space.inertia_y = body->space.inertia_y > 0.0 ? body->space.inertia_y : body->inertia;
    }
}
