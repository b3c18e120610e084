// Does the sparse factor solve what the dense solver solves, and stay as sparse as it should?
#include "base/sparse_rank.h"

#include "base/dense.h"
#include "base/lcg.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NODES = 14, ROWS_MOST = 4, SIDE = NODES * ROWS_MOST, LINKS = 40 };

// A random matrix, positive definite for its diagonal, sparse and dense.
typedef struct Random {
    Sparse sparse;
    size_t sizes[NODES];
    size_t link_count;
    SparseLink links[LINKS];
    double dense[SIDE * SIDE];
    double right[SIDE];
} Random;

static size_t draw_below(uint64_t *seed, size_t limit)
{
    return (size_t)((0.5 + 0.5 * lcg_draw(seed)) * (double)limit);
}

// Puts a number at two rows, within two nodes, into both.
static void put(Random *made, size_t a, size_t i, size_t b, size_t k, double value)
{
    const Sparse *sparse = &made->sparse;
    const size_t side = sparse->row_count;
    const size_t row = sparse->first_row[a] + i;
    const size_t column = sparse->first_row[b] + k;
    bool is_transposed;
    double *block = sparse_block(sparse, a, b, &is_transposed);
    assert_non_null(block);
    block[is_transposed ? k * made->sizes[a] + i : i * made->sizes[b] + k] = value;
    if (a == b) {
        block[k * made->sizes[a] + i] = value;
    }
    made->dense[row * side + column] = made->dense[column * side + row] = value;
}

static void make_random(uint64_t seed, size_t eliminated, Random *made)
{
    memset(made, 0, sizeof *made);
    for (size_t i = 0; i < NODES; i++) {
        made->sizes[i] = 1 + draw_below(&seed, ROWS_MOST);
    }
    const size_t wanted = draw_below(&seed, LINKS);
    while (made->link_count < wanted) {
        const SparseLink link = {draw_below(&seed, NODES), draw_below(&seed, NODES)};
        if (link.a != link.b) {
            made->links[made->link_count++] = link;
        }
    }
    sparse_init(NODES, made->sizes, eliminated, made->link_count, made->links, &made->sparse);
    for (size_t n = 0; n < made->link_count; n++) {
        const SparseLink link = made->links[n];
        for (size_t i = 0; i < made->sizes[link.a]; i++) {
            for (size_t k = 0; k < made->sizes[link.b]; k++) {
                put(made, link.a, i, link.b, k, lcg_draw(&seed));
            }
        }
    }
    for (size_t n = 0; n < NODES; n++) {
        for (size_t i = 0; i < made->sizes[n]; i++) {
            for (size_t k = 0; k <= i; k++) {
                put(made, n, i, n, k, i == k ? (double)SIDE : lcg_draw(&seed));
            }
        }
    }
    for (size_t i = 0; i < made->sparse.row_count; i++) {
        made->right[i] = lcg_draw(&seed);
    }
}

static void it_solves_what_the_dense_solver_solves(void **state)
{
    (void)state;
    for (unsigned number = 0; number < 200; number++) {
        Random *made = malloc(sizeof *made);
        assert_non_null(made);
        make_random(lcg_stirred(number), NODES, made);
        const size_t side = made->sparse.row_count;
        double solved[SIDE];
        memcpy(solved, made->right, sizeof solved);
        assert_true(sparse_factor(&made->sparse, 1e-12));
        sparse_solve(&made->sparse, solved);
        // control: another right side has another answer
        assert_true(dense_solve(side, made->dense, made->right));
        double largest = 0.0;
        for (size_t i = 0; i < side; i++) {
            assert_true(fabs(solved[i] - made->right[i]) <= 1e-15);
            largest = fmax(largest, fabs(solved[i]));
        }
        assert_true(largest > 1e-3);
        sparse_finish(&made->sparse);
        free(made);
    }
}

// The Schur complement S of the kept rows: S x = s with what is left of the right side there is
// what all of the unknowns satisfy.
static void what_is_kept_is_the_schur_complement(void **state)
{
    (void)state;
    for (unsigned number = 0; number < 200; number++) {
        Random *made = malloc(sizeof *made);
        assert_non_null(made);
        const size_t eliminated = number % NODES;
        make_random(lcg_stirred(1000 + number), eliminated, made);
        const Sparse *sparse = &made->sparse;
        const size_t side = sparse->row_count;
        const size_t first = sparse->first_row[eliminated];
        const size_t width = side - first;
        assert_true(sparse_factor(&made->sparse, 1e-12));
        double rows[SIDE];
        double schur[SIDE * SIDE] = {0.0};
        memcpy(rows, made->right, sizeof rows);
        sparse_forward(sparse, rows);
        for (size_t a = eliminated; a < NODES; a++) {
            for (size_t b = eliminated; b <= a; b++) {
                bool is_transposed;
                const double *block = sparse_block(sparse, a, b, &is_transposed);
                assert_false(is_transposed);
                for (size_t i = 0; block != NULL && i < made->sizes[a]; i++) {
                    for (size_t k = 0; k < (a == b ? i + 1 : made->sizes[b]); k++) {
                        const size_t row = sparse->first_row[a] - first + i;
                        const size_t column = sparse->first_row[b] - first + k;
                        schur[row * width + column] = block[i * made->sizes[b] + k];
                        schur[column * width + row] = block[i * made->sizes[b] + k];
                    }
                }
            }
        }
        assert_true(dense_solve(width, schur, rows + first));
        sparse_back(sparse, rows);
        assert_true(dense_solve(side, made->dense, made->right));
        for (size_t i = 0; i < side; i++) {
            assert_true(fabs(rows[i] - made->right[i]) <= 1e-15);
        }
        sparse_finish(&made->sparse);
        free(made);
    }
}

