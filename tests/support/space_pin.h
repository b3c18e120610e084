// One pin in space in a hole of the ground about the origin.
#pragma once

#include "mechanism.h"

#include "contact/damping.h"
#include "model/space.h"

#define SPACE_PIN_WIDTH 20e-3 // m

// A pin of radius 5 mm, 1 kg, whose centre of mass is a distance along its axis from its middle, m.
// The hole's axis is z; no gravity, linear contact of a stiffness, N/m, without damping or
// friction, collars with an axial clearance, m, or none where that is 0. It starts in the middle,
// at rest.
static inline Scenario space_pin(double radial_clearance, double axial_clearance, double along,
                                 double stiffness)
{
    Scenario scenario = mechanism_pin(1.0, radial_clearance);
    scenario.linkage.is_spatial = true;
    Body *body = &scenario.linkage.bodies[0];
    body->inertia = 2e-5;
    body->space.inertia_x = body->space.inertia_y = 1e-4;
    body->space.height = along;
    Joint *joint = &scenario.linkage.joints[0];
    joint->clearance.width = SPACE_PIN_WIDTH;
    joint->space.axis = (Vec3){0.0, 0.0, 1.0};
    joint->space.axial_clearance = axial_clearance;
    scenario.contact.stiffness = stiffness;
    scenario.contact.exponent = 1.0;
    scenario.contact.damping = DAMPING_NONE;
    return scenario;
}

static inline void space_pin_damp(Scenario *scenario, double coefficient)
{
    scenario->contact.damping = DAMPING_VISCOUS;
    scenario->contact.viscous_coefficient = coefficient;
}
