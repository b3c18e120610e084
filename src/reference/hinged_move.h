// How the bodies of reference/hinged.h move, with everything of a body in one place: what its rates
// and its state at an instant have in common.
#pragma once

#include "reference/hinged_pair.h"

// The drive's speed is steady.
static inline void hinged_move_driven(const DriveState *drive, double since_s, HingedBody *body)
{
    const double omega = drive->omega;
    body->turn = turned_by(omega * since_s);
    body->omega = omega;
    const Vec2 base = *body->own_base;
    const Vec2 turned = turned_arm(&body->turn, base);
    const Vec2 arm = vec2_add(base, turned);
    body->arm = arm;
    body->moved = vec2_scale(-1.0, turned);
    body->velocity = vec2_scale(-omega, vec2_perp(arm));
    body->bias = vec2_scale(omega * omega, arm);
}

static inline void hinged_move_floating(HingedBody *body, const double *q, const double *u)
{
    const size_t column = body->column;
    body->turn = turned_by(q[column]);
    body->omega = u[column];
    body->arm = (Vec2){0.0, 0.0};
    body->moved = (Vec2){q[column - 2], q[column - 1]};
    body->velocity = (Vec2){u[column - 2], u[column - 1]};
    body->bias = (Vec2){0.0, 0.0};
}

static inline void hinged_move_hinged(HingedBody *body, const double *q, const double *u)
{
    const double omega = u[body->column];
    const TurnedBy turn = turned_by(q[body->column]);
    const Vec2 base = *body->own_base;
    const Vec2 turned = turned_arm(&turn, base);
    const Vec2 arm = vec2_add(base, turned);
    Vec2 moved = vec2_scale(-1.0, turned);
    Vec2 velocity = vec2_scale(-omega, vec2_perp(arm));
    Vec2 bias = vec2_scale(omega * omega, arm);
    const HingedBody *parent = body->parent;
    if (parent != NULL) {
        const double spun = parent->omega;
        const Vec2 outer_base = *body->outer_base;
        const Vec2 outer_turned = turned_arm(&parent->turn, outer_base);
        const Vec2 outer = vec2_add(outer_base, outer_turned);
        moved = vec2_add(moved, vec2_add(parent->moved, outer_turned));
        velocity =
            vec2_add(velocity, vec2_add(parent->velocity, vec2_scale(spun, vec2_perp(outer))));
        bias = vec2_add(bias, vec2_sub(parent->bias, vec2_scale(spun * spun, outer)));
        body->outer = outer;
    }
    body->turn = turn;
    body->omega = omega;
    body->arm = arm;
    body->moved = moved;
    body->velocity = velocity;
    body->bias = bias;
}

// How far an end has moved since the base, and how fast it does.
static inline Vec2 hinged_move_end(HingedEnd *end, Vec2 *velocity)
{
    const HingedBody *body = end->body;
    if (body == NULL) {
        *velocity = (Vec2){0.0, 0.0};
        return (Vec2){0.0, 0.0};
    }
    const Vec2 base = *end->base;
    const Vec2 turned = turned_arm(&body->turn, base);
    const Vec2 arm = vec2_add(base, turned);
    end->arm = arm;
    *velocity = vec2_add(body->velocity, vec2_scale(body->omega, vec2_perp(arm)));
    return vec2_add(body->moved, turned);
}

// Power, W, and force, N, of what acts on the driven body beside the drive.
typedef struct HingedLoad {
    double power;
    Vec2 force;
} HingedLoad;

static inline void hinged_load_driven(Vec2 force, Vec2 velocity, HingedLoad *driven)
{
    driven->power += vec2_dot(force, velocity);
    driven->force = vec2_add(driven->force, force);
}

static inline void hinged_load_end(const HingedEnd *end, Vec2 velocity, Vec2 force,
                                   HingedLoad *driven)
{
    HingedBody *body = end->body;
    if (end->is_driven) {
        hinged_load_driven(force, velocity, driven);
    } else if (body != NULL) {
        body->force = vec2_add(body->force, force);
        body->moment += vec2_cross(end->arm, force);
    }
}

// The acceleration of a body's centre.
static inline void hinged_accelerate(const double *rates, HingedBody *body)
{
    const double *own = rates + body->column;
    body->spin = own[0];
    if (body->is_floating) {
        body->acceleration = (Vec2){own[-2], own[-1]};
        return;
    }
    Vec2 carried = {0.0, 0.0};
    const HingedBody *parent = body->parent;
    if (parent != NULL) {
        const Vec2 turned = vec2_sub(vec2_scale(parent->spin, vec2_perp(body->outer)),
                                     vec2_scale(parent->omega * parent->omega, body->outer));
        carried = vec2_add(parent->acceleration, turned);
    }
    const Vec2 about = vec2_sub(vec2_scale(body->omega * body->omega, body->arm),
                                vec2_scale(body->spin, vec2_perp(body->arm)));
    body->acceleration = vec2_add(carried, about);
}

// What the driven body needs of all forces on it, N.
static inline Vec2 hinged_needed(const Hinged *hinged)
{
    const HingedBody *driven = hinged->driven;
    const Vec2 upward = {0.0, hinged->dynamics->system.scenario->gravity};
    return vec2_scale(driven->mass, vec2_add(driven->bias, upward));
}

static inline void hinged_move(const Hinged *hinged, double since_s, const double *q,
                               const double *u)
{
    if (hinged->driven != NULL) {
        hinged_move_driven(&hinged->dynamics->tree.base_drive, since_s, hinged->driven);
    }
    for (size_t i = 0; i < hinged->count; i++) {
        HingedBody *body = &hinged->bodies[i];
        if (body->is_floating) {
            hinged_move_floating(body, q, u);
        } else {
            hinged_move_hinged(body, q, u);
        }
        body->force = (Vec2){0.0, -body->weight};
        body->moment = 0.0;
    }
}
