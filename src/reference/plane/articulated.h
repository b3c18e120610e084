// The equations that say how a tree with loops accelerates under forces on its bodies:
//     M x = B^T f + J^T lambda,   J x = g
// in time and memory linear in the number of bodies, for trees, chains and loops in a row.
//
// Bodies are eliminated from the leaves inwards (articulated bodies: Featherstone 1983). What is
// left of a body whose joint turns freely is a mass at its pin alone, 2 by 2. A loop's multipliers
// are carried inwards by what they do to the pins of both its ends, and eliminated where these come
// together, at the innermost body that both ends hang on. There, and there alone, every pivot is
// one of M or of J M^-1 J^T: it vanishes only where the equations have no solution. Loops that come
// together at one body or at the ground are eliminated in an order that fills in little.
#pragma once

#include "reference/articulated_plan.h"
#include "reference/plane/tree.h"

// What the elimination works with: a link for each body, and the rows of loops that act on it.

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
    ArticulatedGathered gathered; // in reference/plane/articulated.c
} ArticulatedLink;

typedef struct FrontRows FrontRows; // of reference/plane/articulated.c

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
    bool notes_distance;
    double distance; // 1: of the last articulated_factor, from a change point: the least sine of
                     // the angle between a row of the loops and those eliminated before it
} Articulated;

// For the loops of some joints. The tree must outlive it. Never NULL; the caller destroys it.
Articulated *articulated_create(const Tree *tree, size_t loop_count, const int *loops);
void articulated_destroy(Articulated *articulated);

// Eliminates the unknowns at a state of the tree. Returns false where the equations have no
// solution.
bool articulated_factor(Articulated *articulated, const TreeState *state);

// Solves them for pushes, by body, and the loops' right sides (two numbers each, in the rows of
// loops_row; NULL: zeros). Writes the coordinates' rates x, and behind them the negative
// multipliers of the loops' rows, two each: what the joint gives its body b.
void articulated_solve(Articulated *articulated, const ArticulatedPush *pushes, const double *sides,
                       double *rates);

// The same of a part of the tree (Articulated.parts) and sides of zeros: reads the pushes and
// writes the rates of its bodies and loops alone.
void articulated_solve_part(Articulated *articulated, size_t part, const ArticulatedPush *pushes,
                            double *rates);

// Both at once, of pushes less what the bodies' bias takes of them (TreeState.bias): writes the
// second rates.
bool articulated_accelerate(Articulated *articulated, const TreeState *state,
                            const ArticulatedPush *pushes, const double *sides, double *rates);

// The same where the last elimination was at these coordinates, whatever their rates are now.
bool articulated_accelerate_again(Articulated *articulated, const TreeState *state,
                                  const ArticulatedPush *pushes, const double *sides,
                                  double *rates);

// The ideal joints that close loops of a tree: their constraint rows, and how they are kept.

// Adds to a row, a vector for each coordinate, the velocity of a pair's end on body b less that of
// the end on body a; of a pair with a line less that of the point of body a under the end on body
// b.
void loops_pair_row(const Tree *tree, const TreeState *state, int pair, Vec2 *row);

// The rates of the two rows of a joint that closes a loop (model/joint_rows.h) while the
// coordinates' rates are steady, m/s^2 or rad/s^2.
Vec2 loops_bias(const Tree *tree, const TreeState *state, size_t loop);

// What closing loops needs: a tree and the loops of some of its joints, and room to work in.
typedef struct LoopsRoom {
    const Tree *tree;
    size_t loop_count;
    const int *loops; // their joints
    Articulated *articulated;
    TreeState *state;
    ArticulatedPush *pushes; // by body: zeros
    double *sides;           // two a loop
    double *solved;          // by coordinate, and two a loop
} LoopsRoom;

// Moves coordinates and rates by the least that closes every loop, at a time since the base: the
// least in the bodies' kinetic energy. Returns the largest gap left in any loop, m (of a tilt with
// a lever of a metre); 0 where there are none.
double loops_project(const LoopsRoom *room, double since_s, double *q, double *u);

// Moves the base, coordinates and rates of a start onto the closed loops. Where there is a driver
// each pin is brought to its start in the hole as well, and each block to its own: a start is known
// to the rounding of positions, and a play of a micron has few digits left of that.
void loops_start(Tree *tree, const LoopsRoom *room, double *q, double *u);
