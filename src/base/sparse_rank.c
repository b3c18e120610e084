// Counts the unknowns of a sparse system that are independent.
//
// A = Q R by Givens rotations, equation by equation: each is rotated into the rows of R that begin
// where it does, until nothing is left of it. R' has the pattern of Cholesky's factor of A' A, but
// none of its squares: what is left of a column is right to rounding. A column that depends on
// those before it leaves a zero on R's diagonal; the rest of that row is then rotated into the rows
// below.
//
// Source: A. George and M. T. Heath, Linear Algebra Appl. 34 (1980) 69.
#include "base/sparse_rank.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

// of an equation's size: what rotations leave of a coefficient that is zero
static const double RANK_ROUNDED = 1e-13;

// Runs down the entries of one row of R beside the diagonal: the rest of the node's own block, then
// the blocks below. Rotates them with an equation's by a cosine and a sine.
static void rotate_beside(Sparse *sparse, size_t p, size_t k, double cosine, double sine,
                          double *equation)
{
    const size_t own_node = sparse->node_at[p];
    const size_t n = sparse->first_row[own_node + 1] - sparse->first_row[own_node];
    for (size_t b = sparse->first_block[p]; b < sparse->first_block[p + 1]; b++) {
        const size_t node = sparse->node_at[sparse->block_node[b]];
        const size_t count = sparse->first_row[node + 1] - sparse->first_row[node];
        double *block = sparse->values + sparse->block_value[b];
        double *x = equation + sparse->first_row[node];
        for (size_t i = node == own_node ? k + 1 : 0; i < count; i++) {
            const double kept = block[i * n + k];
            block[i * n + k] = cosine * kept + sine * x[i];
            x[i] = cosine * x[i] - sine * kept;
        }
    }
}

// Rotates an equation into the row of R of one unknown. Returns whether the row was empty: nothing
// is left of the equation then.
static bool rotate_row(Sparse *sparse, size_t p, size_t k, double *equation)
{
    const size_t node = sparse->node_at[p];
    const size_t n = sparse->first_row[node + 1] - sparse->first_row[node];
    double *diagonal = sparse->values + sparse->block_value[sparse->first_block[p]] + k * n + k;
    double *x = equation + sparse->first_row[node] + k;
    if (*x == 0.0) {
        return false;
    }
    const double size = hypot(*diagonal, *x);
    const bool was_empty = *diagonal == 0.0;
    const double cosine = *diagonal / size;
    const double sine = *x / size;
    *diagonal = size;
    *x = 0.0;
    rotate_beside(sparse, p, k, cosine, sine, equation);
    return was_empty;
}

// Rotates an equation into the rows of R from an unknown on.
static void rotate_down(Sparse *sparse, size_t p, size_t k, double *equation)
{
    while (p < sparse->count) {
        const size_t node = sparse->node_at[p];
        const size_t n = sparse->first_row[node + 1] - sparse->first_row[node];
        for (; k < n; k++) {
            if (rotate_row(sparse, p, k, equation)) {
                return;
            }
        }
        // what is left begins in the next node of the column at the earliest
        const bool has_next = sparse->first_block[p] + 1 < sparse->first_block[p + 1];
        p = has_next ? sparse->block_node[sparse->first_block[p] + 1] : sparse->count;
        k = 0;
    }
}

// Where an equation comes to an empty row of R, or how it goes on.
typedef struct Rest {
    bool is_at_end; // nothing is left of it
    size_t p;       // the node's order and the row of it that is empty
    size_t k;
} Rest;

// Takes one row of R out of an equation, as a rotation would, and leaves the row as it is.
static void take_row_out(const Sparse *sparse, size_t p, size_t k, double *equation)
{
    const size_t own_node = sparse->node_at[p];
    const size_t n = sparse->first_row[own_node + 1] - sparse->first_row[own_node];
    const double diagonal = sparse->values[sparse->block_value[sparse->first_block[p]] + k * n + k];
    double *own = equation + sparse->first_row[own_node] + k;
    const double size = hypot(diagonal, *own);
    const double cosine = diagonal / size;
    const double sine = *own / size;
    *own = 0.0;
    for (size_t b = sparse->first_block[p]; b < sparse->first_block[p + 1]; b++) {
        const size_t node = sparse->node_at[sparse->block_node[b]];
        const size_t count = sparse->first_row[node + 1] - sparse->first_row[node];
        const double *block = sparse->values + sparse->block_value[b];
        double *x = equation + sparse->first_row[node];
        for (size_t i = node == own_node ? k + 1 : 0; i < count; i++) {
            x[i] = cosine * x[i] - sine * block[i * n + k];
        }
    }
}

