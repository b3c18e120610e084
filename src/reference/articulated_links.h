// What the elimination of bodies (reference/articulated.h) works with: a link for each body, and
// the fronts of those that slide or that loops hang on.
#pragma once

#include "reference/articulated_plan.h"

typedef enum LinkKind {
    LINK_HINGE,    // hangs on a revolute joint
    LINK_SLIDE,    // on a prismatic one
    LINK_FLOATING, // on nothing
} LinkKind;

// A body, and all that hangs on it.
typedef struct ArticulatedLink {
    LinkKind kind;
    bool has_fronts; // whether there are fronts at it, and whether one eliminates its own freedom
    bool has_own_front; //
    double mass;        // kg
    double inertia;     // kg m^2, about the reference
    // turned by a quarter turn, m
    Vec2 centre;    // from the reference to the centre of mass
    Vec2 lever;     // from the parent's reference to this one
    Vec2 direction; // unit, not turned: that a slide goes along
    // what it resists with: A, b, J; after elimination what is left of A
    double xx;
    double xy;
    double yy;
    Vec2 b;
    double j;
    // of the elimination
    double inverse; // 1 / J
    Vec2 share;     // b / J
    double slope;   // A_xy / A_xx, of a floating body
    // of a solution
    Vec2 force;    // N, at the reference
    double moment; // N m, about it
    Vec2 motion;   // of the reference
    double spin;
    double slide; // of its own coordinate
} ArticulatedLink;

// What one row of a front becomes in the next: a combination of rows there.
typedef struct FrontTarget {
    size_t count;
    size_t rows[3];
    double shares[3];
} FrontTarget;

typedef struct Articulated {
    const Tree *tree;
    Plan plan;
    size_t loop_count;
    int *loops; // joints
    ArticulatedLink *links;
    double **matrices; // by front; upper triangles, of what is eliminated 1 / pivot and the row
    double **vectors;
    FrontTarget *targets; // room, by row of a front
} Articulated;

// How the reference of a body moves with what it hangs on.
static inline Vec2 articulated_at(const ArticulatedLink *link, const ArticulatedLink *parent)
{
    return parent == NULL ? (Vec2){0.0, 0.0}
                          : vec2_add(parent->motion, vec2_scale(parent->spin, link->lever));
}
