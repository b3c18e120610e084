// How fast does a body with one pin in a hole of the ground change?
//
// As reference/hinged.c says it of any such tree, in the same order of operations, with nothing
// kept in memory between them, as in reference/hinged_pair.c.
#include "reference/hinged_lone.h"

#include "kernel/pin_hole.h"

bool hinged_lone_is(const Hinged *hinged)
{
    if (hinged->driven != NULL || hinged->count != 1 || hinged->pin_count != 1 ||
        !hinged->bodies[0].is_floating) {
        return false;
    }
    const HingedEnd *ends = hinged->pins[0].ends;
    return (ends[0].body == NULL) != (ends[1].body == NULL);
}

// What the wall does to the body.
typedef struct LonePress {
    Vec2 force;  // N
    double size; // N
    double moment;
    double dissipated;
} LonePress;

static inline LonePress press(const HingedPin *pin, size_t column, const double *q, const double *u)
{
    const Contact *contact = pin->contact;
    LonePress press = {.size = 0.0};
    if (contact->mode == CONTACT_APART) {
        return press;
    }
    const bool is_b = pin->ends[0].body == NULL; // the body has the pin, and not the hole
    const Vec2 nothing = {0.0, 0.0};
    const Vec2 base = *pin->ends[is_b ? 1 : 0].base;
    const TurnedBy turn = turned_by(q[column]);
    const Vec2 turned = turned_arm(&turn, base);
    const Vec2 arm = vec2_add(base, turned);
    const Vec2 centre_speed = {u[column - 2], u[column - 1]};
    const Vec2 speed = vec2_add(centre_speed, vec2_scale(u[column], vec2_perp(arm)));
    const Vec2 moved = vec2_add((Vec2){q[column - 2], q[column - 1]}, turned);
    const Vec2 apart = is_b ? vec2_sub(moved, nothing) : vec2_sub(nothing, moved);
    const Vec2 velocity = is_b ? vec2_sub(speed, nothing) : vec2_sub(nothing, speed);
    const PinHole pose =
        pin_hole_pose(nothing, vec2_add(*pin->gap, apart), velocity, contact->clearance);
    const Press found = press_find(contact, -pose.gap, pose.approach_speed);
    press.dissipated = found.damping_power;
    if (contact->mode == CONTACT_PRESSING) {
        const Vec2 on_pin = vec2_scale(found.normal, pose.normal);
        press.force = is_b ? on_pin : vec2_scale(-1.0, on_pin);
        press.size = sqrt(vec2_dot(on_pin, on_pin));
        press.moment = vec2_cross(arm, press.force);
    }
    return press;
}

bool hinged_lone_rates(const Hinged *hinged, double since_s, const double *y, double *rates)
{
    enum { COORDINATES = 3 };
    (void)since_s; // nothing is driven
    const HingedBody *body = &hinged->bodies[0];
    const double *u = y + COORDINATES;
    const LonePress pressed = press(&hinged->pins[0], body->column, y, u);
    const Vec2 force = vec2_add((Vec2){0.0, -body->weight}, pressed.force);
    for (size_t i = 0; i < COORDINATES; i++) {
        rates[i] = u[i];
    }
    double *second = rates + COORDINATES + body->column;
    second[-2] = force.x / body->mass;
    second[-1] = force.y / body->mass;
    second[0] = pressed.moment / body->inertia;
    double *sums = rates + 2 * COORDINATES;
    sums[SYSTEM_DRIVE_WORK] = 0.0;
    sums[SYSTEM_DISSIPATED] = pressed.dissipated;
    sums[SYSTEM_FRICTION] = 0.0;
    sums[SYSTEM_IMPULSES] = pressed.size;
    return true;
}
