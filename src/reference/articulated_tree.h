// A tree of hinges and floating bodies without loops (reference/articulated.h).
#pragma once

#include "reference/articulated_links.h"

// What articulated_accelerate does, of such a tree.
bool articulated_tree_accelerate(Articulated *articulated, const TreeState *state,
                                 const ArticulatedPush *pushes, double *rates);
