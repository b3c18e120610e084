// What the elimination of bodies (reference/articulated.h) works with: a link for each body, and
// the rows of loops that feel it.
#pragma once

#include "reference/articulated_parts.h"
#include "reference/tree.h"

typedef enum LinkKind {
    LINK_HINGE,    // hangs on a revolute joint
    LINK_SLIDE,    // on a prismatic one
    LINK_FLOATING, // on nothing
} LinkKind;

// What bodies that hang on another add to it.
typedef struct ArticulatedGathered {
    double xx;
    double xy;
    double yy;
    Vec2 b;
    double j;
    Vec2 force;
    double moment;
} ArticulatedGathered;

// A force at a body's centre, N, and the moment about it, N m.
typedef struct ArticulatedPush {
    Vec2 force;
    double moment;
} ArticulatedPush;

// A body, and all that hangs on it.
typedef struct ArticulatedLink {
    LinkKind kind;
    bool has_fronts; // whether there are fronts at it, and whether one eliminates its own freedom
    bool has_own_front; //
    int parent;         // link that it hangs on, or -1
    int body;           //
    int parent_end;     // of the tree
    int own_end;        //
    bool has_children;  // whether bodies hang on it
    size_t column;      // coordinate
    double mass;        // kg
    double inertia;     // kg m^2, about the reference
    // turned by a quarter turn, m
    Vec2 centre;    // from the reference to the centre of mass
    Vec2 lever;     // from the parent's reference to this one
    Vec2 direction; // unit, not turned: along which it slides
    // what it resists with: A, b, J; after elimination what is left of them
    double xx;
    double xy;
    double yy;
    Vec2 b;
    double j;
    // of the elimination
    double inverse;    // 1 / pivot: J, or A along the slide
    Vec2 share;        // what couples the pivot with the motion, times that
    double spin_share; // and with the spin, of a slide
    double slope;      // A_xy / A_xx, of a floating body
    // of a solution
    Vec2 force;       // N, at the reference
    double moment;    // N m, about it
    double own_force; // on its own freedom: the moment, or the force along the slide
    Vec2 motion;      // of the reference
    double spin;
    double slide;                 // of its own coordinate
    ArticulatedGathered gathered; // in reference/articulated_tree.c
} ArticulatedLink;

// How a row of a loop feels the motion of a body's reference, and its spin.
typedef struct LoopRow {
    Vec2 motion;
    double spin;
} LoopRow;

// The rows of a front.
typedef struct FrontRows {
    LoopRow *rows;
    double *square;    // what is left of the loops among one another, row by row
    double *own;       // what each row had of the freedom that is eliminated
    double *along;     // and of a floating body's motion
    double *across;    //
    double *vector;    // of a solution
    double inverse[2]; // of the two rows that are eliminated: 1 / pivot
} FrontRows;

typedef struct Articulated {
    const Tree *tree;
    Plan plan;
    ArticulatedParts parts;
    size_t loop_count;
    int *loops; // joints
    ArticulatedLink *links;
    FrontRows *fronts;
    bool is_plain;    // whether it is a tree of hinges and floating bodies without loops
    bool is_factored; // whether the last elimination had a solution
} Articulated;
