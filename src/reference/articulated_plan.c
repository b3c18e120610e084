// Finds the order in which the unknowns of a tree with loops are eliminated.
//
// Bodies from the leaves inwards. Before a body go the loops that come together at it: those whose
// two ends hang on it, or are on it, along different ways. Which of them goes first is chosen by
// how few others it is coupled with.
#include "reference/articulated_plan.h"

#include "base/grouped.h"
#include "base/union_find.h"
#include "base/zeroed.h"

#include <assert.h>
#include <stdlib.h>

enum { PLAN_GROUND = -1 };

typedef struct PlanMaker {
    const PlanShape *shape;
    Plan *plan;
    size_t *depths;   // by node: how many nodes it hangs on, itself among them
    int (*within)[2]; // by loop: fronts that have it and have come into no other; -1: none
    int *row_of;      // by loop: its row in the front that is made; -1: it is not in it
    int *parent;      // by front: the front that it comes into, or -1
    // lists, by node + 1 the first of what is there, and of each the next; -1: no more
    int *first_loop; // of loops whose ends come together there
    int *next_loop;
    int *first_end; // of ends (2 loop + side) on its body of loops that do not
    int *next_end;
    int *first_front; // of fronts that come into one of the node's
    int *next_front;
    size_t
        rooms[5]; // for how many fronts, rows of children, loops, children and ends there is room
} PlanMaker;

static void *plan_widen(void *array, size_t *room, size_t needed, size_t size)
{
    if (needed <= *room) {
        return array;
    }
    *room = needed > 2 * *room ? needed : 2 * *room;
    void *wide = realloc(array, *room * size);
    assert(wide != NULL);
    return wide;
}

static int node_at(const PlanMaker *maker, int loop, int side)
{
    return maker->shape->ends[loop][side];
}

static int plan_find_meeting(const PlanMaker *maker, int loop)
{
    const int *parents = maker->shape->parents;
    int a = node_at(maker, loop, 0);
    int b = node_at(maker, loop, 1);
    while (a != b) {
        if (a < 0 || b < 0) {
            return PLAN_GROUND;
        }
        if (maker->depths[a] >= maker->depths[b]) {
            a = parents[a];
        } else {
            b = parents[b];
        }
    }
    return a;
}

// The loops of a front that are not eliminated in it.
static size_t plan_left_of(const PlanFront *front)
{
    return front->loop_count - (front->is_body ? 0 : 1);
}

static PlanFront *add_front(PlanMaker *maker, int node, bool is_body)
{
    Plan *plan = maker->plan;
    const size_t room = maker->rooms[0];
    plan->fronts =
        plan_widen(plan->fronts, &maker->rooms[0], plan->front_count + 1, sizeof *plan->fronts);
    if (maker->rooms[0] != room) {
        maker->parent = realloc(maker->parent, maker->rooms[0] * sizeof *maker->parent);
        maker->next_front = realloc(maker->next_front, maker->rooms[0] * sizeof *maker->next_front);
        assert(maker->parent != NULL && maker->next_front != NULL);
    }
    PlanFront *front = &plan->fronts[plan->front_count];
    maker->parent[plan->front_count++] = -1;
    *front = (PlanFront){
        .node = node,
        .is_body = is_body,
        .first_loop = plan->loop_count,
        .first_child = plan->child_count,
        .first_end = plan->end_count,
    };
    return front;
}

// Takes a loop into the front that is made last, unless it is there.
static void add_loop(PlanMaker *maker, int loop)
{
    Plan *plan = maker->plan;
    PlanFront *front = &plan->fronts[plan->front_count - 1];
    if (maker->row_of[loop] >= 0) {
        return;
    }
    maker->row_of[loop] = (int)(maker->shape->rows * front->loop_count);
    front->loop_count++;
    plan->loops =
        plan_widen(plan->loops, &maker->rooms[2], plan->loop_count + 1, sizeof *plan->loops);
    plan->loops[plan->loop_count++] = loop;
}

// Takes a front with all its loops into the one that is made last.
static void plan_add_child(PlanMaker *maker, int number)
{
    Plan *plan = maker->plan;
    const PlanFront child = plan->fronts[number];
    const size_t first = child.first_loop + child.loop_count - plan_left_of(&child);
    for (size_t i = 0; i < plan_left_of(&child); i++) {
        add_loop(maker, plan->loops[first + i]);
    }
    maker->parent[number] = (int)plan->front_count - 1;
    plan->children =
        plan_widen(plan->children, &maker->rooms[3], plan->child_count + 1, sizeof *plan->children);
    plan->children[plan->child_count++] = (PlanChild){number, 0};
    plan->fronts[plan->front_count - 1].child_count++;
}

