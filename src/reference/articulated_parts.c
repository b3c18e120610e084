// Which bodies of a tree do ideal joints tie to one another?
//
// A body and what hangs on it, and the bodies at both ends of a loop. The ground and the driven
// body, which nothing moves, tie nothing.
#include "reference/articulated_parts.h"

#include "base/grouped.h"
#include "base/leaders.h"
#include "base/zeroed.h"

// Numbers the parts in the order of their first nodes.
static void number_parts(const PlanShape *shape, ArticulatedParts *parts)
{
    size_t *leaders = zeroed(shape->node_count, sizeof *leaders);
    leaders_start(leaders, shape->node_count);
    for (size_t i = 0; i < shape->node_count; i++) {
        if (shape->parents[i] >= 0) {
            leaders_join(leaders, i, (size_t)shape->parents[i]);
        }
    }
    for (size_t i = 0; i < shape->loop_count; i++) {
        const int *ends = shape->ends[i];
        if (ends[0] >= 0 && ends[1] >= 0) {
            leaders_join(leaders, (size_t)ends[0], (size_t)ends[1]);
        }
    }
    for (size_t i = 0; i < shape->node_count; i++) {
        const size_t leader = leaders_find(leaders, i);
        parts->of_node[i] = leader == i ? parts->count++ : parts->of_node[leader];
    }
    free(leaders);
}

// The part that a front belongs to, by any of its loops; none of a loop that moves nothing.
static size_t part_of_front(const PlanShape *shape, const Plan *plan, const PlanFront *front,
                            const ArticulatedParts *parts)
{
    const int *ends = shape->ends[plan->loops[front->first_loop]];
    const int node = ends[0] >= 0 ? ends[0] : ends[1];
    return node >= 0 ? parts->of_node[node] : GROUPED_NONE;
}

void articulated_parts_find(const PlanShape *shape, const Plan *plan, ArticulatedParts *parts)
{
    const size_t first_at_ground = plan->fronts_from[0];
    const size_t at_ground = plan->front_count - first_at_ground;
    *parts = (ArticulatedParts){.of_node = zeroed(shape->node_count, sizeof *parts->of_node)};
    number_parts(shape, parts);
    parts->first_node = zeroed(parts->count + 1, sizeof *parts->first_node);
    parts->nodes = zeroed(shape->node_count, sizeof *parts->nodes);
    grouped_list(parts->count, shape->node_count, parts->of_node, parts->first_node, parts->nodes);
    size_t *of_front = zeroed(at_ground, sizeof *of_front);
    for (size_t i = 0; i < at_ground; i++) {
        of_front[i] = part_of_front(shape, plan, &plan->fronts[first_at_ground + i], parts);
    }
    parts->first_front = zeroed(parts->count + 1, sizeof *parts->first_front);
    parts->fronts = zeroed(at_ground, sizeof *parts->fronts);
    grouped_list(parts->count, at_ground, of_front, parts->first_front, parts->fronts);
    for (size_t i = 0; i < parts->first_front[parts->count]; i++) {
        parts->fronts[i] += first_at_ground;
    }
    free(of_front);
}

void articulated_parts_finish(ArticulatedParts *parts)
{
    free(parts->of_node);
    free(parts->first_node);
    free(parts->nodes);
    free(parts->first_front);
    free(parts->fronts);
}
