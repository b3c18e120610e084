// Finds how far a hinge in space has turned about its axis.
//
// With u the axis on body a and s_a, s_b a direction at right angles to it that both bodies carry
// and that is one at time zero:
//     q - q_0 = +- atan2(u . (s_a x s_b), s_a . s_b)
#include "model/space_coordinate.h"

double space_coordinate_start(const Linkage *linkage, int joint)
{
    const Joint *of = &linkage->joints[joint];
    const Vec3 axis = of->space.axis;
    if (axis.x != 0.0 || axis.y != 0.0 || axis.z < 0.0) {
        return 0.0;
    }
    const double a = of->body_a == LINKAGE_GROUND ? 0.0 : linkage->bodies[of->body_a].start.angle;
    const double b = of->body_b == LINKAGE_GROUND ? 0.0 : linkage->bodies[of->body_b].start.angle;
    return coordinate_sense(of) * (b - a);
}

// A direction of time zero that a body carries, now.
static Vec3 carried(const Linkage *linkage, const SpaceMotion *motions, int body, Vec3 start)
{
    return body == LINKAGE_GROUND ? start
                                  : quat_rotate(motions[body].turn,
                                                space_own_direction(&linkage->bodies[body], start));
}

double space_coordinate_near(const Linkage *linkage, const SpaceMotion *motions, int joint,
                             double near)
{
    const Joint *of = &linkage->joints[joint];
    const Vec3 side = vec3_normal_to(of->space.axis);
    const Vec3 axis = carried(linkage, motions, of->body_a, of->space.axis);
    const Vec3 a = carried(linkage, motions, of->body_a, side);
    const Vec3 b = carried(linkage, motions, of->body_b, side);
    // of vectors that are nearly one their difference has the digits
    const double sine = vec3_dot(axis, vec3_cross(a, vec3_sub(b, a)));
    const double turned = coordinate_sense(of) * atan2(sine, vec3_dot(a, b));
    const double angle = space_coordinate_start(linkage, joint) + turned;
    return near + remainder(angle - near, 2.0 * M_PI);
}

Vec3 space_coordinate_axis(const Linkage *linkage, const SpaceMotion *motions, int joint)
{
    const Joint *of = &linkage->joints[joint];
    return vec3_scale(coordinate_sense(of), carried(linkage, motions, of->body_a, of->space.axis));
}

SpaceRow space_coordinate_row(const Linkage *linkage, const SpaceMotion *motions, int joint)
{
    const Joint *of = &linkage->joints[joint];
    const Vec3 axis = space_coordinate_axis(linkage, motions, joint);
    SpaceRow row = {.body = {of->body_a, of->body_b}};
    row.angular[0] = vec3_scale(of->body_a == LINKAGE_GROUND ? 0.0 : -1.0, axis);
    row.angular[1] = vec3_scale(of->body_b == LINKAGE_GROUND ? 0.0 : 1.0, axis);
    return row;
}

double space_coordinate_rate(const Linkage *linkage, const SpaceMotion *motions, int joint)
{
    const SpaceRow row = space_coordinate_row(linkage, motions, joint);
    return space_row_speed(&row, motions);
}
