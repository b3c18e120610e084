// Eigenvalues of small dense matrices that need not be symmetric.
#pragma once

#include <complex.h>
#include <stdbool.h>
#include <stddef.h>

// Writes the n eigenvalues of A, n by n and row by row, the largest first and of a pair of
// conjugate ones that above the real axis. False where a number is not finite or one cannot be
// found.
bool eigen_values(size_t n, const double *a, double complex *values);

// Writes the vector of length 1 to an eigenvalue: A x = value x, or, of the left, x' A = value x'
// (transposed, not conjugate). False where it cannot be found.
bool eigen_vector(size_t n, const double *a, double complex value, bool is_left, double complex *x);
