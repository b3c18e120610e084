// The positions that a linkage with ideal joints and one freedom can take: a path, followed by its
// arc length from one position to the next, also around points where the crank has to turn back.
#pragma once

#include "model/groups.h"
#include "model/kinematics.h"

typedef struct ClosedPath {
    const Linkage *linkage;
    double size; // m, lengths are measured in it
    size_t columns;
    double at[KINEMATICS_COLUMN_MAX];      // x / size, y / size and angle, rad, of each body
    double tangent[KINEMATICS_COLUMN_MAX]; // of length one: rate of each by arc length
    double weakest[KINEMATICS_COLUMN_MAX]; // direction in which the joints hold least, as found
    double firmness;                       // how well they hold there: 0 where two paths cross
    double firmness_most;                  // largest so far
} ClosedPath;

// Starts at motions in which every joint is closed to a few digits, in the direction that turns the
// driven body as its driver does. Fails where that direction is not determined: at a dead centre,
// where paths cross, or with more than one freedom.
bool closed_path_start(const Linkage *linkage, const Motion *motions, ClosedPath *path);

// The position and tangent at an arc length further on. Returns false, with `next` not to be used,
// where that is too far: Newton's method does not find it or the path has bent too much.
bool closed_path_step(const ClosedPath *path, double length, ClosedPath *next);

// The length that the next step may have, so that it does not jump from one path to a near one.
double closed_path_reach(const ClosedPath *path);

// Angle of the driven body, rad, and its rate by arc length in the direction of the driver.
double closed_path_crank(const ClosedPath *path);
double closed_path_crank_rate(const ClosedPath *path);

// The determinant of the rows of a group of its bodies, scaled, with the rest held. While the crank
// goes on turning it changes sign where the group can go on in two ways.
double closed_path_determinant(const ClosedPath *path, const Group *group);
