// Random poses of a pin in a hole, and how right a collider's answers are there.
//
// The truth is worked out from the corners of the polygon and, for the circle, from the pose as it
// was drawn, in long double and without any of the program's geometry.
#pragma once

#include "ode/plane/collider.h"

#include <stddef.h>
#include <stdint.h>

typedef struct Pose {
    Vec2 hole;            // m, the hole's centre in the world
    double turn;          // rad, of the hole
    Vec2 pin;             // m, the pin's centre in the world
    Vec2 outward;         // unit, from the hole's centre to the pin's
    double circle_depth;  // m, overlap with the circle; negative in the play
    double polygon_depth; // m, overlap with the side of the polygon that is overlapped most
} Pose;

typedef struct Poses {
    const Scenario *scenario;
    int joint;
    size_t count;
    Pose *poses; // owned
} Poses;

// Half of the poses overlap the circle, by 1e-10 m up to the play, even on a logarithmic scale; the
// others are as far from the wall. The hole stands anywhere within 0.3 m, turned anyhow.
Poses collider_poses_make(const Scenario *scenario, int joint, size_t count, uint64_t seed);
void collider_poses_finish(Poses *poses);

enum { POSE_DECADES = 6 };

// Poses that overlap the circle by 1e-10 to 1e-9 m, and so on, each decade of its own.
typedef struct PoseDecade {
    size_t asked;
    size_t found;
    double error; // 1, mean of the found: of the depth, over the polygon's
} PoseDecade;

typedef struct PoseFigures {
    size_t contacts;       // found
    size_t missed;         // deeper in the polygon than a limit, and not found
    size_t invented;       // further than that from the polygon, and found
    size_t outward;        // the normal presses the pin out of its hole
    double missed_depth;   // m, the deepest that was not found, whatever the limit
    double polygon_median; // m, depth against the polygon's
    double polygon_max;
    double circle_median; // m, depth against the circle's
    double circle_max;
    double normal_median; // rad, against the circle's normal
    double normal_max;
    PoseDecade decades[POSE_DECADES];
    double query_s; // of the processor, median of batches; NAN of fewer than 100 poses
} PoseFigures;

// Asks a collider about all poses. Missed and invented contacts count beyond a limit, m.
PoseFigures collider_poses_ask(const Poses *poses, const Collider *collider, double limit);
