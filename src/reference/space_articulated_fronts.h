// The loops in the elimination of bodies in space: reference/articulated_fronts.h with
// SPACE_JOINT_ROWS rows a loop.
#pragma once

#include "reference/space_articulated_links.h"

// At a body, or at what no coordinate moves (-1), with what hangs there done: gathers its fronts'
// rows, and eliminates those of loops that come together there. Returns false where one that is
// held has no pivot.
bool space_fronts_gather(SpaceArticulated *articulated, int node, const SpaceTreeState *state,
                         const SpaceLoopRow *rows);

// Takes the freedoms of a body, which are eliminated, out of its front.
void space_fronts_take_out(SpaceArticulated *articulated, int node);

// The same of the right sides.
void space_fronts_gather_sides(SpaceArticulated *articulated, int node, const double *sides);
void space_fronts_take_out_sides(SpaceArticulated *articulated, int node);

// Those at the ground, of a part or of all (NULL).
void space_fronts_gather_ground_sides(SpaceArticulated *articulated, const ArticulatedPart *part,
                                      const double *sides);

// On the way outwards: gives a body what multipliers that are known push it with; finds those that
// are eliminated at a body whose motion is known.
void space_fronts_add_multipliers(SpaceArticulated *articulated, int node,
                                  const double *multipliers);
void space_fronts_find_multipliers(SpaceArticulated *articulated, int node, double *multipliers);

// Finds those that are eliminated at the ground, of a part or of all (NULL).
void space_fronts_find_ground_multipliers(SpaceArticulated *articulated,
                                          const ArticulatedPart *part, double *multipliers);
