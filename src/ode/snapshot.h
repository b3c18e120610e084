// How ODE holds a body that moves in the plane, cheap enough to be looked at in every step.
#pragma once

#include "base/vec2.h"

#include <ode/ode.h>

typedef struct Snapshot {
    Vec2 position;  // m
    Vec2 direction; // unit: where the body's x axis points
    Vec2 velocity;  // m/s
    double omega;   // rad/s
} Snapshot;

// The state of a body; NULL is the ground.
static inline Snapshot snapshot_of(dBodyID body)
{
    if (body == NULL) {
        return (Snapshot){.direction = {1.0, 0.0}};
    }
    const dReal *position = dBodyGetPosition(body);
    const dReal *rotation = dBodyGetRotation(body);
    const dReal *velocity = dBodyGetLinearVel(body);
    return (Snapshot){
        .position = {position[0], position[1]},
        .direction = {rotation[0], rotation[4]},
        .velocity = {velocity[0], velocity[1]},
        .omega = dBodyGetAngularVel(body)[2],
    };
}

// A vector given in the body's frame, in the world's.
static inline Vec2 snapshot_turn(const Snapshot *body, Vec2 local)
{
    const Vec2 x = body->direction;
    return (Vec2){x.x * local.x - x.y * local.y, x.y * local.x + x.x * local.y};
}

// The velocity of the body's point that is at an arm from its centre, m, in the world's frame.
static inline Vec2 snapshot_velocity(const Snapshot *body, Vec2 arm)
{
    return vec2_add(body->velocity, vec2_scale(body->omega, vec2_perp(arm)));
}
