// Is mid-step foreseen in a step with contacts inside where a drive speeds up?
//
// Outside truth: the reference. Controls: bodies that answer the contacts as at mid-step
// throughout, which foresees nothing.
#include "load_case.h"
#include "ode_error.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_driven_body_is_foreseen_where_its_drive_has_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
