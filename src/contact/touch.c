// Finds where the bodies of a joint touch, and how deep.
#include "contact/touch.h"

#include "base/zeroed.h"
#include "contact/law.h"

#include <stdlib.h>

// The corners of a block or sleeve against the guides or the rod. Corner by corner: which side of
// the middle line, +1 along the lines' normal (their direction turned by a quarter turn), and which
// end of the block, +1 along the direction. A block's own side meets the guide on that side, which
// pushes it back; a sleeve's the rod's surface on that side, which pushes it away.
static void place_corners(const Joint *joint, int number, Touch places[TOUCH_CORNERS])
{
    const Guide *guide = &joint->guide;
    const Vec2 across = vec2_perp(vec2_rotate(joint->direction, (Vec2){1.0, 0.0}));
    // the block's own directions in body b's frame: parallel to the guides where it is not tilted
    const Vec2 own_along = vec2_rotate(joint->direction - joint->held_angle, (Vec2){1.0, 0.0});
    const Vec2 own_across = vec2_perp(own_along);
    const bool is_sleeve = guide->height > guide->opening;
    for (int i = 0; i < TOUCH_CORNERS; i++) {
        const double side = i / 2 == 0 ? 1.0 : -1.0;
        const double end = i % 2 == 0 ? 1.0 : -1.0;
        const bool pushes_up = (side > 0.0) == is_sleeve;
        places[i] = (Touch){
            .joint = number,
            .place = i,
            .shape = TOUCH_LINE,
            .anchor_a = vec2_add(joint->anchor_a, vec2_scale(0.5 * side * guide->opening, across)),
            .anchor_b = vec2_add(joint->anchor_b,
                                 vec2_add(vec2_scale(0.5 * side * guide->height, own_across),
                                          vec2_scale(0.5 * end * guide->length, own_along))),
            .direction = joint->direction + (pushes_up ? 0.5 : -0.5) * M_PI,
        };
    }
}

static Touch place_slot(const Joint *joint, int number)
{
    const Stop *stop = &joint->stop;
    return (Touch){
        .joint = number,
        .shape = TOUCH_SLOT,
        .anchor_a = joint->anchor_a,
        .anchor_b = joint->anchor_b,
        .direction = joint->direction,
        .clearance = stop->radius_a - stop->radius_b,
        .radius_a = stop->radius_a,
        .radius_b = stop->radius_b,
        .half_length = 0.5 * stop->slot,
    };
}

static Touch place_stop(const Linkage *linkage, int number)
{
    const Joint *joint = &linkage->joints[number];
    const Stop *stop = &joint->stop;
    if (linkage_has_slot(joint)) {
        return place_slot(joint, number);
    }
    return (Touch){
        .joint = number,
        .shape = stop->cam > 0   ? TOUCH_CAM
                 : stop->is_disc ? TOUCH_DISC
                                 : TOUCH_LINE,
        .anchor_a = joint->anchor_a,
        .anchor_b = joint->anchor_b,
        .direction = joint->direction,
        .clearance = stop->radius_b + (stop->is_disc ? stop->radius_a : 0.0),
        .radius_a = stop->is_disc ? stop->radius_a : 0.0,
        .radius_b = stop->radius_b,
        .cam = {.profile = linkage_profile(linkage, joint),
                .direction = joint->direction,
                .radius = stop->radius_b,
                .is_flat = stop->is_flat,
                .facing = stop->facing},
    };
}

// What the ends of a limited coordinate are; of the kinds that have none a turn's.
static TouchShape shape_of_end(JointKind kind)
{
    switch (joint_coordinate(kind)) {
    case JOINT_COORDINATE_POSITION:
        return TOUCH_LINE;
    case JOINT_COORDINATE_TEETH:
        return TOUCH_TEETH;
    case JOINT_COORDINATE_RACK:
        return TOUCH_RACK;
    case JOINT_COORDINATE_ANGLE:
    case JOINT_COORDINATE_NONE:
        break;
    }
    return TOUCH_TURN;
}

