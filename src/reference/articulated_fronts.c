// How are loops eliminated?
//
// A row c of a loop feels the motion x of a body's reference, c x = g, and its multiplier mu pushes
// the body by c. With P, h the pivot of a body's freedom and what couples that with x, p what it
// has of c, rows i and k become
//     c_i - p_i h / P,   S_ik - p_i p_k / P,   g_i - p_i f / P
// with S the rows among one another, 0 to begin with. A row goes from a body to the one it hangs on
// as a force at its reference does. Of a loop, whose two rows are the pivot, what is left is the
// same with S in place of P.
#include "reference/articulated_fronts.h"

#include "reference/tree_line.h"

#include <math.h>

enum { LOOP_ROWS = 2 };

static size_t rows_of(const PlanFront *front)
{
    return LOOP_ROWS * front->loop_count;
}

// The first row of a front that is not eliminated in it.
static size_t left_of(const PlanFront *front)
{
    return front->is_body ? 0 : LOOP_ROWS;
}

// The fronts at a node are [first, last).
static size_t first_of(const Articulated *articulated, int node)
{
    return articulated->plan.fronts_from[node + 1];
}

static size_t last_of(const Articulated *articulated, int node)
{
    const Plan *plan = &articulated->plan;
    return node < 0 ? plan->front_count : plan->fronts_from[node];
}

static double felt(const LoopRow *row, Vec2 motion, double spin)
{
    return vec2_dot(row->motion, motion) + row->spin * spin;
}

// A row of a front, at the reference of what its body hangs on.
static LoopRow row_inwards(const Articulated *articulated, const PlanFront *front,
                           const LoopRow *row)
{
    if (!front->is_body) {
        return *row;
    }
    // a hinge has nothing left that feels its spin
    const ArticulatedLink *link = &articulated->links[front->node];
    const double own = link->kind == LINK_SLIDE ? row->spin : 0.0;
    return (LoopRow){row->motion, own + vec2_dot(link->lever, row->motion)};
}

static void add_child(Articulated *articulated, const PlanFront *front, const PlanChild *entry,
                      FrontRows *to)
{
    const PlanFront *child = &articulated->plan.fronts[entry->front];
    const FrontRows *from = &articulated->fronts[entry->front];
    const size_t *places = articulated->plan.places + entry->first_place;
    const size_t count = rows_of(child);
    const size_t left = left_of(child);
    for (size_t i = left; i < count; i++) {
        const size_t row = places[(i - left) / LOOP_ROWS] + i % LOOP_ROWS;
        if (front->node >= 0) {
            const LoopRow moved = row_inwards(articulated, child, &from->rows[i]);
            to->rows[row].motion = vec2_add(to->rows[row].motion, moved.motion);
            to->rows[row].spin += moved.spin;
        }
        for (size_t k = left; k < count; k++) {
            const size_t column = places[(k - left) / LOOP_ROWS] + k % LOOP_ROWS;
            to->square[row * rows_of(front) + column] += from->square[i * count + k];
        }
    }
}

// Adds what a loop feels at one of its ends.
static void add_end(const Articulated *articulated, const PlanFront *front, const PlanEnd *end,
                    const TreeState *state, FrontRows *to)
{
    const Tree *tree = articulated->tree;
    const int joint = articulated->loops[end->loop];
    const double sign = end->side == 0 ? -1.0 : 1.0;
    const bool is_on_line = tree->measures[joint] == TREE_LINE;
    Vec2 arm = state->arms[2 * joint + end->side];
    if (is_on_line && end->side == 0) {
        // the point of body a under the end on body b
        arm = vec2_add(arm, tree_pair_gap(tree, state, joint));
    }
    const Vec2 lever = vec2_add(articulated->links[front->node].centre, vec2_perp(arm));
    LoopRow *own = &to->rows[end->row];
    if (is_on_line) {
        const Vec2 normal = vec2_scale(sign, tree_normal(tree, state, joint));
        own[0].motion = vec2_add(own[0].motion, normal);
        own[0].spin += vec2_dot(normal, lever);
        own[1].spin += sign;
    } else {
        own[0].motion.x += sign;
        own[0].spin += sign * lever.x;
        own[1].motion.y += sign;
        own[1].spin += sign * lever.y;
    }
}

// Takes a pivot out of rows among one another: what each row has of it, times 1 / pivot.
static void take_square(size_t count, size_t first, const double *own, double inverse,
                        double *square)
{
    for (size_t i = first; i < count; i++) {
        const double share = own[i] * inverse;
        for (size_t k = first; k < count && share != 0.0; k++) {
            square[i * count + k] -= share * own[k];
        }
    }
}