static void plan_add_end(PlanMaker *maker, int loop, int side)
{
    Plan *plan = maker->plan;
    add_loop(maker, loop);
    plan->ends = plan_widen(plan->ends, &maker->rooms[4], plan->end_count + 1, sizeof *plan->ends);
    plan->ends[plan->end_count++] = (PlanEnd){loop, side, 0};
    plan->fronts[plan->front_count - 1].end_count++;
}

static void put_first(int *first, int *next, int number)
{
    next[number] = *first;
    *first = number;
}

// Writes down the rows of all that has come into the front that is made last, which then has the
// loops that are left in it, and waits at a node.
static void close_front(PlanMaker *maker, int node)
{
    Plan *plan = maker->plan;
    const int number = (int)plan->front_count - 1;
    const PlanFront *front = &plan->fronts[number];
    for (size_t i = 0; i < front->child_count; i++) {
        PlanChild *child = &plan->children[front->first_child + i];
        const PlanFront *of = &plan->fronts[child->front];
        child->first_child_row = plan->child_row_count;
        plan->child_rows =
            plan_widen(plan->child_rows, &maker->rooms[1], plan->child_row_count + of->loop_count,
                       sizeof *plan->child_rows);
        for (size_t k = of->loop_count - plan_left_of(of); k < of->loop_count; k++) {
            const int loop = plan->loops[of->first_loop + k];
            plan->child_rows[plan->child_row_count++] = (size_t)maker->row_of[loop];
        }
    }
    for (size_t i = 0; i < front->end_count; i++) {
        PlanEnd *end = &plan->ends[front->first_end + i];
        end->row = (size_t)maker->row_of[end->loop];
    }
    for (size_t i = 0; i < front->loop_count; i++) {
        const int loop = plan->loops[front->first_loop + i];
        maker->row_of[loop] = -1;
        int *within = maker->within[loop];
        int kept = -1;
        for (int k = 0; k < 2; k++) {
            kept = within[k] >= 0 && maker->parent[within[k]] < 0 ? within[k] : kept;
        }
        within[0] = number;
        within[1] = kept;
    }
    put_first(&maker->first_front[node + 1], maker->next_front, number);
}

// How many loops one is coupled with, counted twice where both its fronts have them.
static size_t degree_of(const PlanMaker *maker, int loop)
{
    size_t sum = 0;
    for (int k = 0; k < 2; k++) {
        const int front = maker->within[loop][k];
        sum += front >= 0 ? plan_left_of(&maker->plan->fronts[front]) : 0;
    }
    return sum;
}

static void add_loop_front(PlanMaker *maker, int node, int loop)
{
    add_front(maker, node, false);
    add_loop(maker, loop);
    for (int k = 0; k < 2; k++) {
        if (maker->within[loop][k] >= 0) {
            plan_add_child(maker, maker->within[loop][k]);
        }
    }
    for (int side = 0; side < 2; side++) {
        if (node >= 0 && node_at(maker, loop, side) == node) {
            plan_add_end(maker, loop, side);
        }
    }
    close_front(maker, node);
}

// Eliminates the loops that come together at a node or at the ground. The list becomes shorter.
static void add_loop_fronts(PlanMaker *maker, int node)
{
    int *first = &maker->first_loop[node + 1];
    while (*first >= 0) {
        int *best = first;
        for (int *at = first; *at >= 0; at = &maker->next_loop[*at]) {
            best = degree_of(maker, *at) < degree_of(maker, *best) ? at : best;
        }
        const int loop = *best;
        *best = maker->next_loop[loop];
        add_loop_front(maker, node, loop);
    }
}

// Eliminates the freedom of a node; no front is needed where no loop depends on it.
static void add_body_front(PlanMaker *maker, int node)
{
    Plan *plan = maker->plan;
    const int number = (int)plan->front_count;
    add_front(maker, node, true);
    for (int i = maker->first_front[node + 1]; i >= 0; i = maker->next_front[i]) {
        if (maker->parent[i] < 0) {
            plan_add_child(maker, i);
        }
    }
    for (int end = maker->first_end[node + 1]; end >= 0; end = maker->next_end[end]) {
        plan_add_end(maker, end / 2, end % 2);
    }
    const PlanFront *own = &plan->fronts[number];
    if (own->child_count + own->end_count == 0) {
        plan->front_count--;
        return;
    }
    plan->front_of[node] = number;
    close_front(maker, maker->shape->parents[node]);
}

