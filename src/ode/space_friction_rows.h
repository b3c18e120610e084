// Friction of the contacts in space.
#pragma once

#include "ode/space_contact.h"

// How the pin moves along the wall that it touches at a place, m/s.
Vec3 space_friction_rows_sliding(const PinSpace *place, const SpaceMotion *motions, Vec3 point,
                                 Vec3 normal);

// Gives all contacts of the step that touch at an end of a hole their rows along the wall, from the
// motions before the step and as its rows will see them.
void space_friction_rows_add(SpaceContacts *contacts, const SpaceMotion *motions,
                             const SpaceMotion *seen, double step_s);
