// Is the worst case that the corners give really the worst?
#include "close.h"

#include "mechanism.h"

#include "analytic/stackup.h"

#include <string.h>

// A fixed stream of numbers in [0, 1): Knuth's 64-bit linear congruential generator.
static double draw(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

static Stackup stackup_of(const Scenario *scenario)
{
    Stackup stackup;
    Err err = {ERR_NONE, ""};
    assert_true(stackup_compute(scenario, &stackup, &err));
    return stackup;
}

static double within(const ToleratedLength *length, double share)
{
    return length->nominal + length->lower + share * (length->upper - length->lower);
}

static void no_random_mechanism_within_tolerance_exceeds_the_worst_case(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const FourBar *fourbar = &scenario.fourbar;
    const Stackup stackup = stackup_of(&scenario);
    assert_true(stackup.has_sources);
    uint64_t seed = 1;
    for (int trial = 0; trial < 300; trial++) {
        const FourBarLengths lengths = {within(&fourbar->ground, draw(&seed)),
                                        within(&fourbar->crank, draw(&seed)),
                                        within(&fourbar->coupler, draw(&seed)),
                                        within(&fourbar->follower, draw(&seed)), ASSEMBLY_OPEN};
        for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
            const CurveExtreme extreme = fourbar_motion_extreme(
                &lengths, scenario.linkage.driver.speed, quantity, 0.0, 2.0 * M_PI);
            // rounding only
            const double slack = 1e-12 * fabs(stackup.rows[quantity].high.value);
            assert_true(extreme.high <= stackup.rows[quantity].high.value + slack);
            assert_true(extreme.low >= stackup.rows[quantity].low.value - slack);
        }
    }
}

static void the_worst_case_is_reached_by_the_combination_it_names(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    const Stackup stackup = stackup_of(&scenario);
    assert_near(stackup.play[0], 14.5e-6, 1e-18);
    for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
        const StackupBound *bound = &stackup.rows[quantity].high;
        const FourBarLengths lengths =
            stackup_lengths(&scenario.fourbar, stackup.play, &bound->combination);
        const CurveExtreme extreme = fourbar_motion_extreme(&lengths, scenario.linkage.driver.speed,
                                                            quantity, 0.0, 2.0 * M_PI);
        assert_near(extreme.high, bound->value, 1e-12 * fabs(bound->value));
    }
}

static void play_makes_the_worst_case_worse(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    const Stackup tight = stackup_of(&scenario);
    mechanism_loosen(&scenario, "crank-coupler");
    const Stackup one = stackup_of(&scenario);
    mechanism_loosen(&scenario, "follower-ground");
    const Stackup two = stackup_of(&scenario);
    for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
        assert_true(one.rows[quantity].high.value > tight.rows[quantity].high.value);
        assert_true(two.rows[quantity].high.value > one.rows[quantity].high.value);
        assert_true(two.rows[quantity].low.value < one.rows[quantity].low.value);
    }
}

// To first order each source acts by itself: alone, they add up to the whole.
static void shares_of_the_sources_add_up_to_first_order(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    const Stackup stackup = stackup_of(&scenario);
    for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
        const StackupRow *row = &stackup.rows[quantity];
        double sum = 0.0;
        for (int source = 0; source < STACKUP_SOURCES; source++) {
            sum += row->high.alone[source];
        }
        const double whole = row->high.value - row->nominal_high;
        // second order: tolerances are 3e-3 of the lengths
        assert_near(sum / whole, 1.0, 0.03);
    }
}

static void the_papers_stackup_lies_within_the_worst_case(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const Stackup stackup = stackup_of(&scenario);
    // the paper's stack-up: crank nominal, the others largest
    const StackupCombination paper = {.length_side = {1, 0, 1, 1}, .play_link = {-1, -1, -1}};
    const double no_play[STACKUP_PLAYS] = {0};
    const FourBarLengths lengths = stackup_lengths(&scenario.fourbar, no_play, &paper);
    assert_near(lengths.coupler, 0.2799, 1e-15);
    assert_near(lengths.crank, 0.108, 1e-15);
    const CurveExtreme omega = fourbar_motion_extreme(&lengths, scenario.linkage.driver.speed,
                                                      FOURBAR_COUPLER_OMEGA, 0.0, 2.0 * M_PI);
    assert_near(omega.low, -78.442, 0.00021 * 78.442);
    assert_true(omega.low > stackup.rows[FOURBAR_COUPLER_OMEGA].low.value);
}

static void without_tolerance_or_play_there_is_nothing_to_stack(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    ToleratedLength *const lengths[] = {&scenario.fourbar.ground, &scenario.fourbar.crank,
                                        &scenario.fourbar.coupler, &scenario.fourbar.follower};
    for (int i = 0; i < 4; i++) {
        lengths[i]->lower = 0.0;
        lengths[i]->upper = 0.0;
    }
    const Stackup stackup = stackup_of(&scenario);
    assert_false(stackup.has_sources);
    assert_near(stackup.rows[0].high.value, stackup.rows[0].nominal_high, 0.0);
}

static void tolerances_that_stop_the_crank_are_refused(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.fourbar.ground.upper = 0.3;
    Stackup stackup;
    Err err = {ERR_NONE, ""};
    assert_false(stackup_compute(&scenario, &stackup, &err));
    assert_non_null(strstr(err.text, "does not always turn fully"));
    const Scenario pin = mechanism_pin(1.0, 1e-4);
    err = (Err){ERR_NONE, ""};
    assert_false(stackup_compute(&pin, &stackup, &err));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_random_mechanism_within_tolerance_exceeds_the_worst_case),
        cmocka_unit_test(the_worst_case_is_reached_by_the_combination_it_names),
        cmocka_unit_test(play_makes_the_worst_case_worse),
        cmocka_unit_test(shares_of_the_sources_add_up_to_first_order),
        cmocka_unit_test(the_papers_stackup_lies_within_the_worst_case),
        cmocka_unit_test(without_tolerance_or_play_there_is_nothing_to_stack),
        cmocka_unit_test(tolerances_that_stop_the_crank_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