// Room for numbers, all -1.
static int *make_numbers(size_t count)
{
    int *numbers = malloc((count + 1) * sizeof *numbers);
    assert(numbers != NULL);
    for (size_t i = 0; i < count; i++) {
        numbers[i] = -1;
    }
    return numbers;
}

static void plan_list_loops(PlanMaker *maker)
{
    for (int loop = (int)maker->shape->loop_count - 1; loop >= 0; loop--) {
        const int meeting = plan_find_meeting(maker, loop);
        put_first(&maker->first_loop[meeting + 1], maker->next_loop, loop);
        for (int side = 0; side < 2; side++) {
            const int node = node_at(maker, loop, side);
            if (node >= 0 && node != meeting) {
                put_first(&maker->first_end[node + 1], maker->next_end, 2 * loop + side);
            }
        }
    }
}

// Of each node how many it hangs on, itself among them.
static size_t *find_depths(const PlanShape *shape)
{
    size_t *depths = calloc(shape->node_count + 1, sizeof *depths);
    assert(depths != NULL);
    for (size_t i = 0; i < shape->node_count; i++) {
        depths[i] = shape->parents[i] >= 0 ? depths[shape->parents[i]] + 1 : 1;
    }
    return depths;
}

void articulated_plan_make(const PlanShape *shape, Plan *plan)
{
    const size_t nodes = shape->node_count;
    const size_t loop_count = shape->loop_count;
    *plan = (Plan){.front_of = make_numbers(nodes)};
    plan->fronts_from = calloc(nodes + 1, sizeof *plan->fronts_from);
    int(*within)[2] = malloc((loop_count + 1) * sizeof *within);
    assert(plan->fronts_from != NULL && within != NULL);
    for (size_t i = 0; i < loop_count; i++) {
        within[i][0] = within[i][1] = -1;
    }
    PlanMaker maker = {
        .shape = shape,
        .plan = plan,
        .depths = find_depths(shape),
        .within = within,
        .row_of = make_numbers(loop_count),
        .first_loop = make_numbers(nodes + 1),
        .next_loop = make_numbers(loop_count),
        .first_end = make_numbers(nodes + 1),
        .next_end = make_numbers(2 * loop_count),
        .first_front = make_numbers(nodes + 1),
    };
    plan_list_loops(&maker);
    for (int node = (int)nodes - 1; node >= 0; node--) {
        plan->fronts_from[node + 1] = plan->front_count;
        add_loop_fronts(&maker, node);
        add_body_front(&maker, node);
    }
    plan->fronts_from[0] = plan->front_count;
    add_loop_fronts(&maker, PLAN_GROUND);
    free(within);
    free(maker.depths);
    int *rooms[] = {maker.row_of,   maker.first_loop,  maker.next_loop,  maker.first_end,
                    maker.next_end, maker.first_front, maker.next_front, maker.parent};
    for (size_t i = 0; i < sizeof rooms / sizeof *rooms; i++) {
        free(rooms[i]);
    }
}

void articulated_plan_finish(Plan *plan)
{
    free(plan->fronts);
    free(plan->child_rows);
    free(plan->loops);
    free(plan->children);
    free(plan->ends);
    free(plan->front_of);
    free(plan->fronts_from);
}

// Parts of a tree are the bodies that ideal joints tie to one another.
//
// A body and what hangs on it, and the bodies at both ends of a loop. The ground and the driven
// body, which nothing moves, tie nothing.

// Numbers the parts in the order of their first nodes.
static void number_parts(const PlanShape *shape, ArticulatedParts *parts)
{
    size_t *roots = zeroed(shape->node_count, sizeof *roots);
    union_find_start(roots, shape->node_count);
    for (size_t i = 0; i < shape->node_count; i++) {
        if (shape->parents[i] >= 0) {
            union_find_join(roots, i, (size_t)shape->parents[i]);
        }
    }
    for (size_t i = 0; i < shape->loop_count; i++) {
        const int *ends = shape->ends[i];
        if (ends[0] >= 0 && ends[1] >= 0) {
            union_find_join(roots, (size_t)ends[0], (size_t)ends[1]);
        }
    }
    for (size_t i = 0; i < shape->node_count; i++) {
        const size_t root = union_find_root(roots, i);
        parts->of_node[i] = root == i ? parts->count++ : parts->of_node[root];
    }
    free(roots);
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
