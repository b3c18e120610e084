// The linear equations of Newton's method for the stages of an implicit step. Coordinates that have
// nothing to do with one another are in separate blocks, each factored by itself; a block whose
// coordinates meet only their neighbours, as those of a long chain, is banded.
#pragma once

#include "base/banded.h"
#include "reference/coupling.h"
#include "reference/radau_table.h"

#include <stdbool.h>
#include <stddef.h>

// Coordinates that feel one another, directly or by others.
typedef struct RadauBlock {
    size_t size; // of them
    size_t
        reach; // how far apart two are at most, in the block's order, of which one feels the other
    bool is_banded;
    Banded banded;
} RadauBlock;

typedef struct RadauNewton {
    const Coupling *coupling;
    size_t count; // of coordinates
    // derivatives of the accelerations at the stages, 1/s^2 and 1/s, for the caller to fill in, as
    // matrices of the coupling
    double *by_position[RADAU_STAGES];
    double *by_rate[RADAU_STAGES];
    size_t block_count;
    RadauBlock *blocks; // as many as there are coordinates
    size_t *members;    // which they are, block by block
    // room to work in, owned like all of the above
    bool *is_taken;
    double *own;
    size_t *place;  // of a coordinate in its block
    double *matrix; // of the blocks, one behind the other; NULL before the first
    size_t room;    // of it
    size_t *pivots;
} RadauNewton;

// The coupling must outlive it.
void radau_newton_init(RadauNewton *newton, const Coupling *coupling);
void radau_newton_finish(RadauNewton *newton);

// Sorts the coordinates into blocks by the derivatives and factors the matrix of each, for a step
// of a length. Returns false where one is singular.
bool radau_newton_factor(RadauNewton *newton, double step);

// Solves the factored equations in place; the unknowns by stages and coordinates.
void radau_newton_solve(const RadauNewton *newton, double *change);
