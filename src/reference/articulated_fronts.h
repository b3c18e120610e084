// The loops of a tree (reference/articulated.h): their rows are carried inwards, and eliminated
// where their ends come together.
#pragma once

#include "reference/articulated_links.h"

// Gathers the rows at a node, or at the ground (-1), before its freedom is eliminated, and
// eliminates the loops whose ends come together there.
bool articulated_gather(Articulated *articulated, int node, const TreeState *state);

// Takes the freedom of a node, which has been eliminated, out of its rows.
void articulated_take_out(Articulated *articulated, int node);

// The same of the right side, that of the loops' rows or NULL: zeros.
void articulated_gather_sides(Articulated *articulated, int node, const double *sides);
void articulated_take_out_sides(Articulated *articulated, int node);

// Gathers them at the ground, of a part or of all (NULL).
void articulated_gather_ground_sides(Articulated *articulated, const ArticulatedPart *part,
                                     const double *sides);

// Adds to the forces on a node's freedom what the loops' multipliers give it.
void articulated_add_multipliers(Articulated *articulated, int node, const double *multipliers);

// Finds the multipliers of the loops that come together at a node, whose motion is known.
void articulated_find_multipliers(Articulated *articulated, int node, double *multipliers);

// The same of those that come together at the ground, of a part or of all (NULL).
void articulated_find_ground_multipliers(Articulated *articulated, const ArticulatedPart *part,
                                         double *multipliers);