// The ends of a limited coordinate. Of a slider they are lines across its own line, and anchor b is
// a point.
static size_t place_ends(const Joint *joint, int number, Touch places[TOUCH_CORNERS])
{
    const double ends[2] = {coordinate_low(joint), coordinate_high(joint)};
    const Vec2 along = vec2_rotate(joint->direction, (Vec2){1.0, 0.0});
    size_t count = 0;
    for (int i = 0; i < 2; i++) {
        if (!isfinite(ends[i])) {
            continue;
        }
        const double sign = i == 0 ? 1.0 : -1.0;
        Touch *end = &places[count++];
        *end = (Touch){
            .joint = number,
            .place = i,
            .shape = shape_of_end(joint->kind),
            .anchor_a = joint->anchor_a,
            .anchor_b = joint->anchor_b,
        };
        if (end->shape == TOUCH_LINE) {
            end->anchor_a = vec2_add(joint->anchor_a, vec2_scale(ends[i], along));
            end->direction = joint->direction + (i == 0 ? 0.0 : M_PI);
            continue;
        }
        end->sign = sign;
        end->direction = joint->direction;
        end->clearance = sign * ends[i];
        end->radius_a = joint->gear.radius_a;
        end->radius_b = joint->gear.radius_b;
    }
    return count;
}

size_t touch_places(const Linkage *linkage, int number, Touch places[TOUCH_CORNERS])
{
    const Joint *joint = &linkage->joints[number];
    if (joint->limits.kind != LIMIT_NONE) {
        return place_ends(joint, number, places);
    }
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        places[0] = (Touch){
            .joint = number,
            .shape = TOUCH_HOLE,
            .anchor_a = joint->anchor_a,
            .anchor_b = joint->anchor_b,
            .clearance = linkage_radial_clearance(joint),
            .radius_a = joint->clearance.hole_radius,
            .radius_b = joint->clearance.pin_radius,
        };
        return 1;
    case JOINT_TOUCHES_GUIDES:
        place_corners(joint, number, places);
        return TOUCH_CORNERS;
    case JOINT_TOUCHES_DISC:
        places[0] = place_stop(linkage, number);
        return 1;
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_TEETH:
        break;
    }
    return 0;
}

bool touch_list(const Scenario *scenario, Touch **places, size_t *count, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    Touch *list = zeroed(TOUCH_CORNERS * linkage->joint_count, sizeof *list);
    *count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Touch *own = list + *count;
        const size_t own_count = touch_places(linkage, (int)i, own);
        ForceLaw law;
        if (own_count > 0 && !law_of_joint(scenario, &linkage->joints[i], &law, err)) {
            free(list);
            return false;
        }
        for (size_t k = 0; k < own_count; k++) {
            own[k].law = law;
        }
        *count += own_count;
    }
    *places = list;
    return true;
}

TouchSlot touch_in_slot(Vec2 offset, Vec2 velocity, Vec2 across, double omega_a)
{
    const Vec2 along = vec2_perp(across);
    const Vec2 at = {vec2_dot(across, offset), vec2_dot(along, offset)};
    return (TouchSlot){
        .across = across,
        .position = at,
        .rate = {vec2_dot(across, velocity) + omega_a * at.y,
                 vec2_dot(along, velocity) - omega_a * at.x},
    };
}

static TouchPose pose_in_slot(const Touch *place, Vec2 offset, Vec2 velocity, Vec2 across,
                              double omega_a)
{
    const Vec2 along = vec2_perp(across);
    const TouchSlot slot = touch_in_slot(offset, velocity, across, omega_a);
    const PinHole pin =
        pin_slot_pose(slot.position, slot.rate, place->half_length, place->clearance);
    return (TouchPose){
        .offset = offset,
        .velocity = velocity,
        .gap = pin.gap,
        .has_normal = pin.has_normal,
        .normal = vec2_add(vec2_scale(pin.normal.x, across), vec2_scale(pin.normal.y, along)),
        .approach_speed = pin.approach_speed,
        .middle = vec2_scale(slot.position.y - pin.eccentricity.y, along),
    };
}

TouchPose touch_pose_of(const Touch *place, Vec2 offset, Vec2 velocity, Vec2 line, double omega_a)
{
    TouchPose pose = {.offset = offset, .velocity = velocity};
    double outside = -1.0;
    switch (place->shape) {
    case TOUCH_LINE:
        pose.has_normal = true;
        pose.normal = line;
        pose.gap = vec2_dot(line, offset) - place->clearance;
        pose.approach_speed =
            -vec2_dot(line, velocity) - omega_a * vec2_dot(vec2_perp(line), offset);
        return pose;
    case TOUCH_DISC:
        outside = 1.0;
        break;
    case TOUCH_SLOT:
        return pose_in_slot(place, offset, velocity, line, omega_a);
    case TOUCH_HOLE:
    case TOUCH_CAM:  // touch_pose_on_cam has it
    case TOUCH_TURN: // pose_of_end and pose_of_flank have these
    case TOUCH_TEETH:
    case TOUCH_RACK:
        break;
    }
    const double distance = vec2_length(offset);
    pose.gap = outside * (distance - place->clearance);
    pose.has_normal = distance > 0.0;
    pose.normal = pose.has_normal ? vec2_scale(outside / distance, offset) : (Vec2){0.0, 0.0};
    pose.approach_speed =
        pose.has_normal ? -vec2_dot(pose.normal, velocity) : vec2_length(velocity);
    return pose;
}

