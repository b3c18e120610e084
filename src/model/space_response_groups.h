// Impulses in a few joints with play in space, and the few bodies that they move:
// model/response_groups.h in space.
#pragma once

#include "model/response_groups.h"
#include "model/space_response.h"

void space_response_groups_init(const SpaceResponse *response, ResponseGroups *groups);

// Writes by how much impulses in the places of a part, by row of play, change the velocities of its
// groups' bodies. Returns the impulses in all rows, of which those of the groups' ideal joints are
// right until the response is used again.
const double *space_response_groups_apply(const SpaceResponse *response,
                                          const ResponseGroups *groups, const ResponsePart *part,
                                          const double *impulses, SpaceChange *changes);
