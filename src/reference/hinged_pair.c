// How fast does a four-bar with one pin in a hole change?
//
// As reference/hinged.c and reference/hinged_bodies.c say it of any such tree, in the same order of
// operations, with what they keep for each body in variables instead of memory: an evaluation waits
// for each value before it has the next, and a value that goes through memory is late.
#include "reference/hinged_pair.h"

#include "contact/pin_hole.h"

// A body in motion.
typedef struct Moving {
    TurnedBy turn; // since the base
    double omega;
    Vec2 arm;   // from the centre to its hinge
    Vec2 moved; // of the centre since the base
    Vec2 velocity;
    Vec2 bias; // acceleration of the centre with all rates steady
} Moving;

// What presses on the driven body and, the other way, on the outer one.
typedef struct PairPress {
    Vec2 force;  // N, on the outer body
    double size; // N
    double moment;
    double power; // W, of the driven body's share
    double dissipated;
} PairPress;

bool hinged_pair_is(const Hinged *hinged)
{
    const HingedBody *bodies = hinged->bodies;
    if (hinged->driven == NULL || hinged->count != 2 || hinged->pin_count != 1 ||
        hinged->dynamics->tree.is_driven_hung_on || bodies[0].is_floating ||
        bodies[1].is_floating) {
        return false;
    }
    const HingedEnd *ends = hinged->pins[0].ends;
    const bool is_between = (ends[0].is_driven && ends[1].body == &bodies[1]) ||
                            (ends[1].is_driven && ends[0].body == &bodies[1]);
    return bodies[0].parent == NULL && bodies[1].parent == &bodies[0] && is_between;
}

// A body on a hinge of the ground.
static inline Moving move_on_ground(Vec2 base, double angle, double omega)
{
    Moving moving = {.turn = turned_by(angle), .omega = omega};
    const Vec2 turned = turned_arm(&moving.turn, base);
    moving.arm = vec2_add(base, turned);
    moving.moved = vec2_scale(-1.0, turned);
    moving.velocity = vec2_scale(-omega, vec2_perp(moving.arm));
    moving.bias = vec2_scale(omega * omega, moving.arm);
    return moving;
}

// One on a hinge of another, which is so far from that one's centre.
static inline Moving move_on(const Moving *parent, Vec2 outer_base, Vec2 base, double angle,
                             double omega, Vec2 *outer)
{
    Moving moving = move_on_ground(base, angle, omega);
    const double spun = parent->omega;
    const Vec2 turned = turned_arm(&parent->turn, outer_base);
    *outer = vec2_add(outer_base, turned);
    moving.moved = vec2_add(moving.moved, vec2_add(parent->moved, turned));
    moving.velocity =
        vec2_add(moving.velocity, vec2_add(parent->velocity, vec2_scale(spun, vec2_perp(*outer))));
    moving.bias = vec2_add(moving.bias, vec2_sub(parent->bias, vec2_scale(spun * spun, *outer)));
    return moving;
}

// How far an end has moved since the base.
static inline Vec2 move_end(const Moving *body, Vec2 base, Vec2 *arm, Vec2 *velocity)
{
    const Vec2 turned = turned_arm(&body->turn, base);
    *arm = vec2_add(base, turned);
    *velocity = vec2_add(body->velocity, vec2_scale(body->omega, vec2_perp(*arm)));
    return vec2_add(body->moved, turned);
}

static inline PairPress press(const HingedPin *pin, const Moving *driven, const Moving *outer)
{
    const Contact *contact = pin->contact;
    PairPress press = {.size = 0.0};
    if (contact->mode == CONTACT_APART) {
        return press;
    }
    const bool is_b = pin->ends[0].is_driven; // the outer body has the pin, and not the hole
    Vec2 arms[2];
    Vec2 velocities[2];
    const Vec2 moved_outer =
        move_end(outer, *pin->ends[is_b ? 1 : 0].base, &arms[1], &velocities[1]);
    const Vec2 moved_driven =
        move_end(driven, *pin->ends[is_b ? 0 : 1].base, &arms[0], &velocities[0]);
    const Vec2 moved = vec2_sub(moved_outer, moved_driven);
    const Vec2 speed = vec2_sub(velocities[1], velocities[0]);
    const double sense = is_b ? 1.0 : -1.0;
    const Vec2 gap = vec2_add(*pin->gap, vec2_scale(sense, moved));
    const PinHole pose =
        pin_hole_pose((Vec2){0.0, 0.0}, gap, vec2_scale(sense, speed), contact->clearance);
    const Press found = press_find(contact, -pose.gap, pose.approach_speed);
    press.dissipated = found.damping_power;
    if (contact->mode != CONTACT_PRESSING) {
        return press;
    }
    const Vec2 on_pin = vec2_scale(found.normal, pose.normal);
    press.force = vec2_scale(sense, on_pin);
    press.size = sqrt(vec2_dot(on_pin, on_pin));
    press.moment = vec2_cross(arms[1], press.force);
    press.power = vec2_dot(vec2_scale(-1.0, press.force), velocities[0]);
    return press;
}

