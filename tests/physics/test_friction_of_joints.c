// Does each joint with play slide with the friction of its own?
//
// One coefficient for all joints, and the same given to each, are one mechanism and give the same
// bits. With different ones ODE's contacts, integrated within the step, follow the reference, which
// takes its friction from the law by another way; the control is one coefficient for all of them.
#include "load_case.h"
#include "ode_error.h"

enum { SETTINGS = 5 };

static const char *const PLANE = "cases/mechanisms/slider-crank-both.yaml";
static const char *const SPACE = "cases/space/bennett.yaml";

static uint64_t hash_of(const Scenario *scenario, BackendKind backend)
{
    Trajectory *run = complete_run(scenario, backend);
    const uint64_t hash = run->hash;
    trajectory_destroy(run);
    return hash;
}

static void expect_same(const char *path, const char *const *common, const char *const *own)
{
    static const char *const MAPS[] = {"ode.map=impulse", "ode.map=midpoint"};
    for (int i = 0; i < 2; i++) {
        const char *settings[2][SETTINGS + 1];
        for (int k = 0; k < SETTINGS; k++) {
            settings[0][k] = common[k];
            settings[1][k] = own[k];
        }
        settings[0][SETTINGS] = settings[1][SETTINGS] = MAPS[i];
        const Scenario all = load(path, settings[0], SETTINGS + 1);
        const Scenario each = load(path, settings[1], SETTINGS + 1);
        assert_int_equal(hash_of(&all, BACKEND_ODE), hash_of(&each, BACKEND_ODE));
        assert_int_equal(hash_of(&all, BACKEND_REFERENCE), hash_of(&each, BACKEND_REFERENCE));
    }
}

static void one_coefficient_for_all_is_the_same_for_each(void **state)
{
    (void)state;
    static const char *const COMMON[] = {"run.revolutions=0.03", "run.step=2us", "run.samples=360",
                                         "ode.seed=1", "contact.friction=0.2"};
    static const char *const OWN[] = {
        "run.revolutions=0.03", "run.step=2us", "joints.crank-rod.friction=0.2",
        "joints.rod-slider.friction=0.2", "joints.slider-guide.friction=0.2"};
    expect_same(PLANE, COMMON, OWN);
    static const char *const COMMON_SPACE[] = {"run.revolutions=0.02", "run.step=5us",
                                               "run.samples=1200", "ode.seed=1",
                                               "contact.friction=0.2"};
    static const char *const OWN_SPACE[] = {"run.revolutions=0.02", "run.step=5us",
                                            "run.samples=1200", "contact.friction=0",
                                            "joints.coupler-follower.friction=0.2"};
    expect_same(SPACE, COMMON_SPACE, OWN_SPACE);
}

// The error of ODE at one set of coefficients against the reference at another.
static double error_between(const char *const *ode_settings, const char *const *settings)
{
    const Scenario stepped = load(PLANE, ode_settings, SETTINGS);
    const Scenario exact = load(PLANE, settings, SETTINGS);
    Trajectory *ode = complete_run(&stepped, BACKEND_ODE);
    Trajectory *reference = complete_run(&exact, BACKEND_REFERENCE);
    const TrajectoryError error = error_against(ode, reference, INFINITY);
    assert_true(error.is_known);
    trajectory_destroy(ode);
    trajectory_destroy(reference);
    return error.max;
}

static void ode_follows_the_reference_with_a_friction_a_joint(void **state)
{
    (void)state;
    static const char *const OWN[] = {"run.revolutions=0.07", "run.step=2us",
                                      "joints.crank-rod.friction=0.4", "contact.friction=0",
                                      "joints.slider-guide.friction=0.1"};
    static const char *const COMMON[] = {"run.revolutions=0.07", "run.step=2us", "run.samples=3600",
                                         "ode.seed=1", "contact.friction=0.1"};
    const double error = error_between(OWN, OWN);
    const double missed = error_between(OWN, COMMON);
    print_message("error %.2g; against one coefficient for all %.2g\n", error, missed);
    assert_true(error < 1e-4); // 2 us are a seventh of a contact
    assert_true(missed > 100.0 * error);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_coefficient_for_all_is_the_same_for_each),
        cmocka_unit_test(ode_follows_the_reference_with_a_friction_a_joint),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
