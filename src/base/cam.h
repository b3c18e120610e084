// A cam and what rides on it: a roller or knife edge of body b, or a flat of body b, at a profile
// of body a.
//
// With P where the gap is measured (the roller's centre, or the point of the flat before the
// profile's), n the outward normal and t = perp n, w = t . (v_b(P) - v_a(P)) and k the curvature of
// the curve through P that is parallel to the profile:
//     g'  = n . (v_b(P) - v_a(P))
//     g'' = n . (a_b(P) - a_a(P)) + 2 w_a w + k w^2             roller
//           n . (a_b(P) - a_a(P)) + 2 w_b w - (w_b - w_a)^2 / k  flat
// w_a, w_b how fast the bodies turn.
#pragma once

#include "base/profile.h"
#include "base/vec2.h"

typedef struct Cam {
    const Profile *profile; // NULL: there is none
    double direction;       // rad, in body a's frame: where the profile's angles count from
    double radius;          // m, of the roller; 0: a knife edge
    bool is_flat;
    double facing; // rad, in body b's frame: the direction towards the profile of a flat
} Cam;

typedef struct CamPose {
    double gap;       // m, negative inside the metal
    Vec2 normal;      // unit, outward of the profile: of the force on body b
    Vec2 from_b;      // m, from the anchor on body b to where they touch, on body b
    Vec2 measured;    // m, likewise to P above
    double curvature; // 1/m, k above
} CamPose;

// Where the two are: with the unit vectors from which the profile's angles count and in which a
// flat faces, and the offset of the anchor on body b (the roller's centre, or a point of the flat)
// from the profile's centre, all in one frame.
CamPose cam_pose(const Cam *cam, Vec2 zero, Vec2 facing, Vec2 offset);

// The rate of the gap, m/s, with the velocity of the anchor on body b less that of the centre, m/s;
// and the sliding w at P.
double cam_rate(const CamPose *pose, Vec2 offset, Vec2 velocity, double omega_a, double omega_b);
double cam_sliding(const CamPose *pose, Vec2 offset, Vec2 velocity, double omega_a, double omega_b);

// How fast the normal turns, rad/s.
double cam_turning(const Cam *cam, const CamPose *pose, double omega_a, double omega_b,
                   double sliding);

// How fast the point where they touch goes on body b along perp n, m/s.
double cam_along_b(const Cam *cam, const CamPose *pose, double omega_a, double omega_b,
                   double sliding);

// What the second rate of the gap has beside n . (a_b(P) - a_a(P)), m/s^2.
double cam_bend(const Cam *cam, const CamPose *pose, double omega_a, double omega_b,
                double sliding);
