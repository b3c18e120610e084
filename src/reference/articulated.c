// How does a tree with loops accelerate under forces, at a cost linear in its size?
//
// A body's motion is that of its reference: of a body on a revolute joint its pin, of others the
// centre. With e from there to the centre, p to the pin of a child (both turned by a quarter turn),
// K_c and F_c what a child is at that pin, the body resists an acceleration a, al by
//     A a + b al = f - sum F_c,   b a + J al = t - sum p F_c
//     A = m + sum K_c,  b = m e + sum K_c p,  J = I + m e^2 + sum p K_c p
// A revolute joint leaves al free:
//     al = t / J - (b / J) a,   K = A - b b^T / J
// Bodies with loops or slides: reference/articulated_fronts.c.
#include "reference/articulated.h"

#include "reference/articulated_fronts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

static void lay(Articulated *articulated, Layout *layout)
{
    const Tree *tree = articulated->tree;
    const Plan *plan = &articulated->plan;
    articulated->links = layout_take(layout, tree->node_count, sizeof *articulated->links);
    articulated->loops = layout_take(layout, articulated->loop_count, sizeof(int));
    size_t widest = 0;
    articulated->matrices = layout_take(layout, plan->front_count, sizeof(double *));
    articulated->vectors = layout_take(layout, plan->front_count, sizeof(double *));
    for (size_t i = 0; i < plan->front_count; i++) {
        const size_t width = plan->fronts[i].width;
        widest = width > widest ? width : widest;
        double *matrix = layout_take(layout, width * width, sizeof *matrix);
        double *vector = layout_take(layout, width, sizeof *vector);
        if (articulated->matrices != NULL) {
            articulated->matrices[i] = matrix;
            articulated->vectors[i] = vector;
        }
    }
    articulated->targets = layout_take(layout, widest, sizeof *articulated->targets);
}

static void set_links(Articulated *articulated)
{
    const Tree *tree = articulated->tree;
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const Body *body = &tree->linkage->bodies[node->body];
        const bool is_hinge = node->joint >= 0 && !node->is_sliding;
        const Vec2 arm = is_hinge ? tree->anchors[node->own_end] : (Vec2){0.0, 0.0};
        ArticulatedLink *link = &articulated->links[i];
        link->kind = is_hinge ? LINK_HINGE : (node->is_sliding ? LINK_SLIDE : LINK_FLOATING);
        link->has_own_front = articulated->plan.front_of[i] >= 0;
        link->has_fronts = articulated->plan.fronts_from[i + 1] < articulated->plan.fronts_from[i];
        link->mass = body->mass;
        link->inertia = body->inertia + body->mass * vec2_dot(arm, arm);
    }
}

Articulated *articulated_create(const Tree *tree, size_t loop_count, const int *loops)
{
    Articulated made = {.tree = tree, .loop_count = loop_count};
    articulated_plan_make(tree, loop_count, loops, &made.plan);
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
        free(articulated);
    }
}

// From the parent's reference to the body's, turned.
static inline Vec2 lever_of(const Articulated *articulated, size_t number, const TreeState *state)
{
    const TreeNode *node = &articulated->tree->nodes[number];
    Vec2 lever = node->is_sliding ? state->behind[number] : state->arms[node->parent_end];
    if (articulated->links[node->parent_node].kind == LINK_HINGE) {
        const int own_end = articulated->tree->nodes[node->parent_node].own_end;
        lever = vec2_sub(lever, state->arms[own_end]);
    }
    return vec2_perp(lever);
}

// What the body itself resists with.
static inline void start_link(const Articulated *articulated, size_t number, const TreeState *state,
                              ArticulatedLink *link)
{
    const TreeNode *node = &articulated->tree->nodes[number];
    if (link->kind == LINK_HINGE) {
        const Vec2 arm = state->arms[node->own_end];
        link->centre = (Vec2){arm.y, -arm.x};
    }
    if (link->kind == LINK_SLIDE) {
        link->direction = state->along[number];
    }
    link->xx = link->yy = link->mass;
    link->xy = 0.0;
    link->j = link->inertia;
    link->b = vec2_scale(link->mass, link->centre);
    if (node->parent_node >= 0) {
        link->lever = lever_of(articulated, number, state);
    }
}