// Eliminates one row of a loop: out of the rows behind it, and out of what the body resists with.
static bool eliminate_row(size_t count, size_t pivot, FrontRows *at, ArticulatedLink *link)
{
    const double *own = at->square + pivot * count;
    if (!(fabs(own[pivot]) > 0.0)) {
        return false;
    }
    const double inverse = 1.0 / own[pivot];
    at->inverse[pivot] = inverse;
    const LoopRow *row = &at->rows[pivot];
    for (size_t i = pivot + 1; i < count; i++) {
        const double share = own[i] * inverse;
        at->rows[i].motion = vec2_sub(at->rows[i].motion, vec2_scale(share, row->motion));
        at->rows[i].spin -= share * row->spin;
    }
    take_square(count, pivot + 1, own, inverse, at->square);
    if (link != NULL) {
        link->xx -= inverse * row->motion.x * row->motion.x;
        link->xy -= inverse * row->motion.x * row->motion.y;
        link->yy -= inverse * row->motion.y * row->motion.y;
        link->b = vec2_sub(link->b, vec2_scale(inverse * row->spin, row->motion));
        link->j -= inverse * row->spin * row->spin;
    }
    return true;
}

bool articulated_gather(Articulated *articulated, int node, const TreeState *state)
{
    const Plan *plan = &articulated->plan;
    ArticulatedLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = first_of(articulated, node); i < last_of(articulated, node); i++) {
        const PlanFront *front = &plan->fronts[i];
        FrontRows *at = &articulated->fronts[i];
        const size_t count = rows_of(front);
        for (size_t k = 0; k < count; k++) {
            at->rows[k] = (LoopRow){{0.0, 0.0}, 0.0};
        }
        for (size_t k = 0; k < count * count; k++) {
            at->square[k] = 0.0;
        }
        for (size_t k = 0; k < front->child_count; k++) {
            add_child(articulated, front, &plan->children[front->first_child + k], at);
        }
        for (size_t k = 0; k < front->end_count; k++) {
            add_end(articulated, front, &plan->ends[front->first_end + k], state, at);
        }
        for (size_t pivot = 0; pivot < left_of(front); pivot++) {
            if (!eliminate_row(count, pivot, at, link)) {
                return false;
            }
        }
    }
    return true;
}

// What a row has of the freedom of a body that is eliminated.
static double own_of(const ArticulatedLink *link, const LoopRow *row)
{
    return link->kind == LINK_SLIDE ? vec2_dot(link->direction, row->motion) : row->spin;
}

void articulated_take_out(Articulated *articulated, int node)
{
    const size_t number = (size_t)articulated->plan.front_of[node];
    const ArticulatedLink *link = &articulated->links[node];
    const FrontRows *at = &articulated->fronts[number];
    const size_t count = rows_of(&articulated->plan.fronts[number]);
    for (size_t i = 0; i < count; i++) {
        LoopRow *row = &at->rows[i];
        const double own = own_of(link, row);
        at->own[i] = own;
        row->motion = vec2_sub(row->motion, vec2_scale(own, link->share));
        row->spin = link->kind == LINK_SLIDE ? row->spin - own * link->spin_share : 0.0;
    }
    take_square(count, 0, at->own, link->inverse, at->square);
    if (link->kind == LINK_FLOATING) {
        // its motion is free as well: along y once that along x is eliminated
        for (size_t i = 0; i < count; i++) {
            const Vec2 motion = at->rows[i].motion;
            at->along[i] = motion.x;
            at->across[i] = motion.y - link->slope * motion.x;
        }
        take_square(count, 0, at->along, 1.0 / link->xx, at->square);
        take_square(count, 0, at->across, 1.0 / link->yy, at->square);
    }
}

