// The profile of a cam: a closed curve about a centre, by its distance from there over the angle;
// or the transmission error of gears over theirs.
//
// Between the given points a periodic spline of degree 5, whose first four derivatives are
// continuous: what rides on it meets no jump of a force, nor of its rates. Of a smooth curve by N
// points its error falls with N^-6.
#pragma once

#include "base/err.h"
#include "base/vec2.h"

#include <stdbool.h>
#include <stddef.h>

enum { PROFILE_MIN = 6, PROFILE_MAX = 400 }; // points: by degrees, and some

typedef struct Profile {
    size_t count;
    double period;  // rad, after which it comes again; 0: a turn
    bool is_signed; // whether it may have any sign: a transmission error, which has no centre
    double angles[PROFILE_MAX +
                  1]; // rad, increasing; the one behind the last a period after the first
    double radii[PROFILE_MAX + 1]; // m; of a cam above 0
    // by profile_settle: the derivatives there, m/rad and m/rad^2
    double slopes[PROFILE_MAX + 1];
    double bends[PROFILE_MAX + 1];
    double reach; // m, the largest radius
    double least; // m, the smallest
    // of a cam
    double least_hump;   // m, the smallest radius of curvature where it is convex
    double least_hollow; // m, where it is concave; infinite of a convex profile
    double hollow_at;    // rad, where that is
} Profile;

// Finds what follows from the points. Fails with ERR_CASE where they are too few, not in order
// within a turn, or not above 0.
bool profile_settle(Profile *profile, Err *err);

// The curve at an angle of any number of turns: the distance r, and its first two derivatives.
typedef struct ProfileAt {
    double r;  // m
    double r1; // m/rad
    double r2; // m/rad^2
} ProfileAt;

ProfileAt profile_at(const Profile *profile, double angle);

// The curvature there, 1/m: positive where the profile is convex.
double profile_curvature(const ProfileAt *at);

// Where the profile is nearest to a point, seen from the centre.
typedef struct ProfileNearest {
    double distance;  // m, negative inside
    Vec2 normal;      // unit, outward
    double curvature; // 1/m
} ProfileNearest;

ProfileNearest profile_nearest(const Profile *profile, Vec2 point);

// Where a convex profile reaches furthest along a unit direction, which is then its normal.
typedef struct ProfileFurthest {
    double reach; // m, along the direction
    Vec2 point;   // m, from the centre
    double curvature;
} ProfileFurthest;

ProfileFurthest profile_furthest(const Profile *profile, Vec2 direction);
