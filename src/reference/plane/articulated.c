// Solves for how a tree with loops accelerates under forces, at a cost linear in its size.
//
// A body's motion x is that of its reference: of a body on a revolute joint its pin, of others the
// centre; al is its spin. With e from there to the centre, p to the reference of a body that hangs
// on it (both turned by a quarter turn), and A_c, b_c, J_c what that one has left, it resists by
//     A x + b al = f,   b x + J al = t
//     A = m + sum A_c,   b = m e + sum (b_c + A_c p),   J = I + m e^2 + sum (J_c + (2 b_c + A_c p)
//     p)
// A revolute joint leaves al free, and nothing but a mass at the pin is left:
//     al = (t - b x) / J,   A - b b^T / J,   b = 0,   J = 0
// A slide leaves the motion along it free, in the same way. Loops: see below.
#include "reference/plane/articulated.h"

#include "reference/plane/tree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// How a row of a loop depends on the motion of a body's reference, and its spin.
typedef struct LoopRow {
    Vec2 motion;
    double spin;
} LoopRow;

// The rows of a front.
struct FrontRows {
    LoopRow *rows;
    double *square;    // what is left of the loops among one another, row by row
    double *diagonal;  // of them what each row had of its own before others were taken out of it
    double *own;       // what each row had of the freedom that is eliminated
    double *along;     // and of a floating body's motion
    double *across;    //
    double *vector;    // of a solution
    double inverse[2]; // of the two rows that are eliminated: 1 / pivot
};

// Loops are eliminated with the bodies that their rows depend on.
//
// A row c of a loop depends on the motion x of a body's reference, c x = g, and its multiplier mu
// pushes the body by c. With P, h the pivot of a body's freedom and what couples that with x, p
// what it has of c, rows i and k become
//     c_i - p_i h / P,   S_ik - p_i p_k / P,   g_i - p_i f / P
// with S the rows among one another, 0 to begin with. A row goes from a body to the one it hangs on
// as a force at its reference does. Of a loop, whose two rows are the pivot, what is left is the
// same with S in place of P.

enum { FRONT_LOOP_ROWS = 2 };

static size_t front_rows_of(const PlanFront *front)
{
    return FRONT_LOOP_ROWS * front->loop_count;
}

// The first row of a front that is not eliminated in it.
static size_t front_left_of(const PlanFront *front)
{
    return front->is_body ? 0 : FRONT_LOOP_ROWS;
}

// The fronts at a node are [first, last).
static size_t front_first_of(const Articulated *articulated, int node)
{
    return articulated->plan.fronts_from[node + 1];
}

static size_t front_last_of(const Articulated *articulated, int node)
{
    const Plan *plan = &articulated->plan;
    return node < 0 ? plan->front_count : plan->fronts_from[node];
}

static double row_value(const LoopRow *row, Vec2 motion, double spin)
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
    // a hinge has nothing left that depends on its spin
    const ArticulatedLink *link = &articulated->links[front->node];
    const double own = link->kind == LINK_SLIDE ? row->spin : 0.0;
    return (LoopRow){row->motion, own + vec2_dot(link->lever, row->motion)};
}

static void front_add_child(Articulated *articulated, const PlanFront *front,
                            const PlanChild *entry, FrontRows *to)
{
    const PlanFront *child = &articulated->plan.fronts[entry->front];
    const FrontRows *from = &articulated->fronts[entry->front];
    const size_t *child_rows = articulated->plan.child_rows + entry->first_child_row;
    const size_t count = front_rows_of(child);
    const size_t left = front_left_of(child);
    for (size_t i = left; i < count; i++) {
        const size_t row = child_rows[(i - left) / FRONT_LOOP_ROWS] + i % FRONT_LOOP_ROWS;
        if (front->node >= 0) {
            const LoopRow moved = row_inwards(articulated, child, &from->rows[i]);
            to->rows[row].motion = vec2_add(to->rows[row].motion, moved.motion);
            to->rows[row].spin += moved.spin;
        }
        for (size_t k = left; k < count; k++) {
            const size_t column = child_rows[(k - left) / FRONT_LOOP_ROWS] + k % FRONT_LOOP_ROWS;
            to->square[row * front_rows_of(front) + column] += from->square[i * count + k];
        }
        if (articulated->notes_distance) {
            to->diagonal[row] += from->diagonal[i];
        }
    }
}