// Takes an equation through the rows of R up to the first empty one in which it is not zero but for
// rounding. Rotates the rows where they may change.
static Rest take_through(Sparse *changed, const Sparse *sparse, size_t p, double size,
                         double *equation)
{
    while (p < sparse->count) {
        const size_t node = sparse->node_at[p];
        const size_t n = sparse->first_row[node + 1] - sparse->first_row[node];
        const double *own = sparse->values + sparse->block_value[sparse->first_block[p]];
        for (size_t k = 0; k < n; k++) {
            double *x = equation + sparse->first_row[node] + k;
            if (!(fabs(*x) > RANK_ROUNDED * size)) {
                *x = 0.0;
            } else if (own[k * n + k] == 0.0) {
                return (Rest){false, p, k};
            } else if (changed != NULL) {
                rotate_row(changed, p, k, equation);
            } else {
                take_row_out(sparse, p, k, equation);
            }
        }
        const bool has_next = sparse->first_block[p] + 1 < sparse->first_block[p + 1];
        p = has_next ? sparse->block_node[sparse->first_block[p] + 1] : sparse->count;
    }
    return (Rest){.is_at_end = true};
}

// How much is left of an equation from an empty row on; zeroes it, if asked for.
static double rest_of(const Sparse *sparse, const Rest *rest, bool is_zeroed, double *equation)
{
    double sum = 0.0;
    for (size_t b = sparse->first_block[rest->p]; b < sparse->first_block[rest->p + 1]; b++) {
        const size_t node = sparse->node_at[sparse->block_node[b]];
        for (size_t i = sparse->first_row[node]; i < sparse->first_row[node + 1]; i++) {
            sum += equation[i] * equation[i];
            equation[i] = is_zeroed ? 0.0 : equation[i];
        }
    }
    return sqrt(sum);
}

bool sparse_rank_take(Sparse *sparse, size_t first, double size, double share, double *coefficients)
{
    const Rest rest = take_through(sparse, sparse, first, size, coefficients);
    if (rest.is_at_end) {
        return false;
    }
    if (!(rest_of(sparse, &rest, false, coefficients) > share * size)) {
        rest_of(sparse, &rest, true, coefficients);
        return false;
    }
    rotate_row(sparse, rest.p, rest.k, coefficients);
    return true;
}

double sparse_rank_left(const Sparse *sparse, size_t first, double size, double *coefficients)
{
    const Rest rest = take_through(NULL, sparse, first, size, coefficients);
    return rest.is_at_end ? 0.0 : rest_of(sparse, &rest, true, coefficients) / size;
}

void sparse_rank_add(Sparse *sparse, size_t first, double *coefficients)
{
    rotate_down(sparse, first, 0, coefficients);
}

// Takes the row of an unknown that depends on others out of R, and rotates the rest of it into the
// rows below.
static void move_row(Sparse *sparse, size_t p, size_t k, double *room)
{
    const size_t own_node = sparse->node_at[p];
    const size_t n = sparse->first_row[own_node + 1] - sparse->first_row[own_node];
    sparse->values[sparse->block_value[sparse->first_block[p]] + k * n + k] = 0.0;
    // a quarter turn exchanges the row with nothing
    rotate_beside(sparse, p, k, 0.0, -1.0, room);
    rotate_down(sparse, p, k + 1, room);
}

size_t sparse_rank_find(Sparse *sparse, const double *squares, double share, double *room)
{
    size_t rank = 0;
    for (size_t p = 0; p < sparse->count; p++) {
        const size_t node = sparse->node_at[p];
        const size_t n = sparse->first_row[node + 1] - sparse->first_row[node];
        for (size_t k = 0; k < n; k++) {
            const double *own = sparse->values + sparse->block_value[sparse->first_block[p]];
            if (own[k * n + k] > share * sqrt(squares[sparse->first_row[node] + k])) {
                rank++;
            } else {
                move_row(sparse, p, k, room);
            }
        }
    }
    return rank;
}
