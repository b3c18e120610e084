// The masses that pins in space meet along their normals.
#pragma once

#include "ode/space_contact.h"

// Brings the masses of all places that touch up to date, at the motions given: they change as
// slowly as the linkage turns, or when another place of a joint comes to touch.
void space_contact_mass_find(SpaceContacts *contacts, const SpaceMotion *motions);