TouchPose touch_pose_on_cam(const Touch *place, Vec2 zero, Vec2 facing, Vec2 offset, Vec2 velocity,
                            const double omegas[2])
{
    const CamPose pose = cam_pose(&place->cam, zero, facing, offset);
    return (TouchPose){
        .offset = offset,
        .velocity = velocity,
        .gap = pose.gap,
        .has_normal = true,
        .normal = pose.normal,
        .approach_speed = -cam_rate(&pose, offset, velocity, omegas[0], omegas[1]),
        .from_b = pose.from_b,
    };
}

// How a body is turned, rad, and how fast it turns, rad/s.
static double angle_of(const Motion *motions, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : motions[body].angle;
}

static double omega_of(const Motion *motions, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : motions[body].omega;
}

// An angle, or a rack's teeth, at one end.
static TouchPose pose_of_end(const Linkage *linkage, const Touch *place, const Motion *motions,
                             Vec2 offset, Vec2 velocity)
{
    const double sign = place->sign;
    const bool is_rack = joint_has_rack(linkage->joints[place->joint].kind);
    return (TouchPose){
        .offset = offset,
        .velocity = velocity,
        .gap = sign * coordinate_position(linkage, motions, place->joint) - place->clearance,
        .has_normal = true,
        .normal = is_rack ? vec2_scale(sign, joint_rows_along(linkage, motions, place->joint))
                          : (Vec2){0.0, 0.0},
        .approach_speed = -sign * coordinate_rate(linkage, motions, place->joint),
    };
}

// A flank of a pair of gears.
static TouchPose pose_of_flank(const Linkage *linkage, const Touch *place, const Motion *motions,
                               Vec2 offset, Vec2 velocity)
{
    const Joint *joint = &linkage->joints[place->joint];
    const MeshFlank flank = coordinate_flank(linkage, motions, place->joint, place->sign);
    const double position = coordinate_position(linkage, motions, place->joint);
    return (TouchPose){
        .offset = offset,
        .velocity = velocity,
        .gap = mesh_gap(&joint->gear, &flank, place->sign * position - place->clearance,
                        vec2_length(offset) - mesh_distance(&joint->gear)),
        .has_normal = true,
        .normal = flank.normal,
        .approach_speed = -mesh_rate(&flank, velocity, omega_of(motions, joint->body_a),
                                     omega_of(motions, joint->body_b)),
        .from_b = flank.from_b,
    };
}

Vec2 touch_across(const Linkage *linkage, const Touch *place, const Motion *motions)
{
    const int body = linkage->joints[place->joint].body_a;
    return vec2_rotate(angle_of(motions, body) + place->direction, (Vec2){1.0, 0.0});
}

TouchPose touch_pose(const Linkage *linkage, const Touch *place, const Motion *motions)
{
    const Joint *joint = &linkage->joints[place->joint];
    const Vec2 offset = vec2_sub(linkage_point(motions, joint->body_b, place->anchor_b),
                                 linkage_point(motions, joint->body_a, place->anchor_a));
    const Vec2 velocity = vec2_sub(linkage_point_velocity(motions, joint->body_b, place->anchor_b),
                                   linkage_point_velocity(motions, joint->body_a, place->anchor_a));
    const double angle = angle_of(motions, joint->body_a);
    const double omega = omega_of(motions, joint->body_a);
    const Vec2 x = {1.0, 0.0};
    Vec2 line = {0.0, 0.0};
    switch (place->shape) {
    case TOUCH_TURN:
    case TOUCH_RACK:
        return pose_of_end(linkage, place, motions, offset, velocity);
    case TOUCH_TEETH:
        return pose_of_flank(linkage, place, motions, offset, velocity);
    case TOUCH_CAM:
        return touch_pose_on_cam(
            place, vec2_rotate(angle + place->direction, x),
            vec2_rotate(angle_of(motions, joint->body_b) + place->cam.facing, x), offset, velocity,
            (const double[]){omega, omega_of(motions, joint->body_b)});
    case TOUCH_LINE:
    case TOUCH_SLOT:
        line = vec2_rotate(angle + place->direction, x);
        break;
    case TOUCH_HOLE:
    case TOUCH_DISC:
        break;
    }
    return touch_pose_of(place, offset, velocity, line, omega);
}

