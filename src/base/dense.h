// Small dense algebra: a few dozen unknowns, row by row in one array.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// Solves A x = b by Gaussian elimination with row pivoting. A is n by n, row by row; A and b are
// overwritten, b by x. Returns false where a pivot falls below 1e-14 times what elimination took
// from its column: the matrix is then singular to working precision, and b is not to be used.
bool dense_solve(size_t n, double *a, double *b);

// The same to the last bit in two parts, for several right-hand sides of one A: row k of it is
// exchanged with row pivots[k].
bool dense_split(size_t n, double *a, size_t *pivots);
void dense_solve_split(size_t n, const double *split, const size_t *pivots, double *b);

// The number of independent rows of A (rows by columns, overwritten): elimination with complete
// pivoting, a pivot counting when it is above tolerance times the first.
size_t dense_rank(size_t rows, size_t columns, double *a, double tolerance);

// For many right-hand sides, most of them short: factors A in place by row pivoting, row k
// exchanged with row pivots[k]; false where a column has no pivot that is not zero.
bool dense_factor(size_t n, double *a, size_t *pivots);
// Overwrites b by x.
void dense_substitute(size_t n, const double *factored, const size_t *pivots, double *b);
