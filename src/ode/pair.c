// Where do the bodies of a joint with play touch in ODE's world, and at which speed?
#include "ode/pair.h"

#include "kernel/pin_hole.h"
#include "ode/plane/collider.h"
#include "ode/snapshot.h"
#include "world/pressing_row.h"

static void attach_geom(dGeomID geom, dBodyID body, Vec2 anchor)
{
    if (body == NULL) {
        dGeomSetPosition(geom, anchor.x, anchor.y, 0.0);
        return;
    }
    dGeomSetBody(geom, body);
    dGeomSetOffsetPosition(geom, anchor.x, anchor.y, 0.0);
}

static bool make_geoms(const Scenario *scenario, const Collider *collider, WorldPair *pair,
                       Err *err)
{
    const Joint *joint = &scenario->linkage.joints[pair->joint];
    const Clearance *clearance = &joint->clearance;
    pair->hole = hole_geom_create(clearance->hole_radius);
    pair->pin = dCreateCylinder(0, clearance->pin_radius, hole_geom_width(clearance));
    attach_geom(pair->hole, pair->bodies[0], joint->anchor_a);
    attach_geom(pair->pin, pair->bodies[1], joint->anchor_b);
    Err own = {0};
    if (collider->check != NULL && !collider->check(scenario, pair->joint, &own)) {
        return err_set(err, ERR_SOLVER, "%s; use collider pin-hole or staves", own.text);
    }
    pair->collision = collider->open(scenario, pair->joint);
    return true;
}

static void place_line_of(const Joint *joint, WorldPair *pair)
{
    const Touch *touch = &pair->touch;
    pair->line = (Vec2){cos(touch->direction), sin(touch->direction)};
    pair->beside[0] = vec2_sub(touch->anchor_a, joint->anchor_a);
    pair->beside[1] = vec2_sub(touch->anchor_b, joint->anchor_b);
}

bool pair_make(const Scenario *scenario, const Touch *touch, const dBodyID bodies[2],
               const Collider *collider, WorldPair *pair, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[touch->joint];
    *pair = (WorldPair){
        .joint = touch->joint,
        .touch = *touch,
        .bodies = {bodies[0], bodies[1]},
    };
    if (touch->shape == TOUCH_HOLE) {
        // of two circles the bodies say all
        return scenario->ode.collider == ODE_COLLIDER_PIN_HOLE ||
               make_geoms(scenario, collider, pair, err);
    }
    if (scenario->ode.collider != ODE_COLLIDER_PIN_HOLE) {
        return err_set(err, ERR_SOLVER,
                       "collider %s is for pins in their holes only, and joint '%s' is a %s; use "
                       "collider pin-hole",
                       OPTIONS_ODE_COLLIDERS[scenario->ode.collider], joint->name,
                       joint->kind == JOINT_GUIDE ? "block between guides" : "stop");
    }
    place_line_of(joint, pair);
    pair->is_corner = joint->kind == JOINT_GUIDE;
    return true;
}

void pair_make_end(const Scenario *scenario, const Touch *touch, const dBodyID bodies[2],
                   dWorldID world, WorldEnds *ends, WorldPair *pair)
{
    *pair = (WorldPair){
        .joint = touch->joint,
        .touch = *touch,
        .bodies = {bodies[0], bodies[1]},
        .is_corner = true,
        .is_end = true,
        .ends = touch->shape == TOUCH_LINE ? NULL : ends,
    };
    place_line_of(&scenario->linkage.joints[touch->joint], pair);
    if (touch->shape == TOUCH_TURN) {
        pair->row = pressing_row_of_angle(world, (dBodyID[]){bodies[1], bodies[0]}, NULL);
        pressing_row_set_axis(pair->row, 0.0, 0.0, touch->sign);
    }
}

void pair_finish(const Collider *collider, WorldPair *pair)
{
    if (pair->hole != NULL) {
        collider->close(pair->collision);
        dGeomDestroy(pair->hole);
        dGeomDestroy(pair->pin);
    }
}

// The velocity of a body's point, m/s; zero of the ground.
static Vec2 velocity_at(const Snapshot *body, Vec2 point)
{
    const Vec2 arm = vec2_sub(point, body->position);
    return (Vec2){body->velocity.x - body->omega * arm.y, body->velocity.y + body->omega * arm.x};
}

