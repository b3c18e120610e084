// Finds where the coordinate of a joint stands that flanks or stops limit.
//
//     revolute     q = phi_b - phi_a        (the other sign where b is the ground)
//     prismatic    q = t . d
//     gears        base/mesh.h
//     rack         q = t . d + r_b (phi_b - phi_a)
// t the line's direction on body a, d from anchor a to anchor b; r_b the pitch radius. A push along
// the coordinate of teeth is a force on body b, and the other way on body a, at P: of a rack along
// t at centre b - r_b perp t, of gears along the line of action where it meets the line of the
// centres. Both hold wherever guides and pivots let the bodies be; what bears the bodies answers
// there.
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
    case JOINT_COORDINATE_TEETH:
        return mesh_position(&of->gear, linkage_joint_gap(linkage, motions, joint).position, a, b,
                             of->limits.middle);
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
        const JointGap gap = linkage_joint_gap(linkage, motions, joint);
        return mesh_position_rate(&of->gear, gap.position, gap.velocity, a, b);
    }
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_ANGLE:
        break;
    }
    return coordinate_sense(of) * (b - a);
}

Mesh coordinate_mesh(const Linkage *linkage, const Joint *joint)
{
    const Gear *gear = &joint->gear;
    return (Mesh){
        .gear = gear,
        .error = gear->error > 0 ? &linkage->profiles[gear->error - 1] : NULL,
        .relief = gear->relief > 0 ? &linkage->profiles[gear->relief - 1] : NULL,
    };
}

MeshFlank coordinate_flank(const Linkage *linkage, const Motion *motions, int joint, double sign)
{
    const Joint *of = &linkage->joints[joint];
    const Mesh mesh = coordinate_mesh(linkage, of);
    return mesh_flank(&mesh, sign, linkage_joint_gap(linkage, motions, joint).position,
                      angle_of(motions, of->body_a), angle_of(motions, of->body_b));
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

void coordinate_row(const Linkage *linkage, const Motion *motions, int joint, double sign,
                    JointRow *row)
{
    const Joint *of = &linkage->joints[joint];
    const double turn = sign * coordinate_sense(of);
    switch (joint_coordinate(of->kind)) {
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_ANGLE:
        *row = (JointRow){.turn = {-turn, turn}};
        break;
    case JOINT_COORDINATE_POSITION:
        push_at(linkage, motions, joint,
                vec2_scale(sign, joint_rows_along(linkage, motions, joint)),
                linkage_point(motions, of->body_b, of->anchor_b), row);
        break;
    case JOINT_COORDINATE_TEETH: {
        const MeshFlank flank = coordinate_flank(linkage, motions, joint, sign);
        const Vec2 centre = linkage_point(motions, of->body_b, of->anchor_b);
        push_at(linkage, motions, joint, flank.normal, vec2_add(centre, flank.from_b), row);
        break;
    }
    case JOINT_COORDINATE_RACK: {
        const Vec2 along = vec2_scale(sign, joint_rows_along(linkage, motions, joint));
        const Vec2 centre = linkage_point(motions, of->body_b, of->anchor_b);
        const Vec2 inward = vec2_scale(-sign * of->gear.radius_b, vec2_perp(along));
        push_at(linkage, motions, joint, along, vec2_add(centre, inward), row);
        break;
    }
    }
}