static void a_row_that_follows_from_others_is_noticed(void **state)
{
    (void)state;
    const size_t sizes[2] = {1, 2};
    const SparseLink link = {0, 1};
    Sparse sparse;
    sparse_init(2, sizes, 2, 1, &link, &sparse);
    // the last row is the first one twice; of the second matrix it is not
    for (int is_independent = 0; is_independent < 2; is_independent++) {
        bool is_transposed;
        sparse_clear(&sparse);
        *sparse_block(&sparse, 0, 0, &is_transposed) = 1.0;
        double *below = sparse_block(&sparse, 1, 0, &is_transposed);
        below[0] = 0.5;
        below[1] = 2.0;
        double *own = sparse_block(&sparse, 1, 1, &is_transposed);
        own[0] = 3.0;
        own[1] = own[2] = 1.0;
        own[3] = is_independent ? 5.0 : 4.0;
        assert_int_equal(sparse_factor(&sparse, 1e-12), is_independent);
    }
    sparse_finish(&sparse);
}

// Nodes in a row numbered at random, or in a ring, or as the leaves of a tree.
static size_t size_of(size_t count, int shape)
{
    SparseLink *links = calloc(count, sizeof *links);
    size_t *sizes = calloc(count, sizeof *sizes);
    size_t *names = calloc(count, sizeof *names);
    uint64_t seed = lcg_stirred(7);
    size_t link_count = 0;
    for (size_t i = 0; i < count; i++) {
        sizes[i] = 2;
        const size_t other = draw_below(&seed, i + 1);
        names[i] = names[other];
        names[other] = i;
    }
    for (size_t i = 1; i < count; i++) {
        const size_t to = shape == 2 ? draw_below(&seed, i) : i - 1;
        links[link_count++] = (SparseLink){names[i], names[to]};
    }
    if (shape == 1) {
        links[link_count++] = (SparseLink){names[count - 1], names[0]};
    }
    Sparse sparse;
    sparse_init(count, sizes, count, link_count, links, &sparse);
    const size_t size = sparse_size(&sparse);
    sparse_finish(&sparse);
    free(links);
    free(sizes);
    free(names);
    return size;
}

static void chains_and_trees_fill_nothing_in_and_rings_a_node_each(void **state)
{
    (void)state;
    const size_t block = 4;
    for (size_t count = 4; count <= 4096; count *= 4) {
        assert_int_equal(size_of(count, 0), block * (2 * count - 1));
        assert_int_equal(size_of(count, 2), block * (2 * count - 1));
        // a ring: its last three nodes are all linked, and every one before has two left
        assert_int_equal(size_of(count, 1), block * (3 * count - 3));
    }
}

// Unknowns in a row, each equation of two neighbours; some are made to depend on those before.
static void it_finds_the_rank_that_the_dense_solver_finds(void **state)
{
    (void)state;
    enum { CHAIN = 8, WIDE = 3 * CHAIN, EQUATIONS = 6 * CHAIN };
    size_t sizes[CHAIN];
    SparseLink links[CHAIN];
    for (size_t i = 0; i < CHAIN; i++) {
        sizes[i] = 3;
        links[i] = (SparseLink){i, (i + 1) % CHAIN};
    }
    size_t deficient = 0;
    for (unsigned number = 0; number < 100; number++) {
        uint64_t seed = lcg_stirred(number);
        Sparse sparse;
        double dense[EQUATIONS * WIDE] = {0.0};
        double squares[WIDE] = {0.0};
        double equation[WIDE] = {0.0};
        sparse_init(CHAIN, sizes, CHAIN, CHAIN, links, &sparse);
        const size_t twice = draw_below(&seed, CHAIN);
        const bool has_twin = draw_below(&seed, 2) == 1;
        const size_t count = 1 + draw_below(&seed, EQUATIONS);
        for (size_t e = 0; e < count; e++) {
            const size_t node = e % CHAIN;
            for (size_t k = 0; k < 6; k++) {
                equation[(3 * node + k) % WIDE] = lcg_draw(&seed);
            }
            if (has_twin) {
                // the second unknown of a node is the first one and the third
                equation[3 * twice + 1] = equation[3 * twice] + equation[3 * twice + 2];
            }
            for (size_t k = 0; k < WIDE; k++) {
                dense[e * WIDE + k] = equation[k];
                squares[k] += equation[k] * equation[k];
            }
            const size_t other = (node + 1) % CHAIN;
            const size_t first =
                sparse.order[node] < sparse.order[other] ? sparse.order[node] : sparse.order[other];
            sparse_rank_add(&sparse, first, equation);
            for (size_t k = 0; k < WIDE; k++) {
                equation[k] = 0.0; // what rounding leaves
            }
        }
        const size_t rank = sparse_rank_find(&sparse, squares, 1e-9, equation);
        assert_int_equal(rank, dense_rank(count, WIDE, dense, 1e-9));
        deficient += count > WIDE && rank < WIDE ? 1 : 0;
        sparse_finish(&sparse);
    }
    assert_true(deficient > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_solves_what_the_dense_solver_solves),
        cmocka_unit_test(what_is_kept_is_the_schur_complement),
        cmocka_unit_test(a_row_that_follows_from_others_is_noticed),
        cmocka_unit_test(it_finds_the_rank_that_the_dense_solver_finds),
        cmocka_unit_test(chains_and_trees_fill_nothing_in_and_rings_a_node_each),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
