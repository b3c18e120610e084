// In which order are the unknowns of a tree with loops eliminated, and what meets in each step?
// Found once, from the tree alone.
//
// A front is one step: the rows of some loops, and what is eliminated is a body's freedom or the
// multipliers of the first of the loops. What is left of it goes into one later front. Source:
// Duff and Reid 1983, multifrontal elimination.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// The shape of a tree with loops, in the plane or in space.
typedef struct PlanShape {
    size_t node_count;
    const int *parents; // by node: the one it hangs on, which stands before it; -1: none
    size_t loop_count;
    const int (*ends)[2]; // by loop: the nodes at its two ends; -1: what no coordinate moves
    size_t rows;          // of each loop
} PlanShape;

// A front that comes into another, and where its loops are there.
typedef struct PlanChild {
    int front;
    size_t first_place; // into Plan.places: by loop of the child, the row in this front
} PlanChild;

// An end of a loop on the body of a front.
typedef struct PlanEnd {
    int loop;
    int side;   // 0: of body a
    size_t row; // first of the loop's in this front
} PlanEnd;

typedef struct PlanFront {
    int node;           // whose motion its rows feel; -1: none
    bool is_body;       // whether that node's freedom is eliminated, else the first loop
    size_t first_loop;  // into Plan.loops; each loop has PlanShape.rows
    size_t loop_count;  //
    size_t first_child; // into Plan.children
    size_t child_count; //
    size_t first_end;   // into Plan.ends
    size_t end_count;
} PlanFront;

typedef struct Plan {
    size_t front_count;
    PlanFront *fronts;
    size_t place_count;
    size_t *places;
    size_t loop_count;
    int *loops; // in the fronts
    size_t child_count;
    PlanChild *children;
    size_t end_count;
    PlanEnd *ends;
    int *front_of;       // by node: the front that eliminates its freedom; -1: no loop feels that
    size_t *fronts_from; // by node + 1, the ground before the first: where the fronts there begin;
                         // those of the last node are the first, those of the ground the last
} Plan;

void articulated_plan_make(const PlanShape *shape, Plan *plan);
void articulated_plan_finish(Plan *plan);