void touch_points(const Touch *place, const TouchPose *pose, Vec2 *from_a, Vec2 *from_b)
{
    switch (place->shape) {
    case TOUCH_HOLE:
        *from_a = vec2_scale(-place->radius_a, pose->normal);
        *from_b = vec2_sub(*from_a, pose->offset);
        break;
    case TOUCH_DISC:
        *from_a = vec2_scale(place->radius_a, pose->normal);
        *from_b = vec2_sub(*from_a, pose->offset);
        break;
    case TOUCH_SLOT:
        *from_a = vec2_sub(pose->middle, vec2_scale(place->radius_a, pose->normal));
        *from_b = vec2_sub(*from_a, pose->offset);
        break;
    case TOUCH_TEETH:
    case TOUCH_CAM:
        *from_b = pose->from_b;
        *from_a = vec2_add(pose->offset, *from_b);
        break;
    case TOUCH_RACK:
        // where the pinion's pitch circle is nearest to the pitch line
        *from_b = vec2_scale(-place->radius_b * place->sign, vec2_perp(pose->normal));
        *from_a = vec2_add(pose->offset, *from_b);
        break;
    case TOUCH_LINE:
    case TOUCH_TURN:
        // on body b: the circle's lowest point; of body a the point beside it
        *from_b = vec2_scale(-place->radius_b, pose->normal);
        *from_a = vec2_add(pose->offset, *from_b);
        break;
    }
}

double touch_sliding(const Linkage *linkage, const Touch *place, const TouchPose *pose,
                     const Motion *motions)
{
    if (touch_is_end(place)) {
        return 0.0; // pitch circles roll on one another
    }
    const Joint *joint = &linkage->joints[place->joint];
    const int bodies[2] = {joint->body_a, joint->body_b};
    Vec2 arms[2];
    Vec2 turning[2] = {{0.0, 0.0}, {0.0, 0.0}};
    touch_points(place, pose, &arms[0], &arms[1]);
    for (int side = 0; side < 2; side++) {
        if (bodies[side] != LINKAGE_GROUND) {
            turning[side] = vec2_scale(motions[bodies[side]].omega, vec2_perp(arms[side]));
        }
    }
    const Vec2 relative = vec2_add(pose->velocity, vec2_sub(turning[1], turning[0]));
    return vec2_dot(vec2_perp(pose->normal), relative);
}

TouchTravel touch_travel(const Linkage *linkage, const Touch *place, const TouchPose *pose,
                         const Motion *motions)
{
    const Joint *joint = &linkage->joints[place->joint];
    const Cam *cam = &place->cam;
    const Vec2 x = {1.0, 0.0};
    const double a = omega_of(motions, joint->body_a);
    const double b = omega_of(motions, joint->body_b);
    const CamPose met =
        cam_pose(cam, vec2_rotate(angle_of(motions, joint->body_a) + cam->direction, x),
                 vec2_rotate(angle_of(motions, joint->body_b) + cam->facing, x), pose->offset);
    const double sliding = cam_sliding(&met, pose->offset, pose->velocity, a, b);
    return (TouchTravel){
        .turning = cam_turning(cam, &met, a, b, sliding),
        .along_b = cam_along_b(cam, &met, a, b, sliding),
    };
}

void touch_response(const Linkage *linkage, const Touch *places, size_t count, bool has_friction,
                    Response *response)
{
    ResponsePlace *rows = zeroed(count, sizeof *rows);
    for (size_t i = 0; i < count; i++) {
        const bool is_circle = !touch_is_scalar(&places[i]);
        const bool is_slot = touch_has_walls(&places[i]);
        rows[i] = (ResponsePlace){
            .joint = places[i].joint,
            // of a slot the rates of the pin's centre in the slot's own axes
            .is_line = is_slot || touch_rows(&places[i]) == TOUCH_ROWS_LINE,
            .sign = places[i].sign,
            .has_turns = has_friction && is_circle,
            .anchor_a = places[i].anchor_a,
            .anchor_b = places[i].anchor_b,
            .direction = places[i].direction,
            .radius = is_slot ? 0.0 : places[i].radius_b,
            .cam = places[i].cam,
        };
    }
    response_init_places(linkage, rows, count, response);
    free(rows);
}
