// Finds the gap between a cam's profile and its follower, and its rates.
#include "base/cam.h"

#include <math.h>

// Turned by the angle of a unit vector, and back.
static Vec2 turn(Vec2 by, Vec2 vector)
{
    return (Vec2){by.x * vector.x - by.y * vector.y, by.y * vector.x + by.x * vector.y};
}

static Vec2 turn_back(Vec2 by, Vec2 vector)
{
    return turn((Vec2){by.x, -by.y}, vector);
}

static CamPose roller_pose(const Cam *cam, Vec2 zero, Vec2 offset)
{
    const ProfileNearest nearest = profile_nearest(cam->profile, turn_back(zero, offset));
    const Vec2 normal = turn(zero, nearest.normal);
    return (CamPose){
        .gap = nearest.distance - cam->radius,
        .normal = normal,
        .from_b = vec2_scale(-cam->radius, normal),
        .curvature = nearest.curvature / (1.0 + nearest.curvature * nearest.distance),
    };
}

static CamPose flat_pose(const Cam *cam, Vec2 zero, Vec2 facing, Vec2 offset)
{
    const Vec2 normal = vec2_scale(-1.0, facing);
    const ProfileFurthest furthest = profile_furthest(cam->profile, turn_back(zero, normal));
    const double gap = vec2_dot(normal, offset) - furthest.reach;
    const Vec2 before = vec2_add(turn(zero, furthest.point), vec2_scale(gap, normal));
    return (CamPose){
        .gap = gap,
        .normal = normal,
        .from_b = vec2_sub(before, offset),
        .measured = vec2_sub(before, offset),
        .curvature = furthest.curvature / (1.0 + furthest.curvature * gap),
    };
}

CamPose cam_pose(const Cam *cam, Vec2 zero, Vec2 facing, Vec2 offset)
{
    return cam->is_flat ? flat_pose(cam, zero, facing, offset) : roller_pose(cam, zero, offset);
}

// The velocity of body b at a point, seen from its anchor, less that of body a there.
static Vec2 velocity_at(Vec2 from_b, Vec2 offset, Vec2 velocity, double omega_a, double omega_b)
{
    const Vec2 from_a = vec2_add(offset, from_b);
    return vec2_add(velocity, vec2_sub(vec2_scale(omega_b, vec2_perp(from_b)),
                                       vec2_scale(omega_a, vec2_perp(from_a))));
}

double cam_rate(const CamPose *pose, Vec2 offset, Vec2 velocity, double omega_a, double omega_b)
{
    return vec2_dot(pose->normal, velocity_at(pose->measured, offset, velocity, omega_a, omega_b));
}

double cam_sliding(const CamPose *pose, Vec2 offset, Vec2 velocity, double omega_a, double omega_b)
{
    return vec2_dot(vec2_perp(pose->normal),
                    velocity_at(pose->measured, offset, velocity, omega_a, omega_b));
}

double cam_turning(const Cam *cam, const CamPose *pose, double omega_a, double omega_b,
                   double sliding)
{
    return cam->is_flat ? omega_b : omega_a + pose->curvature * sliding;
}

double cam_along_b(const Cam *cam, const CamPose *pose, double omega_a, double omega_b,
                   double sliding)
{
    return cam->is_flat
               ? (omega_b - omega_a) / pose->curvature - sliding
               : cam->radius * (omega_b - cam_turning(cam, pose, omega_a, omega_b, sliding));
}

double cam_bend(const Cam *cam, const CamPose *pose, double omega_a, double omega_b, double sliding)
{
    const double rolling = omega_b - omega_a;
    return cam->is_flat ? 2.0 * omega_b * sliding - rolling * rolling / pose->curvature
                        : sliding * (2.0 * omega_a + pose->curvature * sliding);
}
