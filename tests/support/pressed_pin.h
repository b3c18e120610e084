// A contact of one place that is under way, for contact/kernel_*.h.
#pragma once

#include "base/lcg.h"
#include "kernel/internal.h"

static const double PRESSED_CLEARANCE = 1e-4; // m
static const double PRESSED_DEPTH = 1e-7;     // m

// A pin in its wall, somewhere round the hole, sliding and turning and on its way in.
static inline Kernel pressed_pin(uint64_t *seed, double friction, size_t rows)
{
    Kernel pin = kernel_start(0.05);
    ForceLaw law = force_law_power(6.6e10, 1.5);
    law.hysteresis = 0.7;
    law.viscous = 30.0;
    kernel_add(&pin, &(KernelContact){.law = force_law_with_friction(law, friction, 5e-3)}, rows);
    kernel_make_room(&pin, rows);
    KernelContact *joint = &pin.contacts[0];
    joint->radial_clearance = PRESSED_CLEARANCE;
    joint->hole_radius = 5e-3;
    joint->state = contact_state_begun(0.1);
    const double angle = 3.0 * lcg_draw(seed);
    pin.position[0] = (PRESSED_CLEARANCE + PRESSED_DEPTH) * cos(angle);
    pin.position[1] = (PRESSED_CLEARANCE + PRESSED_DEPTH) * sin(angle);
    pin.speed[0] = 0.02 * cos(angle) + 5e-3 * lcg_draw(seed);
    pin.speed[1] = 0.02 * sin(angle) + 5e-3 * lcg_draw(seed);
    for (size_t i = 2; i < pin.row_count; i++) {
        pin.speed[i] = (i == KERNEL_ROW_AXIAL ? 5e-3 : 1.0) * lcg_draw(seed);
    }
    return pin;
}

// Makes of it a circle on a line, or a disc as deep in the other disc as the pin was in its wall.
static inline void press_elsewhere(Kernel *pin, bool is_line, double friction)
{
    KernelContact *joint = &pin->contacts[0];
    joint->shape = is_line ? KERNEL_LINE : KERNEL_DISC;
    joint->has_friction = friction > 0.0;
    if (is_line) {
        pin->position[0] = -PRESSED_DEPTH;
        pin->position[1] = 0.0;
        pin->speed[0] = -0.02;
        return;
    }
    joint->radial_clearance *= -1.0;
    joint->hole_radius *= -1.0;
    for (size_t i = 0; i < 2; i++) {
        pin->position[i] *=
            (PRESSED_CLEARANCE - PRESSED_DEPTH) / (PRESSED_CLEARANCE + PRESSED_DEPTH);
        pin->speed[i] *= -1.0;
    }
}

// Makes of it a pin in a slot along y, as deep in one of its straight walls, or in the arc at an
// end.
static inline void press_in_slot(Kernel *pin, bool is_at_end)
{
    KernelContact *joint = &pin->contacts[0];
    joint->shape = KERNEL_SLOT;
    joint->half_length = 0.01;
    if (is_at_end) {
        pin->position[1] += copysign(joint->half_length, pin->position[1]);
    } else {
        pin->position[0] = copysign(PRESSED_CLEARANCE + PRESSED_DEPTH, pin->position[0]);
        pin->position[1] *= 0.5 * joint->half_length / PRESSED_CLEARANCE;
        pin->speed[0] = copysign(0.02, pin->position[0]);
        pin->speed[1] *= 0.1; // no faster than friction takes hold
    }
}
