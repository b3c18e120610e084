// How many unknowns of a sparse system are independent, to full precision: by orthogonal
// transformations of the rows one after the other, in the blocks of a sparse matrix.
//
// The unknowns are the rows of a Sparse (base/sparse.h) that keeps none; an equation may hold the
// unknowns of nodes that are all linked with each other.
#pragma once

#include "base/sparse.h"

// Takes an equation in: its coefficients by unknown, zero but in those nodes, of which the first in
// the order of elimination is given by that order. They are zeroed. Before the first equation the
// matrix is cleared.
void sparse_rank_add(Sparse *sparse, size_t first, double *coefficients);

// The number of unknowns of which more than a share of their column in all equations is left once
// those before them are taken out. `squares`: by unknown the sum of its squared coefficients;
// `room`: a number for each unknown, zero.
size_t sparse_rank_find(Sparse *sparse, const double *squares, double share, double *room);

// Takes an equation in as sparse_rank_add does, if it does not follow from those before: more than
// a share of its size, the root of its squared coefficients, is left of it once they are taken out.
// Returns whether. The coefficients are zeroed.
bool sparse_rank_take(Sparse *sparse, size_t first, double size, double share,
                      double *coefficients);

// What would be left of an equation, as a share of its size, if it were taken in. The coefficients
// are zeroed.
double sparse_rank_left(const Sparse *sparse, size_t first, double size, double *coefficients);
