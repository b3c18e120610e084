// Finds where the coordinate of a joint stands that flanks or stops limit.
//
//     revolute     q = phi_b - phi_a        (the other sign where b is the ground)
//     prismatic    q = t . d
//     gears        q = -(r_a (phi_a - phi_c) + r_b (phi_b - phi_c))
//     rack         q = t . d + r_b (phi_b - phi_a)
// t the line's direction on body a, d from anchor a to anchor b; r pitch radii, r_a + r_b the
// distance of the centres, c the carrier of both pivots. With u from centre a to centre b and t =
// perp u the pitch circles touch at P = centre a + r_a u, and
//     q' = t . (v_b(P) - v_a(P))
// while the pivots hold: a force t on body b at P, and the other way on body a, is the push along
// q. What bears the gears answers in the pivots. The pressure angle's part of the force, along u,
// does no work and is left out. Of a rack P = centre b - r_b perp t, wherever its guide and the
// pinion's pivot let the bodies be.
#include "model/coordinate.h"

#include <math.h>

double coordinate_low(const Joint *joint)
{
    const Limits *limits = &joint->limits;
    return limits->kind == LIMIT_BACKLASH ? limits->middle - 0.5 * limits->backlash : limits->low;
}

double coordinate_high(const Joint *joint)
{
    const Limits *limits = &joint->limits;
    return limits->kind == LIMIT_BACKLASH ? limits->middle + 0.5 * limits->backlash : limits->high;
}

double coordinate_play(const Joint *joint)
{
    const double play = 0.5 * (coordinate_high(joint) - coordinate_low(joint));
    return play > 0.0 ? play : INFINITY;
}

double coordinate_sense(const Joint *joint)
{
    return joint->body_b == LINKAGE_GROUND ? -1.0 : 1.0;
}

static double angle_of(const Motion *motions, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : motions[body].angle;
}

static double omega_of(const Motion *motions, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : motions[body].omega;
}

// How far anchor b is along the line of body a, and the rate of that.
static double along_line(const Linkage *linkage, const Motion *motions, int joint)
{
    const Vec2 gap = linkage_joint_gap(linkage, motions, joint).position;
    return vec2_dot(joint_rows_along(linkage, motions, joint), gap);
}

static double along_line_rate(const Linkage *linkage, const Motion *motions, int joint)
{
    const JointGap gap = linkage_joint_gap(linkage, motions, joint);
    const Vec2 along = joint_rows_along(linkage, motions, joint);
    const double a = omega_of(motions, linkage->joints[joint].body_a);
    return vec2_dot(along, gap.velocity) + a * vec2_dot(vec2_perp(along), gap.position);
}

double coordinate_position(const Linkage *linkage, const Motion *motions, int joint)
{
    const Joint *of = &linkage->joints[joint];
    const double a = angle_of(motions, of->body_a);
    const double b = angle_of(motions, of->body_b);
    switch (joint_coordinate(of->kind)) {
    case JOINT_COORDINATE_POSITION:
        return along_line(linkage, motions, joint);
    case JOINT_COORDINATE_TEETH: {
        const double carrier = angle_of(motions, of->gear.carrier);
        return -(of->gear.radius_a * (a - carrier) + of->gear.radius_b * (b - carrier));
    }
    case JOINT_COORDINATE_RACK:
        return along_line(linkage, motions, joint) + of->gear.radius_b * (b - a);
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_ANGLE:
        break;
    }
    return coordinate_sense(of) * (b - a);
}

double coordinate_rate(const Linkage *linkage, const Motion *motions, int joint)
{
    const Joint *of = &linkage->joints[joint];
    const double a = omega_of(motions, of->body_a);
    const double b = omega_of(motions, of->body_b);
    switch (joint_coordinate(of->kind)) {
    case JOINT_COORDINATE_POSITION:
        return along_line_rate(linkage, motions, joint);
    case JOINT_COORDINATE_RACK:
        return along_line_rate(linkage, motions, joint) + of->gear.radius_b * (b - a);
    case JOINT_COORDINATE_TEETH: {
        const double carrier = omega_of(motions, of->gear.carrier);
        return -(of->gear.radius_a * (a - carrier) + of->gear.radius_b * (b - carrier));
    }
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_ANGLE:
        break;
    }
    return coordinate_sense(of) * (b - a);
}

Vec2 coordinate_along_teeth(const Linkage *linkage, const Motion *motions, int joint)
{
    if (joint_has_rack(linkage->joints[joint].kind)) {
        return joint_rows_along(linkage, motions, joint);
    }
    const Vec2 between = linkage_joint_gap(linkage, motions, joint).position;
    return vec2_perp(vec2_scale(1.0 / vec2_length(between), between));
}

// A force along a direction at a point of both bodies.
static void push_at(const Linkage *linkage, const Motion *motions, int joint, Vec2 direction,
                    Vec2 point, JointRow *row)
{
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(&linkage->joints[joint], side).body;
        const double sign = side == 0 ? -1.0 : 1.0;
        const Vec2 arm = body == LINKAGE_GROUND ? point : vec2_sub(point, motions[body].position);
        row->x[side] = sign * direction.x;
        row->y[side] = sign * direction.y;
        row->turn[side] = sign * vec2_cross(arm, direction);
    }
}

void coordinate_row(const Linkage *linkage, const Motion *motions, int joint, JointRow *row)
{
    const Joint *of = &linkage->joints[joint];
    switch (joint_coordinate(of->kind)) {
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_ANGLE:
        *row = (JointRow){.turn = {-coordinate_sense(of), coordinate_sense(of)}};
        break;
    case JOINT_COORDINATE_POSITION:
        push_at(linkage, motions, joint, joint_rows_along(linkage, motions, joint),
                linkage_point(motions, of->body_b, of->anchor_b), row);
        break;
    case JOINT_COORDINATE_TEETH: {
        const Vec2 along = coordinate_along_teeth(linkage, motions, joint);
        const Vec2 centre = linkage_point(motions, of->body_a, of->anchor_a);
        // from centre a to centre b is the direction turned back
        const Vec2 outward = vec2_scale(-of->gear.radius_a, vec2_perp(along));
        push_at(linkage, motions, joint, along, vec2_add(centre, outward), row);
        break;
    }
    case JOINT_COORDINATE_RACK: {
        const Vec2 along = coordinate_along_teeth(linkage, motions, joint);
        const Vec2 centre = linkage_point(motions, of->body_b, of->anchor_b);
        const Vec2 inward = vec2_scale(-of->gear.radius_b, vec2_perp(along));
        push_at(linkage, motions, joint, along, vec2_add(centre, inward), row);
        break;
    }
    }
}
