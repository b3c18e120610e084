// The bodies of a tree that ideal joints tie to one another, part by part: pushes on one part
// accelerate that part alone.
#pragma once

#include "reference/articulated_plan.h"

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
