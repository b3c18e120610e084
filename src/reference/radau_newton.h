// The linear equations of Newton's method for the stages of an implicit step. Coordinates that have
// nothing to do with one another are in separate blocks, each factored by itself.
#pragma once

#include "reference/radau_table.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct RadauNewton {
    size_t count; // of coordinates
    // derivatives of the accelerations at the stages, 1/s^2 and 1/s, for the caller to fill in
    double *by_position[RADAU_STAGES];
    double *by_rate[RADAU_STAGES];
    size_t block_count;
    size_t *sizes;   // coordinates, by block
    size_t *members; // which they are, block by block
    // room to work in, owned like all of the above
    bool *is_taken;
    double *own;
    double *matrix; // blocks one behind the other; NULL before the first
    size_t *pivots;
} RadauNewton;

void radau_newton_init(RadauNewton *newton, size_t count);
void radau_newton_finish(RadauNewton *newton);

// Sorts the coordinates into blocks by the derivatives and factors the matrix of each, for a step
// of a length. Returns false where one is singular.
bool radau_newton_factor(RadauNewton *newton, double step);

// Solves the factored equations in place; the unknowns by stages and coordinates.
void radau_newton_solve(const RadauNewton *newton, double *change);
