// How does a tree with loops accelerate under forces, at a cost linear in its size?
//
// A body's motion x is that of its reference: of a body on a revolute joint its pin, of others the
// centre; al is its spin. With e from there to the centre, p to the reference of a body that hangs
// on it (both turned by a quarter turn), and A_c, b_c, J_c what that one has left, it resists by
//     A x + b al = f,   b x + J al = t
//     A = m + sum A_c,   b = m e + sum (b_c + A_c p),   J = I + m e^2 + sum (J_c + (2 b_c + A_c p)
//     p)
// A revolute joint leaves al free, and nothing but a mass at the pin is left:
//     al = (t - b x) / J,   A - b b^T / J,   b = 0,   J = 0
// A slide leaves the motion along it free, in the same way. Loops: reference/articulated_fronts.c.
#include "reference/articulated.h"

#include "reference/articulated_fronts.h"
#include "reference/articulated_tree.h"

#include <assert.h>
#include <stdlib.h>

static void lay(Articulated *articulated, Layout *layout)
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
        at.own = layout_take(layout, count, sizeof *at.own);
        at.along = layout_take(layout, count, sizeof *at.along);
        at.across = layout_take(layout, count, sizeof *at.across);
        at.vector = layout_take(layout, count, sizeof *at.vector);
        if (articulated->fronts != NULL) {
            articulated->fronts[i] = at;
        }
    }
}

static void set_links(Articulated *articulated)
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

static void make_plan(const Tree *tree, size_t loop_count, const int *loops, Plan *plan,
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
    make_plan(tree, loop_count, loops, &made.plan, &made.parts);
    Layout layout = {NULL, 0};
    layout_take(&layout, 1, sizeof made);
    lay(&made, &layout);
    Articulated *articulated = calloc(1, layout.used);
    assert(articulated != NULL);
    *articulated = made;
    layout = (Layout){(char *)articulated, 0};
    layout_take(&layout, 1, sizeof made);
    lay(articulated, &layout);
    for (size_t i = 0; i < loop_count; i++) {
        articulated->loops[i] = loops[i];
    }
    set_links(articulated);
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
static inline Vec2 lever_of(const Articulated *articulated, size_t number, const TreeState *state)
{
    const TreeNode *node = &articulated->tree->nodes[number];
    const ArticulatedLink *parent = &articulated->links[node->parent_node];
    const Vec2 arm = node->is_sliding ? state->behind[number] : state->arms[node->parent_end];
    // the centre of a hinge is known: it stands before what hangs on it
    return vec2_add(parent->centre, vec2_perp(arm));
}

// What the body itself resists with.
static inline void start_link(const Articulated *articulated, size_t number, const TreeState *state,
                              ArticulatedLink *link)
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
        link->lever = lever_of(articulated, number, state);
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
static inline bool eliminate(ArticulatedLink *link)
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
static inline void hand_on(const ArticulatedLink *link, ArticulatedLink *parent)
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
static inline void push_inwards(ArticulatedLink *link, ArticulatedLink *parent)
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
            if (!eliminate(link)) {
                return false;
            }
            if (link->has_own_front) {
                articulated_take_out(articulated, (int)i);
            }
            if (parent != NULL) {
                hand_on(link, parent);
            }
        }
        if (has_forces) {
            push_inwards(link, parent);
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
        start_link(articulated, i, state, &articulated->links[i]);
    }
    articulated->is_factored = sweep_inwards(articulated, NULL, state, false, NULL);
    return articulated->is_factored;
}

static inline void solve(Articulated *articulated, const ArticulatedPart *part,
                         const ArticulatedPush *pushes, const double *sides, double *rates)
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
    solve(articulated, NULL, pushes, sides, rates);
}

void articulated_solve_part(Articulated *articulated, size_t part, const ArticulatedPush *pushes,
                            double *rates)
{
    const ArticulatedPart own = articulated_part(&articulated->parts, part);
    solve(articulated, &own, pushes, NULL, rates);
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
        start_link(articulated, i, state, &articulated->links[i]);
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
