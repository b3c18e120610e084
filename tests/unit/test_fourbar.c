// Which class is a four-bar, where are its dead centres, and does the closed form give the values
// that stand in print?
#include "close.h"

#include "mechanism.h"

#include "analytic/fourbar_motion.h"

static const double DEGREE = M_PI / 180.0;

static FourBar of_lengths(double ground, double crank, double coupler, double follower)
{
    return (FourBar){
        {ground, 0, 0}, {crank, 0, 0}, {coupler, 0, 0}, {follower, 0, 0}, ASSEMBLY_OPEN};
}

static void grashofs_rule_names_every_class(void **state)
{
    (void)state;
    const struct {
        FourBar fourbar;
        GrashofClass expected;
        bool turns;
    } rows[] = {
        {of_lengths(0.254, 0.108, 0.2794, 0.2705), GRASHOF_CRANK_ROCKER, true},
        {of_lengths(1.0, 2.0, 2.5, 2.2), GRASHOF_DOUBLE_CRANK, true},
        {of_lengths(2.5, 2.0, 1.0, 2.2), GRASHOF_DOUBLE_ROCKER, false},
        {of_lengths(2.5, 2.0, 2.2, 1.0), GRASHOF_ROCKER_CRANK, false},
        {of_lengths(4.0, 2.0, 2.0, 2.5), GRASHOF_TRIPLE_ROCKER, false},
        {of_lengths(2.0, 1.0, 2.0, 1.0), GRASHOF_CHANGE_POINT, false},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(fourbar_grashof(&rows[i].fourbar), rows[i].expected);
        assert_int_equal(fourbar_crank_turns(&rows[i].fourbar), rows[i].turns);
    }
    assert_string_equal(FOURBAR_GRASHOF_NAMES[GRASHOF_CRANK_ROCKER], "crank-rocker");
    assert_string_equal(FOURBAR_GRASHOF_NAMES[GRASHOF_CHANGE_POINT], "change-point");
}

static void the_loop_closes_where_the_diagonal_lies_between_difference_and_sum(void **state)
{
    (void)state;
    const FourBar fourbar = of_lengths(2.5, 2.0, 2.2, 1.0);
    const FourBarLengths lengths = fourbar_motion_nominal(&fourbar);
    double shortest;
    double longest;
    fourbar_diagonal_range(&fourbar, &shortest, &longest);
    assert_near(shortest, 1.2, 1e-15);
    assert_near(longest, 3.2, 1e-15);
    for (int degree = 0; degree < 360; degree++) {
        const double diagonal = fourbar_diagonal(&fourbar, degree * DEGREE);
        const bool can_close = diagonal > shortest && diagonal < longest;
        Motion motions[3];
        assert_int_equal(fourbar_motion_bodies(&lengths, 1.0, degree * DEGREE, motions), can_close);
    }
}

// Continuous extremes of the paper's mechanism; its tables print the same curve on a 1 deg grid.
static void extremes_of_the_papers_mechanism_are_those_in_print(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    const struct {
        FourBarQuantity quantity;
        double low;
        double high;
        double tolerance; // half of the last digit given
    } rows[] = {
        {FOURBAR_COUPLER_OMEGA, -78.6973, 42.2008, 5e-5},
        {FOURBAR_FOLLOWER_OMEGA, -80.5551, 43.8186, 5e-5},
        {FOURBAR_COUPLER_ALPHA, -11970.4, 7574.6, 5e-2},
        {FOURBAR_FOLLOWER_ALPHA, -7512.3, 12485.5, 5e-2},
        {FOURBAR_TRANSMISSION, 30.74 * DEGREE, 82.32 * DEGREE, 5e-3 * DEGREE},
        {FOURBAR_FOLLOWER_ANGLE, 84.83 * DEGREE, 142.02 * DEGREE, 5e-3 * DEGREE},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const CurveExtreme extreme = fourbar_motion_extreme(&lengths, scenario.linkage.driver.speed,
                                                            rows[i].quantity, 0.0, 2.0 * M_PI);
        assert_near(extreme.low, rows[i].low, rows[i].tolerance);
        assert_near(extreme.high, rows[i].high, rows[i].tolerance);
    }
}

// Rates from differences of the angles know nothing of the formulas for the rates.
static void rates_are_the_derivatives_of_the_angles_in_both_assemblies(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    for (int assembly = 0; assembly < 2; assembly++) {
        scenario.fourbar.assembly = assembly == 0 ? ASSEMBLY_OPEN : ASSEMBLY_CROSSED;
        const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
        for (int degree = 0; degree < 360; degree += 7) {
            const double h = 1e-4;
            const double cranks[3] = {degree * DEGREE - h, degree * DEGREE, degree * DEGREE + h};
            double angle[3];
            double omega[3];
            double alpha[3];
            const FourBarGrid grid = {
                .follower_angle = angle, .follower_omega = omega, .follower_alpha = alpha};
            fourbar_motion_grid(&lengths, 1.0, 3, cranks, &grid);
            const double rate = remainder(angle[2] - angle[0], 2.0 * M_PI) / (2.0 * h);
            // central differences: h^2 / 6 of the third derivative, which is below 10
            assert_near(rate, omega[1], 2e-8);
            assert_near((omega[2] - omega[0]) / (2.0 * h), alpha[1], 2e-7);
        }
    }
}

static void the_two_assemblies_mirror_each_other_about_the_diagonal(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    Motion open[3];
    Motion crossed[3];
    FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    assert_true(fourbar_motion_bodies(&lengths, 1.0, 0.0, open));
    lengths.assembly = ASSEMBLY_CROSSED;
    assert_true(fourbar_motion_bodies(&lengths, 1.0, 0.0, crossed));
    // at crank angle zero the diagonal is the x axis
    assert_near(open[1].position.x, crossed[1].position.x, 1e-15);
    assert_near(open[1].position.y, -crossed[1].position.y, 1e-15);
    assert_true(open[1].position.y > 0.0);
}

static void a_crank_that_turns_the_other_way_keeps_its_accelerations(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    Motion there[3];
    Motion back[3];
    assert_true(fourbar_motion_bodies(&lengths, 100.0, 1.0, there));
    assert_true(fourbar_motion_bodies(&lengths, -100.0, 1.0, back));
    assert_near(there[2].omega, -back[2].omega, 1e-12);
    assert_near(there[2].alpha, back[2].alpha, 1e-9);
}

static void an_extreme_at_the_end_of_the_interval_is_found(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    const CurveExtreme part =
        fourbar_motion_extreme(&lengths, 1.0, FOURBAR_COUPLER_OMEGA, 1.0, 0.9);
    const double ends[2] = {
        fourbar_motion_quantity(&lengths, 1.0, FOURBAR_COUPLER_OMEGA, 0.9),
        fourbar_motion_quantity(&lengths, 1.0, FOURBAR_COUPLER_OMEGA, 1.0),
    };
    assert_near(part.low, fmin(ends[0], ends[1]), 1e-15);
    assert_near(part.high, fmax(ends[0], ends[1]), 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grashofs_rule_names_every_class),
        cmocka_unit_test(the_loop_closes_where_the_diagonal_lies_between_difference_and_sum),
        cmocka_unit_test(extremes_of_the_papers_mechanism_are_those_in_print),
        cmocka_unit_test(rates_are_the_derivatives_of_the_angles_in_both_assemblies),
        cmocka_unit_test(the_two_assemblies_mirror_each_other_about_the_diagonal),
        cmocka_unit_test(a_crank_that_turns_the_other_way_keeps_its_accelerations),
        cmocka_unit_test(an_extreme_at_the_end_of_the_interval_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