// The second rates of both bodies; false where they are not determined.
static inline bool solve(const HingedBody *bodies, const Moving *inner, const Moving *outer,
                         Vec2 lever_arm, const PairPress *pressed, double spins[2])
{
    // the outer body, whose turning about its hinge is eliminated
    const double mass = bodies[1].mass;
    const Vec2 weight = {0.0, -bodies[1].weight};
    const Vec2 force = vec2_sub(vec2_add(weight, pressed->force), vec2_scale(mass, outer->bias));
    const Vec2 centre = {outer->arm.y, -outer->arm.x};
    const double moment = pressed->moment + vec2_dot(centre, force);
    const Vec2 b = vec2_scale(mass, centre);
    const double inverse = 1.0 / bodies[1].inertia;
    const Vec2 share = vec2_scale(inverse, b);
    const double xx = mass - share.x * b.x;
    const double xy = 0.0 - share.x * b.y;
    const double yy = mass - share.y * b.y;
    const Vec2 left = vec2_sub(force, vec2_scale(moment, share));
    const Vec2 lever = vec2_perp(vec2_sub(lever_arm, inner->arm));
    const Vec2 moved = {xx * lever.x + xy * lever.y, xy * lever.x + yy * lever.y};
    // the inner one with what hangs on it
    const Vec2 own_force =
        vec2_sub((Vec2){0.0, -bodies[0].weight}, vec2_scale(bodies[0].mass, inner->bias));
    const Vec2 own_centre = {inner->arm.y, -inner->arm.x};
    const double own_moment = 0.0 + vec2_dot(own_centre, own_force) + vec2_dot(lever, left);
    const double inertia = bodies[0].inertia + vec2_dot(lever, moved);
    spins[0] = 1.0 / inertia * own_moment;
    const Vec2 motion = vec2_scale(spins[0], lever);
    spins[1] = inverse * moment - vec2_dot(share, motion);
    return bodies[1].inertia > 0.0 && inertia > 0.0;
}

bool hinged_pair_rates(const Hinged *hinged, double since_s, const double *y, double *rates)
{
    const HingedBody *bodies = hinged->bodies;
    const double drive_omega = hinged->dynamics->tree.base_drive.omega;
    const size_t columns[2] = {bodies[0].column, bodies[1].column};
    const Moving driven =
        move_on_ground(*hinged->driven->own_base, drive_omega * since_s, drive_omega);
    const Moving inner = move_on_ground(*bodies[0].own_base, y[columns[0]], y[2 + columns[0]]);
    Vec2 lever_arm;
    const Moving outer = move_on(&inner, *bodies[1].outer_base, *bodies[1].own_base, y[columns[1]],
                                 y[2 + columns[1]], &lever_arm);
    const PairPress pressed = press(&hinged->pins[0], &driven, &outer);
    double spins[2];
    const bool is_solved = solve(bodies, &inner, &outer, lever_arm, &pressed, spins);
    rates[0] = y[2];
    rates[1] = y[3];
    rates[2 + columns[0]] = spins[0];
    rates[2 + columns[1]] = spins[1];
    const Vec2 upward = {0.0, hinged->dynamics->system.scenario->gravity};
    const Vec2 needed = vec2_scale(hinged->driven->mass, vec2_add(driven.bias, upward));
    double *sums = rates + 4;
    sums[SYSTEM_DRIVE_WORK] = vec2_dot(needed, driven.velocity) - pressed.power;
    sums[SYSTEM_DISSIPATED] = pressed.dissipated;
    sums[SYSTEM_FRICTION] = 0.0;
    sums[SYSTEM_IMPULSES] = pressed.size;
    return is_solved;
}