Vec2 pair_velocity(const WorldPair *pair, Vec2 point)
{
    const Snapshot a = snapshot_of(pair->bodies[0]);
    const Snapshot b = snapshot_of(pair->bodies[1]);
    return vec2_sub(velocity_at(&b, point), velocity_at(&a, point));
}

// Where a point given in a body's frame is.
static Vec2 point_of(const Snapshot *body, Vec2 local)
{
    return vec2_add(body->position, snapshot_turn(body, local));
}

static TouchPose hole_pose(const WorldPair *pair)
{
    const Snapshot a = snapshot_of(pair->bodies[0]);
    const Snapshot b = snapshot_of(pair->bodies[1]);
    const Vec2 hole = point_of(&a, pair->touch.anchor_a);
    const Vec2 pin = point_of(&b, pair->touch.anchor_b);
    const Vec2 velocity = vec2_sub(velocity_at(&b, pin), velocity_at(&a, hole));
    const PinHole pose = pin_hole_pose(hole, pin, velocity, pair->touch.clearance);
    return touch_pose_in_hole(&pose, velocity);
}

TouchPose pair_pose(const WorldPair *pair)
{
    if (pair->touch.shape == TOUCH_HOLE) {
        return hole_pose(pair);
    }
    if (pair->ends != NULL) {
        return touch_pose(pair->ends->linkage, &pair->touch, ends_look(pair->ends, pair->joint));
    }
    const Snapshot a = snapshot_of(pair->bodies[0]);
    const Snapshot b = snapshot_of(pair->bodies[1]);
    const Vec2 arm_a = snapshot_turn(&a, pair->touch.anchor_a);
    const Vec2 arm_b = snapshot_turn(&b, pair->touch.anchor_b);
    const Vec2 offset = vec2_sub(vec2_add(b.position, arm_b), vec2_add(a.position, arm_a));
    const Vec2 velocity = vec2_sub(snapshot_velocity(&b, arm_b), snapshot_velocity(&a, arm_a));
    return touch_pose_of(&pair->touch, offset, velocity, snapshot_turn(&a, pair->line), a.omega);
}

// Where an anchor is.
static Vec2 anchor_of(const WorldPair *pair, int side)
{
    const Snapshot body = snapshot_of(pair->bodies[side]);
    return point_of(&body, side == 0 ? pair->touch.anchor_a : pair->touch.anchor_b);
}

Vec2 pair_centre(const WorldPair *pair)
{
    return anchor_of(pair, 0);
}

Vec2 pair_anchor_b(const WorldPair *pair)
{
    return anchor_of(pair, 1);
}

// Where the pitch circles of gears touch.
static Vec2 pitch_point(const WorldPair *pair)
{
    const Vec2 centre = anchor_of(pair, 0);
    const Touch *touch = &pair->touch;
    const Vec2 between = vec2_sub(anchor_of(pair, 1), centre);
    return vec2_add(centre,
                    vec2_scale(touch->radius_a / (touch->radius_a + touch->radius_b), between));
}

Vec2 pair_point(const WorldPair *pair, Vec2 normal)
{
    const Touch *touch = &pair->touch;
    switch (touch->shape) {
    case TOUCH_HOLE:
        return vec2_sub(pair_centre(pair), vec2_scale(touch->radius_a, normal));
    case TOUCH_DISC:
        return vec2_add(anchor_of(pair, 0), vec2_scale(touch->radius_a, normal));
    case TOUCH_TEETH:
        return pitch_point(pair);
    default:
        return vec2_sub(anchor_of(pair, 1), vec2_scale(touch->radius_b, normal));
    }
}

void pair_arms(const WorldPair *pair, const TouchPose *pose, Vec2 arms[2], Vec2 *lever)
{
    touch_points(&pair->touch, pose, &arms[0], &arms[1]);
    *lever = (Vec2){0.0, 0.0};
    if (pair->is_corner) {
        const Snapshot a = snapshot_of(pair->bodies[0]);
        const Snapshot b = snapshot_of(pair->bodies[1]);
        const Vec2 to_corner = snapshot_turn(&b, pair->beside[1]);
        *lever = vec2_add(to_corner, arms[1]);
        arms[0] = vec2_add(vec2_sub(pose->offset, to_corner), snapshot_turn(&a, pair->beside[0]));
        arms[1] = (Vec2){0.0, 0.0};
    }
}
