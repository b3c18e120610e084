// How do the equations of Newton's method for all stages of an implicit step fall apart?
//
//     (1 - h a D - h^2 a S a) dz = r
// a the couplings, D and S the derivatives of the accelerations by rates and coordinates at each
// stage (reference/radau.c). Coordinates that never feel one another make blocks of their own.
#include "reference/radau_newton.h"

#include "base/dense.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void radau_newton_init(RadauNewton *newton, size_t count)
{
    *newton = (RadauNewton){.count = count};
    newton->by_position[0] = calloc(2 * RADAU_STAGES * count * count, sizeof(double));
    newton->own = calloc(RADAU_STAGES * count, sizeof *newton->own);
    newton->sizes = calloc(count, sizeof *newton->sizes);
    newton->members = calloc(count, sizeof *newton->members);
    newton->is_taken = calloc(count, sizeof *newton->is_taken);
    assert(newton->by_position[0] != NULL && newton->own != NULL && newton->sizes != NULL &&
           newton->members != NULL && newton->is_taken != NULL);
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        newton->by_position[i] = newton->by_position[0] + i * count * count;
        newton->by_rate[i] = newton->by_position[0] + (RADAU_STAGES + i) * count * count;
    }
}

void radau_newton_finish(RadauNewton *newton)
{
    free(newton->by_position[0]);
    free(newton->own);
    free(newton->sizes);
    free(newton->members);
    free(newton->is_taken);
    free(newton->matrix);
    free(newton->pivots);
}

// Whether one of two coordinates feels the other at any stage.
static bool are_coupled(const RadauNewton *newton, size_t n, size_t a, size_t b)
{
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        const double *place = newton->by_position[i];
        const double *rate = newton->by_rate[i];
        if (place[a * n + b] != 0.0 || place[b * n + a] != 0.0 || rate[a * n + b] != 0.0 ||
            rate[b * n + a] != 0.0) {
            return true;
        }
    }
    return false;
}

// Sorts the coordinates into blocks: each takes in, one after the other, all that its members feel.
static void find_blocks(RadauNewton *newton, size_t n)
{
    bool *is_taken = newton->is_taken;
    memset(is_taken, 0, n * sizeof *is_taken);
    size_t count = 0;
    newton->block_count = 0;
    for (size_t first = 0; first < n; first++) {
        if (is_taken[first]) {
            continue;
        }
        const size_t start = count;
        is_taken[first] = true;
        newton->members[count++] = first;
        for (size_t at = start; at < count; at++) {
            for (size_t k = 0; k < n; k++) {
                if (!is_taken[k] && are_coupled(newton, n, newton->members[at], k)) {
                    is_taken[k] = true;
                    newton->members[count++] = k;
                }
            }
        }
        newton->sizes[newton->block_count++] = count - start;
    }
}

// One part of Newton's matrix of a block of m coordinates: how the equation of a stage depends on
// the rates of another.
static void fill_part(const RadauNewton *newton, size_t n, const size_t *members, size_t m,
                      double step, size_t stage, size_t other, double *matrix)
{
    const size_t width = RADAU_STAGES * m;
    double weights[RADAU_STAGES];
    for (size_t k = 0; k < RADAU_STAGES; k++) {
        weights[k] = RADAU_COUPLING[stage][k] * RADAU_COUPLING[k][other];
    }
    for (size_t row = 0; row < m; row++) {
        for (size_t column = 0; column < m; column++) {
            const size_t at = members[row] * n + members[column];
            double twice = 0.0;
            for (size_t k = 0; k < RADAU_STAGES; k++) {
                twice += weights[k] * newton->by_position[k][at];
            }
            const double own = stage == other && row == column ? 1.0 : 0.0;
            matrix[(stage * m + row) * width + other * m + column] =
                own - step * RADAU_COUPLING[stage][other] * newton->by_rate[other][at] -
                step * step * twice;
        }
    }
}

bool radau_newton_factor(RadauNewton *newton, double step)
{
    const size_t n = newton->count;
    if (newton->matrix == NULL) {
        const size_t width = RADAU_STAGES * n;
        newton->matrix = malloc(width * width * sizeof *newton->matrix);
        newton->pivots = malloc(width * sizeof *newton->pivots);
        assert(newton->matrix != NULL && newton->pivots != NULL);
    }
    find_blocks(newton, n);
    const size_t *members = newton->members;
    double *matrix = newton->matrix;
    size_t *pivots = newton->pivots;
    for (size_t block = 0; block < newton->block_count; block++) {
        const size_t m = newton->sizes[block];
        const size_t width = RADAU_STAGES * m;
        for (size_t i = 0; i < RADAU_STAGES; i++) {
            for (size_t j = 0; j < RADAU_STAGES; j++) {
                fill_part(newton, n, members, m, step, i, j, matrix);
            }
        }
        if (!dense_factor(width, matrix, pivots)) {
            return false;
        }
        members += m;
        matrix += width * width;
        pivots += width;
    }
    return true;
}

void radau_newton_solve(const RadauNewton *newton, double *change)
{
    const size_t n = newton->count;
    const size_t *members = newton->members;
    const double *matrix = newton->matrix;
    const size_t *pivots = newton->pivots;
    double *own = newton->own;
    for (size_t block = 0; block < newton->block_count; block++) {
        const size_t m = newton->sizes[block];
        const size_t width = RADAU_STAGES * m;
        for (size_t i = 0; i < width; i++) {
            own[i] = change[i / m * n + members[i % m]];
        }
        dense_substitute(width, matrix, pivots, own);
        for (size_t i = 0; i < width; i++) {
            change[i / m * n + members[i % m]] = own[i];
        }
        members += m;
        matrix += width * width;
        pivots += width;
    }
}
