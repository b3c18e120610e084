// Does a turn cost the reference as much after many turns as at first?
//
// Once it did not: positions were held from the world's origin and angles as they had grown, so
// that their rounding made the steps shorter with every turn. Evaluations do not jitter.
#include "close.h"

#include "mechanism.h"

#include "reference/stepper.h"

#include <stdlib.h>

enum { TURNS = 30 };

// The paper's mechanism with a loose pin, which lies against its wall from the second turn on.
static Scenario lying_pin(double turns)
{
    Scenario scenario = mechanism_loose(1);
    scenario.run.revolutions = turns;
    return scenario;
}

// Evaluations up to the end of each of some turns.
static void count_turns(const Scenario *scenario, size_t turns, size_t *evaluations)
{
    Stepper *stepper = calloc(1, sizeof *stepper);
    assert_non_null(stepper);
    Err err = {ERR_NONE, ""};
    assert_true(stepper_init(stepper, scenario, &err));
    const double turn_s = scenario_duration(scenario) / (double)turns;
    for (size_t turn = 0; turn < turns; turn++) {
        double time_s = 0.0;
        while (time_s < turn_s * (double)(turn + 1) * (1.0 - 1e-12)) {
            assert_true(stepper_next(stepper, &err));
            time_s = stepper->system->kind->time(stepper->system, stepper->integrator.tried);
        }
        evaluations[turn] = stepper->integrator.evaluations;
    }
    stepper_finish(stepper);
    free(stepper);
}

static void a_late_turn_costs_what_an_early_one_does(void **state)
{
    (void)state;
    const Scenario scenario = lying_pin(TURNS);
    size_t evaluations[TURNS];
    count_turns(&scenario, TURNS, evaluations);
    const double early = (double)(evaluations[9] - evaluations[4]);
    const double late = (double)(evaluations[TURNS - 1] - evaluations[TURNS - 6]);
    print_message("# evaluations a turn: %zu, %.0f, %.0f\n", evaluations[0], early / 5.0,
                  late / 5.0);
    assert_close(late, early, 0.01);
    assert_true(late / 5.0 < 1.3 * (double)evaluations[0]);
}

// Angles of a thousand turns and more are no different.
static void how_often_the_crank_has_turned_costs_nothing(void **state)
{
    (void)state;
    Scenario scenario = lying_pin(1.0);
    size_t first;
    count_turns(&scenario, 1, &first);
    static const double BEFORE[] = {1e3, 1e5};
    for (size_t i = 0; i < sizeof BEFORE / sizeof *BEFORE; i++) {
        Scenario turned = scenario_copy(&scenario);
        turned.linkage.driver.start += 2.0 * M_PI * BEFORE[i];
        for (size_t body = 0; body < turned.linkage.body_count; body++) {
            turned.linkage.bodies[body].start.angle += 2.0 * M_PI * BEFORE[i];
        }
        size_t evaluations;
        count_turns(&turned, 1, &evaluations);
        print_message("# after %g turns: %zu, at first %zu\n", BEFORE[i], evaluations, first);
        assert_close((double)evaluations, (double)first, 0.02);
        scenario_free(&turned);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_late_turn_costs_what_an_early_one_does),
        cmocka_unit_test(how_often_the_crank_has_turned_costs_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
