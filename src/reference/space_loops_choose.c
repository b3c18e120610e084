// Which rows hold the joints that close loops in space, when many follow from others?
//
// They are chosen by Gram-Schmidt, the one that has most left over first. A choice stays until
// another would leave twice as much of its last row: the reactions of joints that hold each
// other up are not determined, and should not jump without need.
#include "reference/space_loops.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// What is left of a row, of itself, once everything that others hold is taken out
static const double INDEPENDENT = 1e-7;

// A choice stays while its worst row has this share left of what the fittest choice has
static const double FIT = 0.5;

// A matrix of the rows of loops, one behind the other, in units of length.
typedef struct Rows {
    size_t width;
    size_t count;
    SpaceLoopRow which[SPACE_JOINT_ROWS * SPACE_TREE_LOOP_MAX];
    double *values;
} Rows;

static double product(size_t n, const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Takes out of a row what a unit row has of it, twice for rounding.
static void take_out(size_t n, const double *unit, double *row)
{
    for (int pass = 0; pass < 2; pass++) {
        const double share = product(n, unit, row);
        for (size_t i = 0; i < n; i++) {
            row[i] -= share * unit[i];
        }
    }
}

// Fills in all rows of all loops, turns measured by the reach of the body that turns.
static void fill_rows(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoops *loops,
                      Rows *rows)
{
    SpaceLoops one = *loops;
    rows->width = tree->coordinate_count;
    rows->count = 0;
    double unit[SPACE_TREE_COORDINATE_MAX];
    double length = 0.0;
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        const double reach = linkage_reach(tree->linkage, node->body);
        const size_t own = node->joint < 0 ? 6 : 1;
        length = fmax(length, reach);
        for (size_t k = 0; k < own; k++) {
            unit[node->first + k] = own == 6 && k < 3 ? 1.0 : 1.0 / reach;
        }
    }
    for (size_t i = 0; i < tree->loop_count; i++) {
        for (int which = 0; which < SPACE_JOINT_ROWS; which++) {
            double *row = rows->values + rows->count * rows->width;
            one.rows[0] = (SpaceLoopRow){tree->loops[i], which};
            space_loops_row(tree, state, &one, 0, row);
            for (size_t k = 0; k < rows->width; k++) {
                row[k] *= unit[k] * (which < SPACE_POINT_ROWS ? 1.0 : length);
            }
            rows->which[rows->count++] = one.rows[0];
        }
    }
}

static bool is_among(const SpaceLoopRow *row, size_t count, const SpaceLoopRow *rows)
{
    for (size_t i = 0; i < count; i++) {
        if (rows[i].joint == row->joint && rows[i].which == row->which) {
            return true;
        }
    }
    return false;
}

// Chooses rows, of those listed where there is a list, the one with most left first. Returns their
// number, and of each how much was left.
static size_t choose(Rows *rows, size_t listed_count, const SpaceLoopRow *listed,
                     SpaceLoopRow *chosen, double *left)
{
    bool is_taken[SPACE_JOINT_ROWS * SPACE_TREE_LOOP_MAX] = {false};
    const size_t n = rows->width;
    size_t count = 0;
    while (count < n) {
        size_t best = rows->count;
        double most = INDEPENDENT * (count > 0 ? left[0] : 0.0);
        for (size_t i = 0; i < rows->count; i++) {
            const double *row = rows->values + i * n;
            const double size = sqrt(product(n, row, row));
            const bool may_be = listed == NULL || is_among(&rows->which[i], listed_count, listed);
            if (!is_taken[i] && may_be && size > most) {
                best = i;
                most = size;
            }
        }
        if (best == rows->count) {
            break;
        }
        is_taken[best] = true;
        double *unit = rows->values + best * n;
        for (size_t k = 0; k < n; k++) {
            unit[k] /= most;
        }
        for (size_t i = 0; i < rows->count; i++) {
            if (!is_taken[i]) {
                take_out(n, unit, rows->values + i * n);
            }
        }
        chosen[count] = rows->which[best];
        left[count++] = most;
    }
    return count;
}

void space_loops_choose(const SpaceTree *tree, const SpaceTreeState *state, bool is_first,
                        SpaceLoops *loops)
{
    const SpaceLoops before = *loops;
    for (size_t i = 0; i < tree->loop_count; i++) {
        const int joint = tree->loops[i];
        const Vec3 axis = tree->base_axes[2 * joint];
        loops->base_sides[joint][0] = vec3_normal_to(axis);
        loops->base_sides[joint][1] = vec3_cross(axis, loops->base_sides[joint][0]);
    }
    if (tree->loop_count == 0) {
        return;
    }
    Rows rows;
    double left[SPACE_LOOPS_ROW_MAX];
    const size_t most = SPACE_JOINT_ROWS * tree->loop_count;
    rows.values = malloc(most * tree->coordinate_count * sizeof *rows.values);
    assert(rows.values != NULL);
    fill_rows(tree, state, loops, &rows);
    loops->row_count = choose(&rows, 0, NULL, loops->rows, left);
    if (!is_first) {
        const double fittest = loops->row_count > 0 ? left[loops->row_count - 1] : 0.0;
        fill_rows(tree, state, loops, &rows);
        SpaceLoopRow kept[SPACE_LOOPS_ROW_MAX];
        const size_t count = choose(&rows, before.row_count, before.rows, kept, left);
        const bool is_fit = count == before.row_count && left[count - 1] > FIT * fittest;
        // at a dead point fewer are independent, for an instant
        if (is_fit || loops->row_count < before.row_count) {
            loops->row_count = before.row_count;
            memcpy(loops->rows, before.rows, sizeof loops->rows);
        }
    }
    free(rows.values);
}
