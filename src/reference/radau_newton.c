// How do the equations of Newton's method for all stages of an implicit step fall apart?
//
//     (1 - h a D - h^2 a S a) dz = r
// a the couplings, D and S the derivatives of the accelerations by rates and coordinates at each
// stage (reference/radau.c). Coordinates that never feel one another make blocks of their own.
#include "reference/radau_newton.h"

#include "base/dense.h"
#include "base/room.h"
#include "base/zeroed.h"

#include <string.h>

void radau_newton_init(RadauNewton *newton, size_t count)
{
    *newton = (RadauNewton){.count = count};
    newton->by_position[0] = zeroed(2 * RADAU_STAGES * count * count, sizeof(double));
    newton->own = zeroed(RADAU_STAGES * count, sizeof *newton->own);
    newton->blocks = zeroed(count, sizeof *newton->blocks);
    newton->members = zeroed(count, sizeof *newton->members);
    newton->place = zeroed(count, sizeof *newton->place);
    newton->is_taken = zeroed(count, sizeof *newton->is_taken);
    newton->pivots = zeroed(RADAU_STAGES * count, sizeof *newton->pivots);
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        newton->by_position[i] = newton->by_position[0] + i * count * count;
        newton->by_rate[i] = newton->by_position[0] + (RADAU_STAGES + i) * count * count;
    }
}

void radau_newton_finish(RadauNewton *newton)
{
    for (size_t i = 0; newton->blocks != NULL && i < newton->count; i++) {
        banded_finish(&newton->blocks[i].banded);
    }
    free(newton->by_position[0]);
    free(newton->own);
    free(newton->blocks);
    free(newton->members);
    free(newton->place);
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

// Sorts the coordinates into blocks: each takes in, one after the other, all that its members feel,
// so that those which feel each other are near to each other.
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
        RadauBlock *block = &newton->blocks[newton->block_count++];
        block->reach = 0;
        is_taken[first] = true;
        newton->place[first] = 0;
        newton->members[count++] = first;
        for (size_t at = start; at < count; at++) {
            for (size_t k = 0; k < n; k++) {
                if (is_taken[k] && newton->place[k] + start <= at) {
                    continue;
                }
                if (!are_coupled(newton, n, newton->members[at], k)) {
                    continue;
                }
                if (!is_taken[k]) {
                    is_taken[k] = true;
                    newton->place[k] = count - start;
                    newton->members[count++] = k;
                }
                const size_t apart = newton->place[k] + start - at;
                block->reach = apart > block->reach ? apart : block->reach;
            }
        }
        block->size = count - start;
        const size_t reach = RADAU_STAGES * (block->reach + 1);
        block->is_banded = 2 * reach + 1 < RADAU_STAGES * block->size;
    }
}

// How the equation of one coordinate at a stage depends on the rate of another at another stage.
typedef struct Weights {
    double rate;                    // s, of the derivative by rates at the other stage
    double positions[RADAU_STAGES]; // s^2, of those by coordinates at all stages
} Weights;

static Weights weights_of(double step, size_t stage, size_t other)
{
    Weights weights = {.rate = step * RADAU_COUPLING[stage][other]};
    for (size_t k = 0; k < RADAU_STAGES; k++) {
        weights.positions[k] = RADAU_COUPLING[stage][k] * RADAU_COUPLING[k][other];
    }
    return weights;
}

static double entry(const RadauNewton *newton, size_t at, const Weights *weights, double step,
                    size_t other, bool is_own)
{
    double twice = 0.0;
    for (size_t k = 0; k < RADAU_STAGES; k++) {
        twice += weights->positions[k] * newton->by_position[k][at];
    }
    return (is_own ? 1.0 : 0.0) - weights->rate * newton->by_rate[other][at] - step * step * twice;
}

// Newton's matrix of a block, the unknowns stage by stage.
static void fill_dense(const RadauNewton *newton, const size_t *members, size_t m, double step,
                       double *matrix)
{
    const size_t width = RADAU_STAGES * m;
    for (size_t stage = 0; stage < RADAU_STAGES; stage++) {
        for (size_t other = 0; other < RADAU_STAGES; other++) {
            const Weights weights = weights_of(step, stage, other);
            for (size_t row = 0; row < m; row++) {
                for (size_t column = 0; column < m; column++) {
                    const size_t at = members[row] * newton->count + members[column];
                    matrix[(stage * m + row) * width + other * m + column] =
                        entry(newton, at, &weights, step, other, stage == other && row == column);
                }
            }
        }
    }
}

// The same banded, the unknowns coordinate by coordinate.
static void fill_banded(const RadauNewton *newton, const size_t *members, RadauBlock *block,
                        double step)
{
    const size_t m = block->size;
    banded_shape(&block->banded, RADAU_STAGES * m, RADAU_STAGES * (block->reach + 1));
    for (size_t stage = 0; stage < RADAU_STAGES; stage++) {
        for (size_t other = 0; other < RADAU_STAGES; other++) {
            const Weights weights = weights_of(step, stage, other);
            for (size_t row = 0; row < m; row++) {
                const size_t first = row > block->reach ? row - block->reach : 0;
                for (size_t column = first; column < m && column <= row + block->reach; column++) {
                    const size_t at = members[row] * newton->count + members[column];
                    *banded_entry(&block->banded, RADAU_STAGES * row + stage,
                                  RADAU_STAGES * column + other) =
                        entry(newton, at, &weights, step, other, stage == other && row == column);
                }
            }
        }
    }
}

// Makes room for the blocks that are not banded.
static void make_room(RadauNewton *newton)
{
    size_t room = 0;
    for (size_t i = 0; i < newton->block_count; i++) {
        const size_t width = RADAU_STAGES * newton->blocks[i].size;
        room += newton->blocks[i].is_banded ? 0 : width * width;
    }
    newton->matrix = room_grow(newton->matrix, &newton->room, room, sizeof *newton->matrix);
}

bool radau_newton_factor(RadauNewton *newton, double step)
{
    find_blocks(newton, newton->count);
    make_room(newton);
    const size_t *members = newton->members;
    double *matrix = newton->matrix;
    size_t *pivots = newton->pivots;
    for (size_t i = 0; i < newton->block_count; i++) {
        RadauBlock *block = &newton->blocks[i];
        const size_t width = RADAU_STAGES * block->size;
        if (block->is_banded) {
            fill_banded(newton, members, block, step);
            if (!banded_factor(&block->banded)) {
                return false;
            }
        } else {
            fill_dense(newton, members, block->size, step, matrix);
            if (!dense_factor(width, matrix, pivots)) {
                return false;
            }
            matrix += width * width;
            pivots += width;
        }
        members += block->size;
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
    for (size_t i = 0; i < newton->block_count; i++) {
        const RadauBlock *block = &newton->blocks[i];
        const size_t m = block->size;
        const size_t width = RADAU_STAGES * m;
        // strides of stages and of coordinates
        const size_t by_stage = block->is_banded ? 1 : m;
        const size_t by_member = block->is_banded ? RADAU_STAGES : 1;
        for (size_t k = 0; k < width; k++) {
            own[k / m * by_stage + k % m * by_member] = change[k / m * n + members[k % m]];
        }
        if (block->is_banded) {
            banded_substitute(&block->banded, own);
        } else {
            dense_substitute(width, matrix, pivots, own);
            matrix += width * width;
            pivots += width;
        }
        for (size_t k = 0; k < width; k++) {
            change[k / m * n + members[k % m]] = own[k / m * by_stage + k % m * by_member];
        }
        members += m;
    }
}
