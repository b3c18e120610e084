// Do period and growth of a settled motion come out as they are known?
//
// A ball bounces once a revolution on a plate that an eccentric moves as A sin(w t). With
// restitution e it lands on the plate where that moves up with u = V (1 - e) / (1 + e), V = g T /
// 2, and is accelerated by a = -w u tan(phase). From one bounce to the next changes of the time and
// the speed after it go over by the matrix
//     [1, (1 + e) / g;  (1 + e) a, (1 + e)^2 a / g + e^2]
// of determinant e^2 (the flight and the bounce by their differentials; see also J. Guckenheimer,
// P. Holmes, Nonlinear oscillations, 1983, 2.4). So its growth a revolution is e while its
// eigenvalues are complex, the larger of them while they are real, and beyond
// -a = 2 g (1 + e^2) / (1 + e)^2 the motion doubles its period. Bounces take no time there; here
// they take some 0.1 ms of 100 ms, and the growth is that to 2 %.
//
// A case that begins in flight has both multipliers, whose product and sum are those of the matrix.
// One that begins as the ball leaves the plate has a contact that begins or ends beside the
// section: its growth is found from many revolutions.
#include "load_case.h"

#include "measure/section.h"
#include "run/registry.h"
#include "run/run.h"
#include "run/settle.h"

#include <stdio.h>

static const double GRAVITY = 9.80665;
static const double TURN_S = 0.1;