static void gather_sides(Articulated *articulated, size_t i, ArticulatedLink *link,
                         const double *sides)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *front = &plan->fronts[i];
    const FrontRows *at = &articulated->fronts[i];
    const size_t count = rows_of(front);
    for (size_t k = 0; k < count; k++) {
        const bool is_own = k < left_of(front) && sides != NULL;
        at->vector[k] = is_own ? sides[LOOP_ROWS * plan->loops[front->first_loop] + k] : 0.0;
    }
    for (size_t k = 0; k < front->child_count; k++) {
        const PlanChild *entry = &plan->children[front->first_child + k];
        const PlanFront *child = &plan->fronts[entry->front];
        const size_t *places = plan->places + entry->first_place;
        const size_t left = left_of(child);
        for (size_t row = left; row < rows_of(child); row++) {
            at->vector[places[(row - left) / LOOP_ROWS] + row % LOOP_ROWS] +=
                articulated->fronts[entry->front].vector[row];
        }
    }
    for (size_t pivot = 0; pivot < left_of(front); pivot++) {
        const double solved = at->vector[pivot] * at->inverse[pivot];
        for (size_t k = pivot + 1; k < count; k++) {
            at->vector[k] -= at->square[pivot * count + k] * solved;
        }
        if (link != NULL) {
            const LoopRow *row = &at->rows[pivot];
            link->force = vec2_sub(link->force, vec2_scale(solved, row->motion));
            link->moment -= solved * row->spin;
        }
    }
}

void articulated_gather_sides(Articulated *articulated, int node, const double *sides)
{
    ArticulatedLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = first_of(articulated, node); i < last_of(articulated, node); i++) {
        gather_sides(articulated, i, link, sides);
    }
}

void articulated_gather_ground_sides(Articulated *articulated, const ArticulatedPart *part,
                                     const double *sides)
{
    if (part == NULL) {
        articulated_gather_sides(articulated, -1, sides);
        return;
    }
    for (size_t i = 0; i < part->front_count; i++) {
        gather_sides(articulated, part->fronts[i], NULL, sides);
    }
}

void articulated_take_out_sides(Articulated *articulated, int node)
{
    const size_t number = (size_t)articulated->plan.front_of[node];
    const ArticulatedLink *link = &articulated->links[node];
    const FrontRows *at = &articulated->fronts[number];
    const bool is_floating = link->kind == LINK_FLOATING;
    const double spin = link->inverse * link->own_force;
    const double along = is_floating ? link->force.x / link->xx : 0.0;
    const double across =
        is_floating ? (link->force.y - link->slope * link->force.x) / link->yy : 0.0;
    for (size_t i = 0; i < rows_of(&articulated->plan.fronts[number]); i++) {
        at->vector[i] -= at->own[i] * spin;
        if (is_floating) {
            at->vector[i] -= at->along[i] * along + at->across[i] * across;
        }
    }
}

void articulated_add_multipliers(Articulated *articulated, int node, const double *multipliers)
{
    const Plan *plan = &articulated->plan;
    const size_t number = (size_t)plan->front_of[node];
    const PlanFront *front = &plan->fronts[number];
    const FrontRows *at = &articulated->fronts[number];
    ArticulatedLink *link = &articulated->links[node];
    for (size_t i = 0; i < rows_of(front); i++) {
        const int loop = plan->loops[front->first_loop + i / LOOP_ROWS];
        const double multiplier = multipliers[LOOP_ROWS * loop + i % LOOP_ROWS];
        link->own_force -= at->own[i] * multiplier;
        if (link->kind == LINK_FLOATING) {
            link->force = vec2_sub(link->force, vec2_scale(multiplier, at->rows[i].motion));
        }
    }
}

static void find_multipliers(const Articulated *articulated, size_t i, const ArticulatedLink *link,
                             double *multipliers)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *front = &plan->fronts[i];
    const FrontRows *at = &articulated->fronts[i];
    const size_t count = rows_of(front);
    const int *loops = plan->loops + front->first_loop;
    for (size_t pivot = left_of(front); pivot-- > 0;) {
        double sum = at->vector[pivot];
        if (link != NULL) {
            sum -= felt(&at->rows[pivot], link->motion, link->spin);
        }
        for (size_t k = pivot + 1; k < count; k++) {
            sum -= at->square[pivot * count + k] *
                   multipliers[LOOP_ROWS * loops[k / LOOP_ROWS] + k % LOOP_ROWS];
        }
        multipliers[LOOP_ROWS * loops[0] + (int)pivot] = sum * at->inverse[pivot];
    }
}

void articulated_find_multipliers(Articulated *articulated, int node, double *multipliers)
{
    const ArticulatedLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = last_of(articulated, node); i-- > first_of(articulated, node);) {
        find_multipliers(articulated, i, link, multipliers);
    }
}

void articulated_find_ground_multipliers(Articulated *articulated, const ArticulatedPart *part,
                                         double *multipliers)
{
    if (part == NULL) {
        articulated_find_multipliers(articulated, -1, multipliers);
        return;
    }
    for (size_t i = part->front_count; i-- > 0;) {
        find_multipliers(articulated, part->fronts[i], NULL, multipliers);
    }
}
