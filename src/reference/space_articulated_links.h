// What the elimination of bodies in space (reference/space_articulated.h) works with: a link for
// each body, and the rows of loops that feel it.
#pragma once

#include "reference/articulated_parts.h"
#include "reference/space_tree.h"

enum { SPACE_LINK_FREEDOMS = 6 };

// A force at a body's centre, N, and the moment about it, N m.
typedef struct SpacePush {
    Vec3 force;
    Vec3 moment;
} SpacePush;

// A row of a loop: of its point along a direction of the world, or of its turning about one. One
// that is not held has no part in the equations.
typedef struct SpaceLoopRow {
    bool is_held;
    Vec3 direction;
} SpaceLoopRow;

// A body, and all that hangs on it. Its reference is its pin, or the centre where it floats.
typedef struct SpaceLink {
    bool is_floating;
    bool has_fronts;    // whether there are fronts at it, and whether one eliminates its freedom
    bool has_own_front; //
    int parent;         // link that it hangs on, or -1
    int body;           //
    int own_end;        // of the tree
    int parent_end;     //
    size_t freedoms;    // that are eliminated: 1 of a hinge, or 6
    size_t first;       // coordinate
    Vec3 centre;        // m, from the reference to the centre of mass
    Vec3 lever;         // m, from the parent's reference to this one
    // what it resists with, by the motion of the reference and by its turning:
    //     force = a motion + b turning,   moment = b' motion + j turning
    Mat3 a;
    Mat3 b;
    Mat3 j;
    // of the elimination: of a hinge its axis, the force and the moment that turning about it
    // takes, over the root of what that takes along itself; of a floating body Cholesky's factor
    Vec3 axis;
    double root; // 1 / sqrt(axis j axis)
    Vec3 force_share;
    Vec3 moment_share;
    double factor[SPACE_LINK_FREEDOMS][SPACE_LINK_FREEDOMS];
    // of a solution
    Vec3 force;                         // N, at the reference
    Vec3 moment;                        // N m, about it
    double gained[SPACE_LINK_FREEDOMS]; // forward through the factor, of the freedoms eliminated
    Vec3 motion;                        // of the reference
    Vec3 turning;
} SpaceLink;

// How a row of a loop feels the motion of a body's reference, and its turning.
typedef struct SpaceFeel {
    Vec3 motion;
    Vec3 turning;
} SpaceFeel;

// The rows of a front.
typedef struct SpaceFront {
    SpaceFeel *rows;
    double *square; // what is left of the loops among one another, row by row
    double *own;    // by row: what it had of the freedoms that are eliminated, through their factor
    double *vector; // of a solution
    double inverse[SPACE_JOINT_ROWS]; // of the rows that are eliminated: 1 / pivot; 0: not held
} SpaceFront;

typedef struct SpaceArticulated {
    const SpaceTree *tree;
    Plan plan;
    ArticulatedParts parts;
    int *loops; // joints
    SpaceLink *links;
    SpaceFront *fronts;
} SpaceArticulated;

// Through the factor of a floating body: L^-1 b, in place.
static inline void space_link_forward(const SpaceLink *link, double *b)
{
    for (int i = 0; i < SPACE_LINK_FREEDOMS; i++) {
        for (int k = 0; k < i; k++) {
            b[i] -= link->factor[i][k] * b[k];
        }
        b[i] *= link->factor[i][i];
    }
}