// A plate that gives the ball the acceleration -share g where it lands, and restitution e. The case
// begins as the ball leaves the plate, or half a turn later, in the middle of its flight.
static Scenario ball_from(double e, double share, bool is_in_flight)
{
    const double w = 2.0 * M_PI / TURN_S;
    const double launch = 0.5 * GRAVITY * TURN_S;
    const double upwards = launch * (1.0 - e) / (1.0 + e);
    const double inwards = share * GRAVITY / w;
    const double size_mm = 1e3 * hypot(upwards, inwards) / w;
    const double phase = atan2(inwards, upwards);
    const double flight_mm = is_in_flight ? 1e3 * launch * launch / (2.0 * GRAVITY) : 0.0;
    const double height_mm = 10.0 + size_mm * sin(phase) + flight_mm;
    const double side = is_in_flight ? -1.0 : 1.0;
    char text[2048];
    const int length = snprintf(
        text, sizeof text,
        "bodies:\n"
        "  eccentric: {mass: 1 kg, inertia: 1000 kg mm^2, at: [0 mm, 0 mm]}\n"
        "  ball: {mass: 0.1 kg, inertia: 10 kg mm^2, at: [0 mm, %.9f mm], velocity: [0 m/s, %.9f "
        "m/s], spin: 0 rad/s}\n"
        "joints:\n"
        "  pivot: {between: [ground, eccentric], at: [0 mm, 0 mm]}\n"
        "  guide: {between: [ground, ball], at: [0 mm, %.9f mm], along: 90 deg}\n"
        "  plate: {between: [ball, eccentric], at-a: [0 mm, %.9f mm], at-b: [%.9f mm, %.9f mm],\n"
        "          normal: -90 deg, radius: 10 mm}\n"
        "drive: {joint: pivot, speed: %.9f rad/s}\n"
        "contact: {stiffness: 1e8 N/m, damping: exact, restitution: %.3f}\n"
        "run: {revolutions: 8, samples: 100, start: settled, settle-starts: 1}\n",
        height_mm, is_in_flight ? 0.0 : launch, height_mm, height_mm, side * size_mm * cos(phase),
        side * size_mm * sin(phase), w, e);
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("ball.yaml", text, (size_t)length, NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    settle_scenario(&scenario, (RunWatch){.progress = NULL});
    if (scenario.settled.motion_count == 0) {
        fail_msg("%s", scenario.settled.message);
    }
    return scenario;
}

static Scenario ball(double e, double share)
{
    return ball_from(e, share, false);
}

static double growth_of(double e, double share)
{
    Scenario scenario = ball(e, share);
    assert_int_equal(scenario.settled.motions[0].period, 1);
    settle_growth(&scenario, (RunWatch){.progress = NULL});
    assert_false(scenario.settled.growth.is_at_most);
    const double growth = scenario.settled.growth.factor;
    scenario_free(&scenario);
    return growth;
}

static void growth_is_the_restitution_where_it_turns(void **state)
{
    (void)state;
    assert_close(growth_of(0.5, 0.5), 0.5, 0.02);
    // the control: another restitution
    assert_close(growth_of(0.7, 0.5), 0.7, 0.02);
}

static void growth_is_the_larger_eigenvalue(void **state)
{
    (void)state;
    const double trace = 1.0 + 0.25 - 2.25 * 1.05;
    const double larger = 0.5 * fabs(trace - sqrt(trace * trace - 4.0 * 0.25));
    assert_close(growth_of(0.5, 1.05), larger, 0.02);
}

// The product of both multipliers over e^2, and their sum less that of the matrix.
static void find_multipliers(double e, double share, double told, double told_share,
                             double *product, double *sum)
{
    Scenario scenario = ball_from(e, share, true);
    settle_growth(&scenario, (RunWatch){.progress = NULL});
    const SettledGrowth *growth = &scenario.settled.growth;
    assert_int_equal(growth->multiplier_count, 2);
    const double(*of)[2] = growth->multipliers;
    *product = (of[0][0] * of[1][0] - of[0][1] * of[1][1]) / (told * told);
    *sum = of[0][0] + of[1][0] - (1.0 + told * told - (1.0 + told) * (1.0 + told) * told_share);
    assert_close(growth->factor, hypot(of[0][0], of[0][1]), 0.02);
    assert_string_equal(scenario.linkage.bodies[growth->body].name, "ball");
    scenario_free(&scenario);
}

static void all_multipliers_are_those_of_the_matrix(void **state)
{
    (void)state;
    // complex ones, and real ones
    const double restitutions[] = {0.5, 0.7, 0.5};
    const double shares[] = {0.5, 0.8, 1.05};
    for (size_t i = 0; i < 3; i++) {
        double product;
        double sum;
        const double e = restitutions[i];
        find_multipliers(e, shares[i], e, shares[i], &product, &sum);
        assert_close(product, 1.0, 0.02);
        assert_true(fabs(sum) < 0.02);
        // the control: the matrix of another restitution and plate
        find_multipliers(e, shares[i], e + 0.05, shares[i] + 0.1, &product, &sum);
        assert_true(fabs(product - 1.0) > 0.1);
        assert_true(fabs(sum) > 0.02);
    }
}

// A pair of gears in contact all the time is linear, with a damper alone: the product of its
// multipliers is exp(-c T / J) (J. Liouville, J. Math. Pures Appl. 3 (1838) 342). At 80 rad/s its
// drive stands still where the period begins.
static double product_over_liouville(const char *path, double period_s, const char *damping,
                                     double told)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load(path, &damping, 1, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    settle_scenario(&scenario, (RunWatch){.progress = NULL});
    settle_growth(&scenario, (RunWatch){.progress = NULL});
    const SettledGrowth *growth = &scenario.settled.growth;
    assert_int_equal(growth->multiplier_count, 2);
    const double product = growth->multipliers[0][0] * growth->multipliers[1][0] -
                           growth->multipliers[0][1] * growth->multipliers[1][1];
    scenario_free(&scenario);
    return product / exp(-told / 0.01 * period_s);
}

static void multipliers_of_gears_have_the_product_of_their_damper(void **state)
{
    (void)state;
    static const char OIL[] = "torsion-springs.oil.damping=0.1 N m s/rad";
    static const char MORE[] = "torsion-springs.oil.damping=0.12 N m s/rad";
    static const char *const PATHS[] = {"tests/settled/gears-80.yaml",
                                        "tests/settled/gears-100.yaml"};
    const double periods_s[] = {M_PI / 40.0, M_PI / 50.0};
    for (size_t i = 0; i < 2; i++) {
        assert_close(product_over_liouville(PATHS[i], periods_s[i], OIL, 0.1), 1.0, 1e-4);
        assert_close(product_over_liouville(PATHS[i], periods_s[i], MORE, 0.12), 1.0, 1e-4);
    }
    // the control: other damping
    assert_true(fabs(product_over_liouville(PATHS[0], periods_s[0], MORE, 0.1) - 1.0) > 0.1);
}

// What an impact all but takes is gone where the ball then stays on the plate until that falls away
// from it, always at the same angle.
static void a_change_that_is_gone_has_a_bound(void **state)
{
    (void)state;
    Scenario scenario = ball(0.002, 0.05);
    settle_growth(&scenario, (RunWatch){.progress = NULL});
    assert_true(scenario.settled.growth.is_at_most);
    assert_true(scenario.settled.growth.factor < 0.02);
    scenario_free(&scenario);
}

// Beyond its cascade of periods the motion does not repeat, and small changes grow.
static void changes_grow_where_nothing_repeats(void **state)
{
    (void)state;
    Scenario scenario = ball(0.8, 4.0);
    assert_int_equal(scenario.settled.motions[0].period, 0);
    settle_growth(&scenario, (RunWatch){.progress = NULL});
    assert_true(scenario.settled.growth.factor > 1.05);
    assert_true(scenario.settled.growth.revolutions > 2);
    scenario_free(&scenario);
}

static void the_period_doubles_where_it_must(void **state)
{
    (void)state;
    // 2 (1 + e^2) / (1 + e)^2 = 1.111
    const double shares[] = {1.05, 1.2};
    for (size_t i = 0; i < 2; i++) {
        Scenario scenario = ball(0.5, shares[i]);
        assert_int_equal(scenario.settled.motions[0].period, 1 + i);
        assert_int_equal(scenario.settled.motions[0].section_count, 1 + i);
        Trajectory *run = run_scenario(&scenario, registry_solver(BACKEND_REFERENCE),
                                       (RunWatch){.progress = NULL});
        assert_int_equal(section_find(run).period, 1 + i);
        trajectory_destroy(run);
        scenario_free(&scenario);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(growth_is_the_restitution_where_it_turns),
        cmocka_unit_test(growth_is_the_larger_eigenvalue),
        cmocka_unit_test(all_multipliers_are_those_of_the_matrix),
        cmocka_unit_test(multipliers_of_gears_have_the_product_of_their_damper),
        cmocka_unit_test(a_change_that_is_gone_has_a_bound),
        cmocka_unit_test(changes_grow_where_nothing_repeats),
        cmocka_unit_test(the_period_doubles_where_it_must),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
