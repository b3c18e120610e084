// Are the equations of an implicit step solved, be their blocks dense or banded?
#include "close.h"

#include "base/lcg.h"
#include "reference/integrators.h"

#include <stdlib.h>

enum { CHAIN = 30, PAIR = 2, VARIABLES = CHAIN + PAIR, UNKNOWNS = RADAU_STAGES * VARIABLES };

static const double STEP = 0.3; // s

// Bodies of one coordinate each: a chain listed in no order, and a pair beside it. A joint between
// the two couples them as well, but for the moment nothing presses there.
static Coupling *make_coupling(void)
{
    Linkage linkage = linkage_create((LinkageRoom){.bodies = VARIABLES, .joints = VARIABLES});
    CouplingBody bodies[VARIABLES];
    linkage.body_count = linkage.joint_count = VARIABLES;
    for (size_t i = 0; i < VARIABLES; i++) {
        // 7 and 30 have no common divisor: neighbours are all over the list
        const bool is_within = i + 1 < CHAIN;
        linkage.joints[i].body_a = (int)(is_within ? i * 7 % CHAIN : CHAIN);
        linkage.joints[i].body_b = (int)(is_within ? (i + 1) * 7 % CHAIN : CHAIN + 1);
        bodies[i] = (CouplingBody){(int)i, i, i, 1};
    }
    linkage.joints[VARIABLES - 1].body_a = 0;
    Coupling *coupling = coupling_create(&linkage, VARIABLES, VARIABLES, bodies);
    linkage_free(&linkage);
    return coupling;
}

static void fill(RadauNewton *newton, uint64_t *seed)
{
    const Coupling *coupling = newton->coupling;
    for (size_t a = 0; a < VARIABLES; a++) {
        const size_t *columns = coupling_columns(coupling, coupling->part_of[a]);
        for (size_t i = 0; i < coupling_width(coupling, coupling->part_of[a]); i++) {
            const bool is_own = (a < CHAIN) == (columns[i] < CHAIN);
            for (size_t k = 0; is_own && k < RADAU_STAGES; k++) {
                newton->by_position[k][coupling->first_value[a] + i] = lcg_draw(seed);
                newton->by_rate[k][coupling->first_value[a] + i] = lcg_draw(seed);
            }
        }
    }
}

// How far from a right side the equations take a solution: (1 - h a D - h^2 a S a) x.
static double residual(const RadauNewton *newton, const double *x, const double *right)
{
    double worst = 0.0;
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        for (size_t a = 0; a < VARIABLES; a++) {
            double sum = x[i * VARIABLES + a];
            for (size_t k = 0; k < RADAU_STAGES; k++) {
                double pushed = 0.0;
                for (size_t b = 0; b < VARIABLES; b++) {
                    double moved = 0.0;
                    for (size_t j = 0; j < RADAU_STAGES; j++) {
                        moved += RADAU_COUPLING[k][j] * x[j * VARIABLES + b];
                    }
                    const Coupling *coupling = newton->coupling;
                    pushed +=
                        coupling_entry(coupling, newton->by_rate[k], a, b) * x[k * VARIABLES + b] +
                        STEP * coupling_entry(coupling, newton->by_position[k], a, b) * moved;
                }
                sum -= STEP * RADAU_COUPLING[i][k] * pushed;
            }
            worst = fmax(worst, fabs(sum - right[i * VARIABLES + a]));
        }
    }
    return worst;
}

static void blocks_are_solved_dense_or_banded(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(5);
    RadauNewton newton;
    Coupling *coupling = make_coupling();
    radau_newton_init(&newton, coupling);
    fill(&newton, &seed);
    double right[UNKNOWNS];
    double x[UNKNOWNS];
    for (size_t i = 0; i < UNKNOWNS; i++) {
        right[i] = x[i] = lcg_draw(&seed);
    }
    assert_true(radau_newton_factor(&newton, STEP));
    assert_int_equal(newton.block_count, 2);
    assert_int_equal(newton.blocks[0].size, CHAIN);
    assert_true(newton.blocks[0].is_banded && newton.blocks[0].reach <= 2);
    assert_true(!newton.blocks[1].is_banded);
    radau_newton_solve(&newton, x);
    assert_near(residual(&newton, x, right), 0.0, 1e-11);
    // control: another derivative, far from where the chain was begun
    newton.by_rate[3][coupling->first_value[CHAIN - 1] +
                      coupling_column_index(coupling, coupling->part_of[CHAIN - 1], CHAIN - 1)] +=
        0.1;
    assert_true(residual(&newton, x, right) > 1e-5);
    // where they press on one another all are one block
    newton
        .by_rate[0][coupling->first_value[0] + coupling_column_index(coupling, 0, VARIABLES - 1)] =
        0.1;
    assert_true(radau_newton_factor(&newton, STEP));
    assert_int_equal(newton.block_count, 1);
    radau_newton_finish(&newton);
    coupling_destroy(coupling);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_solved_dense_or_banded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
