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

void radau_newton_init(RadauNewton *newton, const Coupling *coupling)
{
    const size_t count = coupling->count;
    const size_t values = coupling_value_count(coupling);
    *newton = (RadauNewton){.coupling = coupling, .count = count};
    newton->by_position[0] = zeroed(2 * RADAU_STAGES * values, sizeof(double));
    newton->own = zeroed(RADAU_STAGES * count, sizeof *newton->own);
    newton->blocks = zeroed(count, sizeof *newton->blocks);
    newton->members = zeroed(count, sizeof *newton->members);
    newton->place = zeroed(count, sizeof *newton->place);
    newton->is_taken = zeroed(count, sizeof *newton->is_taken);
    newton->pivots = zeroed(RADAU_STAGES * count, sizeof *newton->pivots);
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        newton->by_position[i] = newton->by_position[0] + i * values;
        newton->by_rate[i] = newton->by_position[0] + (RADAU_STAGES + i) * values;
    }
}

void radau_newton_finish(RadauNewton *newton)
{
    free(newton->by_position[0]);
    free(newton->own);
    free(newton->blocks);
    free(newton->members);
    free(newton->place);
    free(newton->is_taken);
    free(newton->matrix);
    free(newton->pivots);
}

// Whether an entry of the derivatives is other than zero at any stage.
static bool is_felt(const RadauNewton *newton, size_t value)
{
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        if (newton->by_position[i][value] != 0.0 || newton->by_rate[i][value] != 0.0) {
            return true;
        }
    }
    return false;
}

// Whether one of two coordinates feels the other, of which `b` is the column at a place of the rows
// of the part of `a`.
static bool are_coupled(const RadauNewton *newton, size_t a, size_t place, size_t b)
{
    const Coupling *coupling = newton->coupling;
    return is_felt(newton, coupling->first_value[a] + place) ||
           is_felt(newton,
                   coupling->first_value[b] + coupling_place(coupling, coupling->part_of[b], a));
}

// The unknowns of a block, how far from the diagonal these equations reach, and how many values
// its matrix has.
static size_t width_of(const RadauBlock *block)
{
    return RADAU_STAGES * block->size;
}

static size_t reach_of(const RadauBlock *block)
{
    return RADAU_STAGES * (block->reach + 1);
}

static size_t size_of(const RadauBlock *block)
{
    const size_t width = width_of(block);
    return block->is_banded ? banded_size(width, reach_of(block)) : width * width;
}

// Sorts the coordinates into blocks: each takes in, one after the other, all that its members feel,
// so that those which feel each other are near to each other.
static void find_blocks(RadauNewton *newton)
{
    const Coupling *coupling = newton->coupling;
    const size_t n = coupling->count;
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
            const size_t part = coupling->part_of[newton->members[at]];
            const size_t *columns = coupling_columns(coupling, part);
            for (size_t i = 0; i < coupling_width(coupling, part); i++) {
                const size_t k = columns[i];
                if (is_taken[k] && newton->place[k] + start <= at) {
                    continue;
                }
                if (!are_coupled(newton, newton->members[at], i, k)) {
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
        block->is_banded = 2 * reach_of(block) + 1 < width_of(block);
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

// A matrix of a block, dense, the unknowns stage by stage; or banded, coordinate by coordinate.
typedef struct Matrix {
    double *dense; // NULL: banded
    const Banded *banded;
    size_t size; // of the block
} Matrix;

static double *matrix_entry(const Matrix *matrix, size_t stage, size_t row, size_t other,
                            size_t column)
{
    if (matrix->dense == NULL) {
        return banded_entry(matrix->banded, RADAU_STAGES * row + stage,
                            RADAU_STAGES * column + other);
    }
    const size_t m = matrix->size;
    return &matrix->dense[(stage * m + row) * RADAU_STAGES * m + other * m + column];
}

// What fills a matrix: of each stage by each other.
typedef struct Filling {
    double step;
    Weights weights[RADAU_STAGES][RADAU_STAGES];
} Filling;

static Filling filling_of(double step)
{
    Filling filling = {.step = step};
    for (size_t stage = 0; stage < RADAU_STAGES; stage++) {
        for (size_t other = 0; other < RADAU_STAGES; other++) {
            filling.weights[stage][other] = weights_of(step, stage, other);
        }
    }
    return filling;
}

// What a row of a block has of one of its columns, by the value of the derivatives there.
static void fill_entries(const RadauNewton *newton, const Filling *filling, size_t row,
                         size_t column, size_t value, const Matrix *matrix)
{
    for (size_t stage = 0; stage < RADAU_STAGES; stage++) {
        for (size_t other = 0; other < RADAU_STAGES; other++) {
            *matrix_entry(matrix, stage, row, other, column) =
                entry(newton, value, &filling->weights[stage][other], filling->step, other,
                      stage == other && row == column);
        }
    }
}

// Fills Newton's matrix of a block, which is all zeros.
static void fill(const RadauNewton *newton, const size_t *members, const Filling *filling,
                 const Matrix *matrix)
{
    const Coupling *coupling = newton->coupling;
    for (size_t row = 0; row < matrix->size; row++) {
        const size_t part = coupling->part_of[members[row]];
        const size_t *columns = coupling_columns(coupling, part);
        const size_t first = coupling->first_value[members[row]];
        for (size_t i = 0; i < coupling_width(coupling, part); i++) {
            const size_t column = newton->place[columns[i]];
            // others are those of other blocks, zeros
            if (column < matrix->size && members[column] == columns[i]) {
                fill_entries(newton, filling, row, column, first + i, matrix);
            }
        }
    }
}

// Makes room for the blocks: one for all, because which blocks there are differs from step to step.
static void make_room(RadauNewton *newton)
{
    size_t room = 0;
    for (size_t i = 0; i < newton->block_count; i++) {
        room += size_of(&newton->blocks[i]);
    }
    newton->matrix = room_grow(newton->matrix, &newton->room, room, sizeof *newton->matrix);
}

bool radau_newton_factor(RadauNewton *newton, double step)
{
    const Filling filling = filling_of(step);
    find_blocks(newton);
    make_room(newton);
    const size_t *members = newton->members;
    double *matrix = newton->matrix;
    size_t *pivots = newton->pivots;
    for (size_t i = 0; i < newton->block_count; i++) {
        RadauBlock *block = &newton->blocks[i];
        const size_t width = width_of(block);
        if (block->is_banded) {
            banded_shape_in(&block->banded, width, reach_of(block), matrix, pivots);
            fill(newton, members, &filling, &(Matrix){NULL, &block->banded, block->size});
            if (!banded_factor(&block->banded)) {
                return false;
            }
        } else {
            memset(matrix, 0, width * width * sizeof *matrix);
            fill(newton, members, &filling, &(Matrix){matrix, NULL, block->size});
            if (!dense_factor(width, matrix, pivots)) {
                return false;
            }
        }
        matrix += size_of(block);
        pivots += width;
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
        const size_t width = width_of(block);
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
        }
        matrix += size_of(block);
        pivots += width;
        for (size_t k = 0; k < width; k++) {
            change[k / m * n + members[k % m]] = own[k / m * by_stage + k % m * by_member];
        }
        members += m;
    }
}
