// A mechanism as a tree of bodies, for engines whose coordinates are those of joints: which joint
// carries each body, which joints are left over to close loops, and how the bodies move.
#pragma once

#include "drivers/common/actions.h"

typedef enum TreeKind {
    TREE_TURNS,  // about a point of its parent: one coordinate, the angle
    TREE_SLIDES, // along a line of its parent: one coordinate, the way along it
    TREE_FREE,   // x and y of its centre, and its angle
} TreeKind;

// A body in the tree. Coordinates are 0 where the bodies are at the start.
typedef struct TreeBody {
    TreeKind kind;
    int parent;   // or DRIVER_GROUND; of TREE_FREE as well
    int joint;    // that carries it; -1 of TREE_FREE
    size_t first; // its first coordinate, and how many
    size_t count;
    Vec2 anchor; // of TREE_TURNS: the pivot, in its own frame
    Vec2 axis;   // of TREE_SLIDES: in its own frame, which keeps its angle to the parent
    Vec2 offset; // in the parent's frame: the pivot, or its centre at the start
    double turn; // its angle less the parent's at the start
} TreeBody;

// Where a body has been put last, from which its velocities follow without sines and cosines.
typedef struct TreePlaced {
    Vec2 position;
    double angle;
    Vec2 pivot; // from the parent's centre to the pivot, or to its own centre
    Vec2 arm;   // from its centre to the pivot, or its axis
} TreePlaced;

typedef struct Tree {
    const DriverCase *of;
    TreeBody *bodies; // by body; owned, as the next
    size_t *order;    // bodies, parents first
    bool *is_left;    // by joint: an ideal one that the tree does not hold
    size_t coordinates;
    size_t left_count;
    Vec2 *bends;        // room, by body
    TreePlaced *placed; // by body, at these coordinates; not for callers
    double *coordinates_placed;
} Tree;

// The tree of a case, by sliding joints first. Refuses a case with a sliding joint in a loop of
// ideal joints that would be left over.
Tree tree_make(const DriverCase *of);

// Refuses drives of bodies that other joints hold in the tree.
void tree_check_drives(const Tree *tree);

// The rates of the coordinates at the start.
void tree_start(const Tree *tree, double *rates);

// How all bodies move, from the coordinates and their rates.
void tree_motions(const Tree *tree, const double *coordinates, const double *rates,
                  DriverMotion *motions);

// What the centres of all bodies are accelerated by where no rate changes, m/s^2.
void tree_bends(const Tree *tree, const DriverMotion *motions, const double *rates, Vec2 *bends);

// Adds what a force on a point of a body does to the forces along the coordinates.
void tree_push(const Tree *tree, const DriverMotion *motions, int body, Vec2 local, Vec2 force,
               double *pushes);

// Adds what a moment on a body does, N m.
void tree_turn(const Tree *tree, int body, double moment, double *pushes);

// Adds what forces and moments on all bodies do.
void tree_act(const Tree *tree, const DriverMotion *motions, const DriverAction *actions,
              double *pushes);
