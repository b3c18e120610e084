// Bodies of a tree that slide, or that loops hang on (reference/articulated.h).
#pragma once

#include "reference/articulated_links.h"

// The fronts at a node, or at the ground (-1): their elimination, and both halves of a solution.
// Loops' right sides NULL: zeros.
bool articulated_fronts_factor(Articulated *articulated, int node, const TreeState *state);
void articulated_fronts_inwards(Articulated *articulated, int node, const double *sides);
void articulated_fronts_outwards(Articulated *articulated, int node, double *multipliers);
