// The order in which the unknowns of a tree with loops are eliminated, and what meets in each step.
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
    size_t first_child_row; // into Plan.child_rows: by loop of the child, the row in this front
} PlanChild;

// An end of a loop on the body of a front.
typedef struct PlanEnd {
    int loop;
    int side;   // 0: of body a
    size_t row; // first of the loop's in this front
} PlanEnd;

typedef struct PlanFront {
    int node;           // whose motion its rows depend on; -1: none
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
    size_t child_row_count;
    size_t *child_rows;
    size_t loop_count;
    int *loops; // in the fronts
    size_t child_count;
    PlanChild *children;
    size_t end_count;
    PlanEnd *ends;
    int *front_of; // by node: the front that eliminates its freedom; -1: no loop depends on that
    size_t *fronts_from; // by node + 1, the ground before the first: where the fronts there begin;
                         // those of the last node are the first, those of the ground the last
} Plan;

void articulated_plan_make(const PlanShape *shape, Plan *plan);
void articulated_plan_finish(Plan *plan);

// The bodies of a tree that ideal joints tie to one another, part by part: pushes on one part
// accelerate that part alone.

typedef struct ArticulatedParts {
    size_t count;
    size_t *of_node;     // by node; owned, like all below
    size_t *first_node;  // by part and one more: where its nodes begin
    size_t *nodes;       // part by part, in order
    size_t *first_front; // by part and one more: where its fronts at the ground begin
    size_t *fronts;      // part by part, in order
} ArticulatedParts;

// One of them.
typedef struct ArticulatedPart {
    size_t node_count;
    const size_t *nodes; // in order
    size_t front_count;
    const size_t *fronts; // at the ground, in order
} ArticulatedPart;

static inline ArticulatedPart articulated_part(const ArticulatedParts *parts, size_t part)
{
    const size_t node = parts->first_node[part];
    const size_t front = parts->first_front[part];
    return (ArticulatedPart){
        .node_count = parts->first_node[part + 1] - node,
        .nodes = parts->nodes + node,
        .front_count = parts->first_front[part + 1] - front,
        .fronts = parts->fronts + front,
    };
}

// The nodes of a part, or of a whole tree of so many (NULL).
static inline size_t articulated_part_count(const ArticulatedPart *part, size_t node_count)
{
    return part != NULL ? part->node_count : node_count;
}

static inline size_t articulated_part_node(const ArticulatedPart *part, size_t number)
{
    return part != NULL ? part->nodes[number] : number;
}

// Of the shape that the plan is made for.
void articulated_parts_find(const PlanShape *shape, const Plan *plan, ArticulatedParts *parts);
void articulated_parts_finish(ArticulatedParts *parts);
