// How does a tree of hinges and floating bodies accelerate? As in reference/articulated_tree.c.
#include "reference/hinged_bodies.h"

// What a body resists with, and what hangs on it.
typedef struct Mass {
    double xx;
    double xy;
    double yy;
    Vec2 b;
    double j;
} Mass;

// Adds what hangs on a body to what it has itself.
static inline void take_gathered(HingedBody *body, Mass *mass, Vec2 *force, double *moment)
{
    const ArticulatedGathered *gathered = &body->gathered;
    mass->xx += gathered->xx;
    mass->xy += gathered->xy;
    mass->yy += gathered->yy;
    mass->b = vec2_add(mass->b, gathered->b);
    mass->j += gathered->j;
    *force = vec2_add(*force, gathered->force);
    *moment += gathered->moment;
    body->gathered = (ArticulatedGathered){.xx = 0.0};
}

// Gathers what is left of a body without its turning where it hangs.
static inline void hand_on(const Mass *mass, Vec2 force, double moment, double inverse,
                           HingedBody *body)
{
    const HingedBody *parent = body->eliminated;
    const Vec2 b = mass->b;
    const Vec2 share = vec2_scale(inverse, b);
    const double xx = mass->xx - share.x * b.x;
    const double xy = mass->xy - share.x * b.y;
    const double yy = mass->yy - share.y * b.y;
    const Vec2 left = vec2_sub(force, vec2_scale(moment, share));
    const Vec2 lever =
        vec2_perp(parent->is_floating ? body->outer : vec2_sub(body->outer, parent->arm));
    const Vec2 moved = {xx * lever.x + xy * lever.y, xy * lever.x + yy * lever.y};
    body->share = share;
    body->lever = lever;
    ArticulatedGathered *to = &body->eliminated->gathered;
    to->xx += xx;
    to->xy += xy;
    to->yy += yy;
    to->b = vec2_add(to->b, moved);
    to->j += vec2_dot(lever, moved);
    to->force = vec2_add(to->force, left);
    to->moment += vec2_dot(lever, left);
}

// Solves for a body that floats.
static inline bool solve_floating(HingedBody *body, double *rates)
{
    Vec2 force = vec2_sub(body->force, vec2_scale(body->mass, body->bias));
    double moment = body->moment;
    double *own = rates + body->column;
    if (!body->has_children) {
        own[-2] = force.x / body->mass;
        own[-1] = force.y / body->mass;
        own[0] = moment / body->inertia;
        return true;
    }
    Mass mass = {body->mass, 0.0, body->mass, {0.0, 0.0}, body->inertia};
    take_gathered(body, &mass, &force, &moment);
    const double inverse = 1.0 / mass.j;
    const Vec2 share = vec2_scale(inverse, mass.b);
    const Vec2 left = vec2_sub(force, vec2_scale(moment, share));
    const double xx = mass.xx - share.x * mass.b.x;
    const double xy = mass.xy - share.x * mass.b.y;
    const double slope = xy / xx;
    const double yy = mass.yy - share.y * mass.b.y - slope * xy;
    const double y = (left.y - slope * left.x) / yy;
    body->motion = (Vec2){(left.x - xy * y) / xx, y};
    body->spin = inverse * moment - vec2_dot(share, body->motion);
    own[-2] = body->motion.x;
    own[-1] = body->motion.y;
    own[0] = body->spin;
    return mass.j > 0.0 && xx > 0.0 && yy > 0.0;
}

// Eliminates the turning of a body about its hinge.
static inline bool eliminate(HingedBody *body)
{
    Vec2 force = vec2_sub(body->force, vec2_scale(body->mass, body->bias));
    // from the hinge to the centre, turned
    const Vec2 centre = {body->arm.y, -body->arm.x};
    double moment = body->moment + vec2_dot(centre, force);
    Mass mass = {body->mass, 0.0, body->mass, vec2_scale(body->mass, centre), body->inertia};
    if (body->has_children) {
        take_gathered(body, &mass, &force, &moment);
    }
    const double inverse = 1.0 / mass.j;
    if (body->eliminated != NULL) {
        hand_on(&mass, force, moment, inverse, body);
    }
    body->inverse = inverse;
    body->own_moment = moment;
    return mass.j > 0.0;
}

static inline void turn(HingedBody *body, double *rates)
{
    double spin = body->inverse * body->own_moment;
    Vec2 motion = {0.0, 0.0};
    const HingedBody *parent = body->eliminated;
    if (parent != NULL) {
        motion = vec2_add(parent->motion, vec2_scale(parent->spin, body->lever));
        spin -= vec2_dot(body->share, motion);
    }
    body->motion = motion;
    body->spin = spin;
    rates[body->column] = spin;
}

bool hinged_bodies_solve(HingedBody *bodies, size_t count, double *rates)
{
    bool is_solved = true;
    for (HingedBody *body = bodies + count; body-- > bodies;) {
        const bool is_well = body->is_floating ? solve_floating(body, rates) : eliminate(body);
        is_solved = is_solved && is_well;
    }
    for (HingedBody *body = bodies; body < bodies + count; body++) {
        if (!body->is_floating) {
            turn(body, rates);
        }
    }
    return is_solved;
}
