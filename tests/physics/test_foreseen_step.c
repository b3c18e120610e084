// Is mid-step foreseen in a step with contacts inside, where a drive speeds up and in a first step?
//
// Outside truth: the reference. Controls: bodies that answer the contacts as at mid-step
// throughout, which foresees nothing.
#include "load_case.h"
#include "ode_error.h"

#include <math.h>
#include <stdio.h>

static Scenario within(const char *path, const char *override)
{
    const char *const overrides[] = {"ode.map=impulse", override};
    return load(path, overrides, 2);
}

// The drive says how its body goes at mid-step: what it gains until then is in that.
static void a_driven_body_is_foreseen_where_its_drive_has_it(void **state)
{
    (void)state;
    Scenario scenario = within("cases/mechanisms/start-and-stop.yaml", "run.samples=640");
    const double error = ode_error_at(scenario, BACKEND_REFERENCE, 20e-6).omega_max;
    scenario.ode.is_frozen = true;
    const double frozen = ode_error_at(scenario, BACKEND_REFERENCE, 20e-6).omega_max;
    print_message("# at 20 us %.3g, frozen %.3g\n", error, frozen);
    // the driven body's gain taken twice leaves 7.2e-7
    assert_true(error < 2e-7);
    assert_true(frozen > 1e-6);
}

enum { STARTS = 8 }; // crank angles, an eighth of a turn apart

// A run's first impact may fall into its first step, before which there was none to say how the
// motion accelerates. Without the accelerations at its start the mean below is 2.2e-3.
static void a_first_step_knows_how_the_motion_accelerates(void **state)
{
    (void)state;
    double sum = 0.0;
    double frozen = 0.0;
    for (int i = 0; i < STARTS; i++) {
        char start[32];
        snprintf(start, sizeof start, "drive.start=%d deg", 45 * i);
        Scenario scenario = within("cases/paper/impact-k66.yaml", start);
        scenario.run.revolutions = 0.05;
        scenario.run.samples = 200;
        sum += log(ode_error_at(scenario, BACKEND_REFERENCE, 200e-6).omega_max) / STARTS;
        scenario.ode.is_frozen = true;
        frozen += log(ode_error_at(scenario, BACKEND_REFERENCE, 200e-6).omega_max) / STARTS;
    }
    print_message("# at 200 us %.3g, frozen %.3g\n", exp(sum), exp(frozen));
    assert_true(exp(sum) < 3e-4);
    assert_true(exp(frozen) > 3e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_driven_body_is_foreseen_where_its_drive_has_it),
        cmocka_unit_test(a_first_step_knows_how_the_motion_accelerates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
