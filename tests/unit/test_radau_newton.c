// Are the equations of an implicit step solved, be their blocks dense or banded?
#include "close.h"

#include "base/lcg.h"
#include "reference/radau_newton.h"

#include <stdlib.h>

enum { CHAIN = 30, PAIR = 2, COUNT = CHAIN + PAIR, UNKNOWNS = RADAU_STAGES * COUNT };

static const double STEP = 0.3; // s

// A chain of coordinates that feel their neighbours, listed in no order, and a pair beside it.
static void couple(RadauNewton *newton, uint64_t *seed)
{
    for (size_t a = 0; a < COUNT; a++) {
        for (size_t b = 0; b < COUNT; b++) {
            // 7 and 30 have no common divisor: neighbours are all over the list
            const size_t places[2] = {a * 7 % CHAIN, b * 7 % CHAIN};
            const bool are_near = places[0] <= places[1] + 1 && places[1] <= places[0] + 1;
            const bool are_coupled = (a < CHAIN && b < CHAIN) ? are_near : a >= CHAIN && b >= CHAIN;
            for (size_t k = 0; are_coupled && k < RADAU_STAGES; k++) {
                newton->by_position[k][a * COUNT + b] = lcg_draw(seed);
                newton->by_rate[k][a * COUNT + b] = lcg_draw(seed);
            }
        }
    }
}

// How far from a right side the equations take a solution: (1 - h a D - h^2 a S a) x.
static double residual(const RadauNewton *newton, const double *x, const double *right)
{
    double worst = 0.0;
    for (size_t i = 0; i < RADAU_STAGES; i++) {
        for (size_t a = 0; a < COUNT; a++) {
            double sum = x[i * COUNT + a];
            for (size_t k = 0; k < RADAU_STAGES; k++) {
                double pushed = 0.0;
                for (size_t b = 0; b < COUNT; b++) {
                    double moved = 0.0;
                    for (size_t j = 0; j < RADAU_STAGES; j++) {
                        moved += RADAU_COUPLING[k][j] * x[j * COUNT + b];
                    }
                    pushed += newton->by_rate[k][a * COUNT + b] * x[k * COUNT + b] +
                              STEP * newton->by_position[k][a * COUNT + b] * moved;
                }
                sum -= STEP * RADAU_COUPLING[i][k] * pushed;
            }
            worst = fmax(worst, fabs(sum - right[i * COUNT + a]));
        }
    }
    return worst;
}

static void blocks_are_solved_dense_or_banded(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(5);
    RadauNewton newton;
    radau_newton_init(&newton, COUNT);
    couple(&newton, &seed);
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
    newton.by_rate[3][(CHAIN - 1) * COUNT + CHAIN - 1] += 0.1;
    assert_true(residual(&newton, x, right) > 1e-5);
    radau_newton_finish(&newton);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_solved_dense_or_banded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