// Adds what a loop has at one of its ends.
static void front_add_end(const Articulated *articulated, const PlanFront *front,
                          const PlanEnd *end, const TreeState *state, FrontRows *to)
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
static bool front_eliminate_row(size_t count, size_t pivot, FrontRows *at, ArticulatedLink *link)
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

// How much the pivot of a loop's row is of what the row had before others were taken out of it, or,
// of an anchor's two, the longer of both: the square of the sine of an angle. It is small where
// rows depend on one another, and where one depends on nothing.
static void note_distance(Articulated *articulated, const PlanFront *front, const FrontRows *at,
                          size_t pivot)
{
    const int joint = articulated->loops[articulated->plan.loops[front->first_loop]];
    const size_t count = front_rows_of(front);
    const bool is_anchor = articulated->tree->measures[joint] != TREE_LINE;
    const double whole = is_anchor ? fmax(at->diagonal[0], at->diagonal[1]) : at->diagonal[pivot];
    const double share = fabs(at->square[pivot * count + pivot]) / whole;
    articulated->distance = fmin(articulated->distance, sqrt(share));
}

// Gathers the rows at a node, or at the ground (-1), before its freedom is eliminated, and
// eliminates the loops whose ends come together there.
static bool articulated_gather(Articulated *articulated, int node, const TreeState *state)
{
    const Plan *plan = &articulated->plan;
    ArticulatedLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = front_first_of(articulated, node); i < front_last_of(articulated, node); i++) {
        const PlanFront *front = &plan->fronts[i];
        FrontRows *at = &articulated->fronts[i];
        const size_t count = front_rows_of(front);
        for (size_t k = 0; k < count; k++) {
            at->rows[k] = (LoopRow){{0.0, 0.0}, 0.0};
        }
        for (size_t k = 0; k < count * count; k++) {
            at->square[k] = 0.0;
        }
        for (size_t k = 0; k < count && articulated->notes_distance; k++) {
            at->diagonal[k] = 0.0;
        }
        for (size_t k = 0; k < front->child_count; k++) {
            front_add_child(articulated, front, &plan->children[front->first_child + k], at);
        }
        for (size_t k = 0; k < front->end_count; k++) {
            front_add_end(articulated, front, &plan->ends[front->first_end + k], state, at);
        }
        for (size_t pivot = 0; pivot < front_left_of(front); pivot++) {
            if (!front_eliminate_row(count, pivot, at, link)) {
                return false;
            }
            if (articulated->notes_distance) {
                note_distance(articulated, front, at, pivot);
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

// Takes the freedom of a node, which has been eliminated, out of its rows.
static void articulated_take_out(Articulated *articulated, int node)
{
    const size_t number = (size_t)articulated->plan.front_of[node];
    const ArticulatedLink *link = &articulated->links[node];
    const FrontRows *at = &articulated->fronts[number];
    const size_t count = front_rows_of(&articulated->plan.fronts[number]);
    for (size_t i = 0; i < count; i++) {
        LoopRow *row = &at->rows[i];
        const double own = own_of(link, row);
        at->own[i] = own;
        row->motion = vec2_sub(row->motion, vec2_scale(own, link->share));
        row->spin = link->kind == LINK_SLIDE ? row->spin - own * link->spin_share : 0.0;
    }
    take_square(count, 0, at->own, link->inverse, at->square);
    for (size_t i = 0; i < count && articulated->notes_distance; i++) {
        at->diagonal[i] += at->own[i] * at->own[i] * link->inverse;
    }
    if (link->kind == LINK_FLOATING) {
        // its motion is free as well: along y once that along x is eliminated
        for (size_t i = 0; i < count; i++) {
            const Vec2 motion = at->rows[i].motion;
            at->along[i] = motion.x;
            at->across[i] = motion.y - link->slope * motion.x;
        }
        take_square(count, 0, at->along, 1.0 / link->xx, at->square);
        take_square(count, 0, at->across, 1.0 / link->yy, at->square);
        for (size_t i = 0; i < count && articulated->notes_distance; i++) {
            at->diagonal[i] += at->along[i] * at->along[i] / link->xx;
            at->diagonal[i] += at->across[i] * at->across[i] / link->yy;
        }
    }
}

static void front_gather_sides(Articulated *articulated, size_t i, ArticulatedLink *link,
                               const double *sides)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *front = &plan->fronts[i];
    const FrontRows *at = &articulated->fronts[i];
    const size_t count = front_rows_of(front);
    for (size_t k = 0; k < count; k++) {
        const bool is_own = k < front_left_of(front) && sides != NULL;
        at->vector[k] = is_own ? sides[FRONT_LOOP_ROWS * plan->loops[front->first_loop] + k] : 0.0;
    }
    for (size_t k = 0; k < front->child_count; k++) {
        const PlanChild *entry = &plan->children[front->first_child + k];
        const PlanFront *child = &plan->fronts[entry->front];
        const size_t *child_rows = plan->child_rows + entry->first_child_row;
        const size_t left = front_left_of(child);
        for (size_t row = left; row < front_rows_of(child); row++) {
            at->vector[child_rows[(row - left) / FRONT_LOOP_ROWS] + row % FRONT_LOOP_ROWS] +=
                articulated->fronts[entry->front].vector[row];
        }
    }
    for (size_t pivot = 0; pivot < front_left_of(front); pivot++) {
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

// The same of the right side, that of the loops' rows or NULL: zeros.
static void articulated_gather_sides(Articulated *articulated, int node, const double *sides)
{
    ArticulatedLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = front_first_of(articulated, node); i < front_last_of(articulated, node); i++) {
        front_gather_sides(articulated, i, link, sides);
    }
}

// Gathers them at the ground, of a part or of all (NULL).
static void articulated_gather_ground_sides(Articulated *articulated, const ArticulatedPart *part,
                                            const double *sides)
{
    if (part == NULL) {
        articulated_gather_sides(articulated, -1, sides);
        return;
    }
    for (size_t i = 0; i < part->front_count; i++) {
        front_gather_sides(articulated, part->fronts[i], NULL, sides);
    }
}

static void articulated_take_out_sides(Articulated *articulated, int node)
{
    const size_t number = (size_t)articulated->plan.front_of[node];
    const ArticulatedLink *link = &articulated->links[node];
    const FrontRows *at = &articulated->fronts[number];
    const bool is_floating = link->kind == LINK_FLOATING;
    const double spin = link->inverse * link->own_force;
    const double along = is_floating ? link->force.x / link->xx : 0.0;
    const double across =
        is_floating ? (link->force.y - link->slope * link->force.x) / link->yy : 0.0;
    for (size_t i = 0; i < front_rows_of(&articulated->plan.fronts[number]); i++) {
        at->vector[i] -= at->own[i] * spin;
        if (is_floating) {
            at->vector[i] -= at->along[i] * along + at->across[i] * across;
        }
    }
}

// Adds to the forces on a node's freedom what the loops' multipliers give it.
static void articulated_add_multipliers(Articulated *articulated, int node,
                                        const double *multipliers)
{
    const Plan *plan = &articulated->plan;
    const size_t number = (size_t)plan->front_of[node];
    const PlanFront *front = &plan->fronts[number];
    const FrontRows *at = &articulated->fronts[number];
    ArticulatedLink *link = &articulated->links[node];
    for (size_t i = 0; i < front_rows_of(front); i++) {
        const int loop = plan->loops[front->first_loop + i / FRONT_LOOP_ROWS];
        const double multiplier = multipliers[FRONT_LOOP_ROWS * loop + i % FRONT_LOOP_ROWS];
        link->own_force -= at->own[i] * multiplier;
        if (link->kind == LINK_FLOATING) {
            link->force = vec2_sub(link->force, vec2_scale(multiplier, at->rows[i].motion));
        }
    }
}

static void front_find_multipliers(const Articulated *articulated, size_t i,
                                   const ArticulatedLink *link, double *multipliers)
{
    const Plan *plan = &articulated->plan;
    const PlanFront *front = &plan->fronts[i];
    const FrontRows *at = &articulated->fronts[i];
    const size_t count = front_rows_of(front);
    const int *loops = plan->loops + front->first_loop;
    for (size_t pivot = front_left_of(front); pivot-- > 0;) {
        double sum = at->vector[pivot];
        if (link != NULL) {
            sum -= row_value(&at->rows[pivot], link->motion, link->spin);
        }
        for (size_t k = pivot + 1; k < count; k++) {
            sum -= at->square[pivot * count + k] *
                   multipliers[FRONT_LOOP_ROWS * loops[k / FRONT_LOOP_ROWS] + k % FRONT_LOOP_ROWS];
        }
        multipliers[FRONT_LOOP_ROWS * loops[0] + (int)pivot] = sum * at->inverse[pivot];
    }
}

// Finds the multipliers of the loops that come together at a node, whose motion is known.
static void articulated_find_multipliers(Articulated *articulated, int node, double *multipliers)
{
    const ArticulatedLink *link = node >= 0 ? &articulated->links[node] : NULL;
    for (size_t i = front_last_of(articulated, node); i-- > front_first_of(articulated, node);) {
        front_find_multipliers(articulated, i, link, multipliers);
    }
}

// The same of those that come together at the ground, of a part or of all (NULL).
static void articulated_find_ground_multipliers(Articulated *articulated,
                                                const ArticulatedPart *part, double *multipliers)
{
    if (part == NULL) {
        articulated_find_multipliers(articulated, -1, multipliers);
        return;
    }
    for (size_t i = part->front_count; i-- > 0;) {
        front_find_multipliers(articulated, part->fronts[i], NULL, multipliers);
    }
}

// A tree of hinges and floating bodies without loops accelerates as any other, with nothing worked
// out that such a tree does not need: most small mechanisms with play are one.
//
// What hangs on a body is gathered in its link, which is empty again once it has been used.

// From the parent's reference to the body's, turned.
static inline Vec2 plain_lever_of(const ArticulatedLink *link, const ArticulatedLink *parent,
                                  const TreeState *state)
{
    Vec2 arm = state->arms[link->parent_end];
    if (parent->kind == LINK_HINGE) {
        arm = vec2_sub(arm, state->arms[parent->own_end]);
    }
    return vec2_perp(arm);
}

// Adds what hangs on a body to what it has itself.
static inline void plain_take_gathered(ArticulatedLink *link, double *j)
{
    link->xx = link->mass + link->gathered.xx;
    link->xy = link->gathered.xy;
    link->yy = link->mass + link->gathered.yy;
    link->b = vec2_add(link->b, link->gathered.b);
    link->force = vec2_add(link->force, link->gathered.force);
    link->moment += link->gathered.moment;
    *j += link->gathered.j;
    link->gathered = (ArticulatedGathered){.xx = 0.0};
}

// Eliminates the turning of a body, and gathers what is left of it where it hangs.
static inline void plain_pass_inwards(ArticulatedLink *link, ArticulatedLink *parent,
                                      const TreeState *state)
{
    const Vec2 b = link->b;
    const Vec2 share = vec2_scale(link->inverse, b);
    const double xx = link->xx - share.x * b.x;
    const double xy = link->xy - share.x * b.y;
    const double yy = link->yy - share.y * b.y;
    const Vec2 force = vec2_sub(link->force, vec2_scale(link->moment, share));
    const Vec2 lever = plain_lever_of(link, parent, state);
    const Vec2 moved = {xx * lever.x + xy * lever.y, xy * lever.x + yy * lever.y};
    ArticulatedGathered *to = &parent->gathered;
    link->share = share;
    link->lever = lever;
    to->xx += xx;
    to->xy += xy;
    to->yy += yy;
    to->b = vec2_add(to->b, moved);
    to->j += vec2_dot(lever, moved);
    to->force = vec2_add(to->force, force);
    to->moment += vec2_dot(lever, force);
}

// Solves for a body that floats.
static inline bool plain_solve_floating(ArticulatedLink *link, double *rates)
{
    const Vec2 share = vec2_scale(link->inverse, link->b);
    const Vec2 force = vec2_sub(link->force, vec2_scale(link->moment, share));
    const double xx = link->xx - share.x * link->b.x;
    const double xy = link->xy - share.x * link->b.y;
    const double slope = xy / xx;
    const double yy = link->yy - share.y * link->b.y - slope * xy;
    const double y = (force.y - slope * force.x) / yy;
    link->motion = (Vec2){(force.x - xy * y) / xx, y};
    link->spin = link->inverse * link->moment - vec2_dot(share, link->motion);
    rates[link->column - 2] = link->motion.x;
    rates[link->column - 1] = link->motion.y;
    rates[link->column] = link->spin;
    return xx > 0.0 && yy > 0.0;
}

// What articulated_accelerate does, of such a tree.
static bool articulated_tree_accelerate(Articulated *articulated, const TreeState *state,
                                        const ArticulatedPush *pushes, double *rates)
{
    ArticulatedLink *links = articulated->links;
    const size_t count = articulated->tree->node_count;
    bool is_solved = true;
    for (size_t i = count; i-- > 0;) {
        ArticulatedLink *link = &links[i];
        const ArticulatedPush *push = &pushes[link->body];
        const Vec2 force = vec2_sub(push->force, vec2_scale(link->mass, state->bias[link->body]));
        double j = link->inertia;
        link->force = force;
        link->moment = push->moment;
        if (link->kind == LINK_FLOATING) {
            if (!link->has_children) {
                rates[link->column - 2] = force.x / link->mass;
                rates[link->column - 1] = force.y / link->mass;
                rates[link->column] = push->moment / j;
                continue;
            }
            link->b = (Vec2){0.0, 0.0};
            plain_take_gathered(link, &j);
            link->inverse = 1.0 / j;
            is_solved = plain_solve_floating(link, rates) && j > 0.0 && is_solved;
            continue;
        }
        // from the pin to the centre, turned
        const Vec2 arm = state->arms[link->own_end];
        const Vec2 centre = {arm.y, -arm.x};
        link->moment += vec2_dot(centre, force);
        link->b = vec2_scale(link->mass, centre);
        if (link->has_children) {
            plain_take_gathered(link, &j);
        } else {
            link->xx = link->yy = link->mass;
            link->xy = 0.0;
        }
        link->inverse = 1.0 / j;
        is_solved = j > 0.0 && is_solved;
        if (link->parent >= 0) {
            plain_pass_inwards(link, &links[link->parent], state);
        }
    }
    for (size_t i = 0; i < count; i++) {
        ArticulatedLink *link = &links[i];
        if (link->kind == LINK_FLOATING) {
            continue;
        }
        link->spin = link->inverse * link->moment;
        link->motion = (Vec2){0.0, 0.0};
        if (link->parent >= 0) {
            const ArticulatedLink *parent = &links[link->parent];
            link->motion = vec2_add(parent->motion, vec2_scale(parent->spin, link->lever));
            link->spin -= vec2_dot(link->share, link->motion);
        }
        rates[link->column] = link->spin;
    }
    return is_solved;
}

static void articulated_lay(Articulated *articulated, MemoryLayout *layout)
{
    const Plan *plan = &articulated->plan;
    articulated->links =
        layout_take(layout, articulated->tree->node_count, sizeof *articulated->links);
    articulated->loops = layout_take(layout, articulated->loop_count, sizeof *articulated->loops);
    articulated->fronts = layout_take(layout, plan->front_count, sizeof *articulated->fronts);
    for (size_t i = 0; i < plan->front_count; i++) {
        const size_t count = 2 * plan->fronts[i].loop_count;
        FrontRows at;
        at.rows = layout_take(layout, count, sizeof *at.rows);
        at.square = layout_take(layout, count * count, sizeof *at.square);
        at.diagonal = layout_take(layout, count, sizeof *at.diagonal);
        at.own = layout_take(layout, count, sizeof *at.own);
        at.along = layout_take(layout, count, sizeof *at.along);
        at.across = layout_take(layout, count, sizeof *at.across);
        at.vector = layout_take(layout, count, sizeof *at.vector);
        if (articulated->fronts != NULL) {
            articulated->fronts[i] = at;
        }
    }
}

static void articulated_set_links(Articulated *articulated)
{
    articulated->is_plain = articulated->plan.front_count == 0;
    const Tree *tree = articulated->tree;
    const Plan *plan = &articulated->plan;
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const Body *body = &tree->linkage->bodies[node->body];
        const bool is_hinge = node->joint >= 0 && !node->is_sliding;
        const Vec2 arm = is_hinge ? tree->anchors[node->own_end] : (Vec2){0.0, 0.0};
        articulated->links[i] = (ArticulatedLink){
            .kind = is_hinge ? LINK_HINGE : (node->is_sliding ? LINK_SLIDE : LINK_FLOATING),
            .has_fronts = plan->fronts_from[i + 1] < plan->fronts_from[i],
            .has_own_front = plan->front_of[i] >= 0,
            .parent = node->parent_node,
            .body = node->body,
            .column = node->column,
            .own_end = node->own_end,
            .parent_end = node->parent_end,
            .mass = body->mass,
            .inertia = body->inertia + body->mass * vec2_dot(arm, arm),
        };
        articulated->is_plain = articulated->is_plain && !node->is_sliding;
        if (node->parent_node >= 0) {
            articulated->links[node->parent_node].has_children = true;
        }
    }
}

static void articulated_make_plan(const Tree *tree, size_t loop_count, const int *loops, Plan *plan,
                                  ArticulatedParts *parts)
{
    int *parents = malloc((tree->node_count + 1) * sizeof *parents);
    int(*ends)[2] = malloc((loop_count + 1) * sizeof *ends);
    assert(parents != NULL && ends != NULL);
    for (size_t i = 0; i < tree->node_count; i++) {
        parents[i] = tree->nodes[i].parent_node;
    }
    for (size_t i = 0; i < loop_count; i++) {
        const Joint *joint = &tree->linkage->joints[loops[i]];
        ends[i][0] = tree_node_of(tree, joint->body_a);
        ends[i][1] = tree_node_of(tree, joint->body_b);
    }
    const PlanShape shape = {tree->node_count, parents, loop_count, (const int(*)[2])ends, 2};
    articulated_plan_make(&shape, plan);
    articulated_parts_find(&shape, plan, parts);
    free(parents);
    free(ends);
}

Articulated *articulated_create(const Tree *tree, size_t loop_count, const int *loops)
{
    Articulated made = {.tree = tree, .loop_count = loop_count};
    articulated_make_plan(tree, loop_count, loops, &made.plan, &made.parts);
    MemoryLayout layout = {NULL, 0};
    layout_take(&layout, 1, sizeof made);
    articulated_lay(&made, &layout);
    Articulated *articulated = calloc(1, layout.used);
    assert(articulated != NULL);
    *articulated = made;
    layout = (MemoryLayout){(char *)articulated, 0};
    layout_take(&layout, 1, sizeof made);
    articulated_lay(articulated, &layout);
    for (size_t i = 0; i < loop_count; i++) {
        articulated->loops[i] = loops[i];
    }
    articulated_set_links(articulated);
    return articulated;
}

void articulated_destroy(Articulated *articulated)
{
    if (articulated != NULL) {
        articulated_plan_finish(&articulated->plan);
        articulated_parts_finish(&articulated->parts);
        free(articulated);
    }
}

// From the parent's reference to the body's, turned.
static inline Vec2 articulated_lever_of(const Articulated *articulated, size_t number,
                                        const TreeState *state)
{
    const TreeNode *node = &articulated->tree->nodes[number];
    const ArticulatedLink *parent = &articulated->links[node->parent_node];
    const Vec2 arm = node->is_sliding ? state->behind[number] : state->arms[node->parent_end];
    // the centre of a hinge is known: it stands before what hangs on it
    return vec2_add(parent->centre, vec2_perp(arm));
}

// What the body itself resists with.
static inline void articulated_start_link(const Articulated *articulated, size_t number,
                                          const TreeState *state, ArticulatedLink *link)
{
    const TreeNode *node = &articulated->tree->nodes[number];
    if (link->kind == LINK_HINGE) {
        const Vec2 arm = state->arms[node->own_end];
        link->centre = (Vec2){arm.y, -arm.x};
    } else if (link->kind == LINK_SLIDE) {
        link->direction = state->along[number];
    }
    link->xx = link->yy = link->mass;
    link->xy = 0.0;
    link->j = link->inertia;
    link->b = vec2_scale(link->mass, link->centre);
    if (link->parent >= 0) {
        link->lever = articulated_lever_of(articulated, number, state);
    }
}

static inline Vec2 resisted(const ArticulatedLink *link, Vec2 motion)
{
    return (Vec2){
        link->xx * motion.x + link->xy * motion.y,
        link->xy * motion.x + link->yy * motion.y,
    };
}

// Eliminates the motion along a slide.
static bool eliminate_slide(ArticulatedLink *link)
{
    const Vec2 coupled = resisted(link, link->direction);
    const double spun = vec2_dot(link->direction, link->b);
    const double pivot = vec2_dot(link->direction, coupled);
    link->inverse = 1.0 / pivot;
    link->share = vec2_scale(link->inverse, coupled);
    link->spin_share = link->inverse * spun;
    link->xx -= link->share.x * coupled.x;
    link->xy -= link->share.x * coupled.y;
    link->yy -= link->share.y * coupled.y;
    link->b = vec2_sub(link->b, vec2_scale(spun, link->share));
    link->j -= link->spin_share * spun;
    return pivot > 0.0;
}

// Eliminates a body's own freedom; of one that floats, all of them.
static inline bool articulated_eliminate(ArticulatedLink *link)
{
    if (link->kind == LINK_SLIDE) {
        return eliminate_slide(link);
    }
    link->inverse = 1.0 / link->j;
    link->share = vec2_scale(link->inverse, link->b);
    link->xx -= link->share.x * link->b.x;
    link->xy -= link->share.x * link->b.y;
    link->yy -= link->share.y * link->b.y;
    if (link->kind == LINK_FLOATING) {
        link->slope = link->xy / link->xx;
        link->yy -= link->slope * link->xy;
        return link->j > 0.0 && link->xx > 0.0 && link->yy > 0.0;
    }
    return link->j > 0.0;
}

// Adds what is left of a body to the one it hangs on.
static inline void articulated_pass_inwards(const ArticulatedLink *link, ArticulatedLink *parent)
{
    const Vec2 moved = resisted(link, link->lever);
    parent->xx += link->xx;
    parent->xy += link->xy;
    parent->yy += link->yy;
    parent->b = vec2_add(parent->b, moved);
    parent->j += vec2_dot(link->lever, moved);
    if (link->kind == LINK_SLIDE) {
        parent->b = vec2_add(parent->b, link->b);
        parent->j += link->j + 2.0 * vec2_dot(link->lever, link->b);
    }
}

// The same of the forces.
static inline void articulated_push_inwards(ArticulatedLink *link, ArticulatedLink *parent)
{
    double left = 0.0;
    link->own_force = link->moment;
    if (link->kind == LINK_SLIDE) {
        link->own_force = vec2_dot(link->direction, link->force);
        left = link->moment - link->own_force * link->spin_share;
    }
    link->force = vec2_sub(link->force, vec2_scale(link->own_force, link->share));
    if (parent != NULL) {
        parent->force = vec2_add(parent->force, link->force);
        parent->moment += left + vec2_dot(link->lever, link->force);
    }
}

// A body's motion, from that of what it hangs on.
static inline void move_outwards(ArticulatedLink *link, const ArticulatedLink *parent)
{
    if (link->kind == LINK_FLOATING) {
        const Vec2 force = link->force;
        const double y = (force.y - link->slope * force.x) / link->yy;
        link->motion = (Vec2){(force.x - link->xy * y) / link->xx, y};
    } else if (parent != NULL) {
        link->motion = vec2_add(parent->motion, vec2_scale(parent->spin, link->lever));
    } else {
        link->motion = (Vec2){0.0, 0.0};
    }
    const double own = link->inverse * link->own_force - vec2_dot(link->share, link->motion);
    if (link->kind != LINK_SLIDE) {
        link->spin = own;
        return;
    }
    link->spin = parent != NULL ? parent->spin : 0.0;
    link->slide = own - link->spin_share * link->spin;
    link->motion = vec2_add(link->motion, vec2_scale(link->slide, link->direction));
}

static inline void write_rates(const ArticulatedLink *link, double *rates)
{
    double *own = &rates[link->column];
    own[0] = link->kind == LINK_SLIDE ? link->slide : link->spin;
    if (link->kind == LINK_FLOATING) {
        own[-2] = link->motion.x;
        own[-1] = link->motion.y;
    }
}

// From the leaves inwards: eliminates where a state is given, and takes the forces along where they
// are wanted; of a part alone, these.
static inline bool sweep_inwards(Articulated *articulated, const ArticulatedPart *part,
                                 const TreeState *state, bool has_forces, const double *sides)
{
    ArticulatedLink *links = articulated->links;
    for (size_t number = articulated_part_count(part, articulated->tree->node_count);
         number-- > 0;) {
        const size_t i = articulated_part_node(part, number);
        ArticulatedLink *link = &links[i];
        ArticulatedLink *parent = link->parent >= 0 ? &links[link->parent] : NULL;
        if (link->has_fronts) {
            if (state != NULL && !articulated_gather(articulated, (int)i, state)) {
                return false;
            }
            if (has_forces) {
                articulated_gather_sides(articulated, (int)i, sides);
            }
        }
        if (state != NULL) {
            if (!articulated_eliminate(link)) {
                return false;
            }
            if (link->has_own_front) {
                articulated_take_out(articulated, (int)i);
            }
            if (parent != NULL) {
                articulated_pass_inwards(link, parent);
            }
        }
        if (has_forces) {
            articulated_push_inwards(link, parent);
            if (link->has_own_front) {
                articulated_take_out_sides(articulated, (int)i);
            }
        }
    }
    if (state != NULL && !articulated_gather(articulated, -1, state)) {
        return false;
    }
    if (has_forces) {
        articulated_gather_ground_sides(articulated, part, sides);
    }
    return true;
}

static inline void sweep_outwards(Articulated *articulated, const ArticulatedPart *part,
                                  double *rates)
{
    ArticulatedLink *links = articulated->links;
    const size_t count = articulated_part_count(part, articulated->tree->node_count);
    double *multipliers = rates + articulated->tree->coordinate_count;
    articulated_find_ground_multipliers(articulated, part, multipliers);
    for (size_t number = 0; number < count; number++) {
        const size_t i = articulated_part_node(part, number);
        ArticulatedLink *link = &links[i];
        if (link->has_own_front) {
            articulated_add_multipliers(articulated, (int)i, multipliers);
        }
        move_outwards(link, link->parent >= 0 ? &links[link->parent] : NULL);
        if (link->has_fronts) {
            articulated_find_multipliers(articulated, (int)i, multipliers);
        }
        write_rates(link, rates);
    }
}

bool articulated_factor(Articulated *articulated, const TreeState *state)
{
    for (size_t i = 0; i < articulated->tree->node_count; i++) {
        articulated_start_link(articulated, i, state, &articulated->links[i]);
    }
    articulated->notes_distance = true;
    articulated->distance = 1.0;
    articulated->is_factored = sweep_inwards(articulated, NULL, state, false, NULL);
    articulated->notes_distance = false;
    return articulated->is_factored;
}

static inline void articulated_solve_links(Articulated *articulated, const ArticulatedPart *part,
                                           const ArticulatedPush *pushes, const double *sides,
                                           double *rates)
{
    const size_t count = articulated_part_count(part, articulated->tree->node_count);
    for (size_t number = 0; number < count; number++) {
        ArticulatedLink *link = &articulated->links[articulated_part_node(part, number)];
        const ArticulatedPush *push = &pushes[link->body];
        link->force = push->force;
        link->moment = push->moment + vec2_dot(link->centre, push->force);
    }
    sweep_inwards(articulated, part, NULL, true, sides);
    sweep_outwards(articulated, part, rates);
}

void articulated_solve(Articulated *articulated, const ArticulatedPush *pushes, const double *sides,
                       double *rates)
{
    articulated_solve_links(articulated, NULL, pushes, sides, rates);
}

void articulated_solve_part(Articulated *articulated, size_t part, const ArticulatedPush *pushes,
                            double *rates)
{
    const ArticulatedPart own = articulated_part(&articulated->parts, part);
    articulated_solve_links(articulated, &own, pushes, NULL, rates);
}

// The force on a body less what its bias takes of it.
static inline void push_link(const TreeState *state, const ArticulatedPush *pushes,
                             ArticulatedLink *link)
{
    const ArticulatedPush *push = &pushes[link->body];
    link->force = vec2_sub(push->force, vec2_scale(link->mass, state->bias[link->body]));
    link->moment = push->moment + vec2_dot(link->centre, link->force);
}

bool articulated_accelerate(Articulated *articulated, const TreeState *state,
                            const ArticulatedPush *pushes, const double *sides, double *rates)
{
    if (articulated->is_plain) {
        return articulated_tree_accelerate(articulated, state, pushes, rates);
    }
    for (size_t i = 0; i < articulated->tree->node_count; i++) {
        articulated_start_link(articulated, i, state, &articulated->links[i]);
        push_link(state, pushes, &articulated->links[i]);
    }
    articulated->is_factored = sweep_inwards(articulated, NULL, state, true, sides);
    if (!articulated->is_factored) {
        return false;
    }
    sweep_outwards(articulated, NULL, rates);
    return true;
}

bool articulated_accelerate_again(Articulated *articulated, const TreeState *state,
                                  const ArticulatedPush *pushes, const double *sides, double *rates)
{
    if (!articulated->is_factored) {
        return false;
    }
    for (size_t i = 0; i < articulated->tree->node_count; i++) {
        push_link(state, pushes, &articulated->links[i]);
    }
    sweep_inwards(articulated, NULL, NULL, true, sides);
    sweep_outwards(articulated, NULL, rates);
    return true;
}