// Eliminates the turning of a body, and of one that floats its motion.
static inline bool eliminate(ArticulatedLink *link)
{
    const double inverse = 1.0 / link->j;
    const Vec2 share = vec2_scale(inverse, link->b);
    link->inverse = inverse;
    link->share = share;
    link->xx -= share.x * link->b.x;
    link->xy -= share.x * link->b.y;
    link->yy -= share.y * link->b.y;
    if (link->kind == LINK_FLOATING) {
        link->slope = link->xy / link->xx;
        link->yy -= link->slope * link->xy;
        return link->j > 0.0 && link->xx > 0.0 && link->yy > 0.0;
    }
    return link->j > 0.0;
}

// Adds a body that hangs to the one it hangs on.
static inline void hand_on(const ArticulatedLink *link, ArticulatedLink *parent)
{
    const Vec2 lever = link->lever;
    const Vec2 moved = {
        link->xx * lever.x + link->xy * lever.y,
        link->xy * lever.x + link->yy * lever.y,
    };
    parent->xx += link->xx;
    parent->xy += link->xy;
    parent->yy += link->yy;
    parent->b = vec2_add(parent->b, moved);
    parent->j += vec2_dot(lever, moved);
}

bool articulated_factor(Articulated *articulated, const TreeState *state)
{
    const Tree *tree = articulated->tree;
    ArticulatedLink *links = articulated->links;
    for (size_t i = 0; i < tree->node_count; i++) {
        start_link(articulated, i, state, &links[i]);
    }
    for (size_t i = tree->node_count; i-- > 0;) {
        ArticulatedLink *link = &links[i];
        if (link->has_fronts && !articulated_fronts_factor(articulated, (int)i, state)) {
            return false;
        }
        if (link->has_own_front) {
            continue;
        }
        if (!eliminate(link)) {
            return false;
        }
        if (tree->nodes[i].parent_node >= 0) {
            hand_on(link, &links[tree->nodes[i].parent_node]);
        }
    }
    return articulated_fronts_factor(articulated, -1, state);
}

// Of a body without a front: eliminates its turning, and hands the rest on to what it hangs on.
static inline void push_inwards(ArticulatedLink *link, ArticulatedLink *parent)
{
    link->force = vec2_sub(link->force, vec2_scale(link->moment, link->share));
    if (parent != NULL) {
        parent->force = vec2_add(parent->force, link->force);
        parent->moment += vec2_dot(link->lever, link->force);
    }
}

// Of a body without a front: its motion, from that of what it hangs on.
static inline void move_outwards(ArticulatedLink *link, const ArticulatedLink *parent)
{
    if (link->kind == LINK_FLOATING) {
        const Vec2 force = link->force;
        const double y = (force.y - link->slope * force.x) / link->yy;
        link->motion = (Vec2){(force.x - link->xy * y) / link->xx, y};
    } else {
        link->motion = articulated_at(link, parent);
    }
    link->spin = link->inverse * link->moment - vec2_dot(link->share, link->motion);
}

static void write_rates(const Articulated *articulated, size_t number, double *rates)
{
    const TreeNode *node = &articulated->tree->nodes[number];
    const ArticulatedLink *link = &articulated->links[number];
    double *own = &rates[node->column];
    own[0] = link->kind == LINK_SLIDE ? link->slide : link->spin;
    if (link->kind == LINK_FLOATING) {
        own[-2] = link->motion.x;
        own[-1] = link->motion.y;
    }
}

void articulated_solve(Articulated *articulated, const ArticulatedPush *pushes, const double *sides,
                       double *rates)
{
    const Tree *tree = articulated->tree;
    ArticulatedLink *links = articulated->links;
    double *multipliers = rates + tree->coordinate_count;
    for (size_t i = 0; i < tree->node_count; i++) {
        const ArticulatedPush *push = &pushes[tree->nodes[i].body];
        links[i].force = push->force;
        links[i].moment = push->moment + vec2_dot(links[i].centre, push->force);
    }
    for (size_t i = tree->node_count; i-- > 0;) {
        const int parent = tree->nodes[i].parent_node;
        if (links[i].has_fronts) {
            articulated_fronts_inwards(articulated, (int)i, sides);
        }
        if (!links[i].has_own_front) {
            push_inwards(&links[i], parent >= 0 ? &links[parent] : NULL);
        }
    }
    articulated_fronts_inwards(articulated, -1, sides);
    articulated_fronts_outwards(articulated, -1, multipliers);
    for (size_t i = 0; i < tree->node_count; i++) {
        const int parent = tree->nodes[i].parent_node;
        if (!links[i].has_own_front) {
            move_outwards(&links[i], parent >= 0 ? &links[parent] : NULL);
        }
        if (links[i].has_fronts) {
            articulated_fronts_outwards(articulated, (int)i, multipliers);
        }
        write_rates(articulated, i, rates);
    }
}
