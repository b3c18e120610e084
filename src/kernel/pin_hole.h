// Where is a pin in its hole or slot, how deep in the wall, and how fast does it go deeper?
//
// Two circles, the pin inside the hole; exact, with no polygon between. Everything is measured at
// the circles' centres: e = pin centre - hole centre, gap = clearance - |e|,
// d' = e . (v_pin - v_hole) / |e|. The wall presses the pin along -e / |e|, inwards.
// Inline: the innermost call of every solver, some 5 ns.
//
// A slot is a hole about the nearest point of a segment, its middle line: between the ends two
// straight walls, at each end the arc of a hole. Across the change the gap and its rate go on, and
// the curvature jumps.
#pragma once

#include "base/vec2.h"

#include <stdbool.h>

typedef struct PinHole {
    Vec2 eccentricity;        // e, m: pin centre minus hole centre
    double eccentricity_size; // |e|, m
    double gap;               // m: clearance less |e|, negative inside the metal
    double penetration;       // m: the gap's negative, negative in the free play
    bool has_normal;          // false for a concentric pin, which has no nearest wall
    Vec2 normal;              // unit: direction of the force on the pin; zero without a normal
    double approach_speed;    // m/s: rate of the penetration; without a normal the relative
                              // speed, the pin moving towards the wall whichever way it goes
} PinHole;

// The pose of a pin from the centres of hole and pin, m, the velocity of the pin's centre less
// that of the hole's, m/s, and the radial clearance, m. Never a NaN from finite numbers.
static inline PinHole pin_hole_pose(Vec2 hole_centre, Vec2 pin_centre, Vec2 relative_velocity,
                                    double radial_clearance)
{
    const Vec2 e = vec2_sub(pin_centre, hole_centre);
    const double size = vec2_length(e);
    const double gap = radial_clearance - size;
    if (size == 0.0) {
        return (PinHole){
            .eccentricity = {0.0, 0.0},
            .eccentricity_size = 0.0,
            .gap = gap,
            .penetration = -gap,
            .has_normal = false,
            .normal = {0.0, 0.0},
            .approach_speed = vec2_length(relative_velocity),
        };
    }
    const Vec2 outward = {e.x / size, e.y / size};
    return (PinHole){
        .eccentricity = e,
        .eccentricity_size = size,
        .gap = gap,
        .penetration = -gap,
        .has_normal = true,
        .normal = {-outward.x, -outward.y},
        .approach_speed = vec2_dot(outward, relative_velocity),
    };
}

// The pose of a pin between two straight walls, in axes across them and along them, from the
// middle: the normal does not turn, and the size of the eccentricity is infinite. The clearance is
// half the distance of the walls less the pin's radius, m.
static inline PinHole pin_walls_pose(Vec2 pin, Vec2 velocity, double clearance)
{
    PinHole pose =
        pin_hole_pose((Vec2){0.0, 0.0}, (Vec2){pin.x, 0.0}, (Vec2){velocity.x, 0.0}, clearance);
    pose.eccentricity_size = INFINITY;
    return pose;
}

// The pose of a pin in a slot, likewise from the slot's middle. Its middle line reaches half its
// length to either side, m.
static inline PinHole pin_slot_pose(Vec2 pin, Vec2 velocity, double half_length, double clearance)
{
    const Vec2 end = {0.0, copysign(half_length, pin.y)};
    return fabs(pin.y) > half_length ? pin_hole_pose(end, pin, velocity, clearance)
                                     : pin_walls_pose(pin, velocity, clearance);
}

// The point of the hole's wall nearest the pin, m: where the contact force acts. The hole centre
// itself without a normal.
static inline Vec2 pin_hole_contact_point(const PinHole *pose, Vec2 hole_centre, double hole_radius)
{
    return vec2_sub(hole_centre, vec2_scale(hole_radius, pose->normal));
}
