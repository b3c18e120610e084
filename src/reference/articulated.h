// The equations that say how a tree with loops accelerates under forces on its bodies:
//     M x = B^T f + J^T lambda,   J x = g
// in time and memory linear in the number of bodies, for trees, chains and loops in a row.
//
// Bodies are eliminated from the leaves inwards (articulated bodies: Featherstone 1983). What is
// left of a body whose joint turns freely is a mass at its pin alone, 2 by 2. A loop's multipliers
// are carried inwards by what they do to the pins of both its ends, and eliminated where these come
// together, at the innermost body that both ends hang on. There, and there alone, every pivot is
// one of M or of J M^-1 J^T: it vanishes only where the equations have no solution. Loops that come
// together at one body or at the ground are eliminated in an order that fills in little.
#pragma once

#include "reference/articulated_links.h"

// For the loops of some joints. The tree must outlive it. Never NULL; the caller destroys it.
Articulated *articulated_create(const Tree *tree, size_t loop_count, const int *loops);
void articulated_destroy(Articulated *articulated);

// Eliminates the unknowns at a state of the tree. Returns false where the equations have no
// solution.
bool articulated_factor(Articulated *articulated, const TreeState *state);

// Solves them for pushes, by body, and the loops' right sides (two numbers each, in the rows of
// loops_row; NULL: zeros). Writes the coordinates' rates x, and behind them the negative
// multipliers of the loops' rows, two each: what the joint gives its body b.
void articulated_solve(Articulated *articulated, const ArticulatedPush *pushes, const double *sides,
                       double *rates);

// The same of a part of the tree (Articulated.parts) and sides of zeros: reads the pushes and
// writes the rates of its bodies and loops alone.
void articulated_solve_part(Articulated *articulated, size_t part, const ArticulatedPush *pushes,
                            double *rates);

// Both at once, of pushes less what the bodies' bias takes of them (TreeState.bias): writes the
// second rates.
bool articulated_accelerate(Articulated *articulated, const TreeState *state,
                            const ArticulatedPush *pushes, const double *sides, double *rates);

// The same where the last elimination was at these coordinates, whatever their rates are now.
bool articulated_accelerate_again(Articulated *articulated, const TreeState *state,
                                  const ArticulatedPush *pushes, const double *sides,
                                  double *rates);
