// How does a tree of hinges and floating bodies accelerate? As in reference/articulated.c, with
// nothing worked out that such a tree does not need: most small mechanisms with play are one.
//
// What hangs on a body is gathered in its link, which is empty again once it has been used.
#include "reference/articulated_tree.h"

// From the parent's reference to the body's, turned.
static inline Vec2 lever_of(const ArticulatedLink *link, const ArticulatedLink *parent,
                            const TreeState *state)
{
    Vec2 arm = state->arms[link->parent_end];
    if (parent->kind == LINK_HINGE) {
        arm = vec2_sub(arm, state->arms[parent->own_end]);
    }
    return vec2_perp(arm);
}

// Adds what hangs on a body to what it has itself.
static inline void take_gathered(ArticulatedLink *link, double *j)
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
static inline void hand_on(ArticulatedLink *link, ArticulatedLink *parent, const TreeState *state)
{
    const Vec2 b = link->b;
    const Vec2 share = vec2_scale(link->inverse, b);
    const double xx = link->xx - share.x * b.x;
    const double xy = link->xy - share.x * b.y;
    const double yy = link->yy - share.y * b.y;
    const Vec2 force = vec2_sub(link->force, vec2_scale(link->moment, share));
    const Vec2 lever = lever_of(link, parent, state);
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
static inline bool solve_floating(ArticulatedLink *link, double *rates)
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

bool articulated_tree_accelerate(Articulated *articulated, const TreeState *state,
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
            take_gathered(link, &j);
            link->inverse = 1.0 / j;
            is_solved = solve_floating(link, rates) && j > 0.0 && is_solved;
            continue;
        }
        // from the pin to the centre, turned
        const Vec2 arm = state->arms[link->own_end];
        const Vec2 centre = {arm.y, -arm.x};
        link->moment += vec2_dot(centre, force);
        link->b = vec2_scale(link->mass, centre);
        if (link->has_children) {
            take_gathered(link, &j);
        } else {
            link->xx = link->yy = link->mass;
            link->xy = 0.0;
        }
        link->inverse = 1.0 / j;
        is_solved = j > 0.0 && is_solved;
        if (link->parent >= 0) {
            hand_on(link, &links[link->parent], state);
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
