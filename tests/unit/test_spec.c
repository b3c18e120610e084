// Is a study file read as it is written, with every default that it leaves out?
#include "commands/study/spec.h"

#include "study_file.h"

#include <math.h>

static const char STEPS[] = "vary:\n  run.step: [1 us, 2 us]\n";

static void what_is_left_out_has_its_default(void **state)
{
    (void)state;
    Spec spec = study_read("paper/impact-k66.yaml", STEPS);
    assert_string_equal(spec.title, "");
    assert_int_equal(spec.draws, 1);
    assert_int_equal(spec.seed, 1);
    assert_int_equal(spec.method, DRAW_LATIN_HYPERCUBE);
    assert_true(spec.has_truth);
    assert_true(spec.limits.time_s == 60.0);
    assert_int_equal(spec.limits.memory_bytes, 2000000000);
    assert_int_equal(spec.set_count, 0);
    assert_int_equal(spec.base->linkage.body_count, 3);
    spec_finish(&spec);
}

// The case of a study's first run, which the caller frees.
static Scenario first_scenario(const Spec *spec)
{
    Cell values[RECORD_SETTING_MAX];
    Scenario scenario;
    BackendKind backend;
    Err err = {0};
    design_values(spec, 0, values);
    assert_true(design_scenario(spec, values, &scenario, &backend, &err));
    return scenario;
}

static void what_is_said_is_kept(void **state)
{
    (void)state;
    Spec spec = study_read("paper/impact-k66.yaml",
                           "title: A study\n"
                           "set:\n"
                           "  title: 'one: two'\n"
                           "  run.backends: [reference, ode]\n"
                           "  joints.crank-coupler.start: [-3 um, 1 \u00b5m]\n"
                           "vary:\n"
                           "  run.step: [1 us, 2 us]\n"
                           "draw: {count: 1e3, method: random, seed: 99, keys: {drive.speed: "
                           "{uniform: [1 rad/s, 2 rad/s]}}}\n"
                           "limits: {time: none, memory: 500 MB}\n"
                           "truth: false\n");
    assert_string_equal(spec.title, "A study");
    assert_int_equal(spec.set_count, 3);
    assert_string_equal(spec.set[0], "title=\"one: two\"");
    assert_string_equal(spec.set[1], "run.backends=[reference, ode]");
    assert_string_equal(spec.set[2], "joints.crank-coupler.start=[-3 um, \"1 \u00b5m\"]");
    assert_int_equal(spec.draws, 1000);
    assert_int_equal(spec.method, DRAW_RANDOM);
    assert_int_equal(spec.seed, 99);
    assert_false(spec.has_truth);
    assert_true(spec.limits.time_s == 0.0);
    assert_int_equal(spec.limits.memory_bytes, 500000000);
    // what was quoted is understood
    Scenario scenario = first_scenario(&spec);
    assert_string_equal(scenario.title, "one: two");
    assert_true(scenario.linkage.joints[1].clearance.start.x == -3e-6);
    scenario_free(&scenario);
    spec_finish(&spec);
}

static void distributions_are_those_of_the_file(void **state)
{
    (void)state;
    Spec spec =
        study_read("paper/stackup-impact.yaml",
                   "draw:\n"
                   "  count: 10\n"
                   "  keys:\n"
                   "    four-bar.coupler.length: tolerance\n"
                   "    four-bar.ground.length: {normal: tolerance}\n"
                   "    joints.crank-coupler.hole: {normal: {mean: 10.015 mm, deviation: 0.5 um}}\n"
                   "    contact.restitution: {triangular: {low: 0.7, mode: 0.9, high: 0.9}}\n"
                   "    contact.stiffness: {log-uniform: [1e10 N/m^1.5, 1e11 N/m^1.5]}\n");
    const Variable *coupler = study_variable(&spec, "four-bar.coupler.length");
    assert_int_equal(coupler->kind, VARIABLE_UNIFORM);
    assert_true(coupler->is_drawn && coupler->changes_truth);
    assert_near(coupler->low, 0.2789, 1e-16);
    assert_near(coupler->high, 0.2799, 1e-16);
    // limits three deviations from the mean
    const Variable *ground = study_variable(&spec, "four-bar.ground.length");
    assert_int_equal(ground->kind, VARIABLE_NORMAL);
    assert_near(ground->centre, 0.254, 1e-16);
    assert_close(ground->deviation, 0.5e-3 / 3.0, 1e-12);
    assert_near(ground->low, 0.2535, 1e-16);
    // a deviation is no diameter: it may be smaller than any
    const Variable *hole = study_variable(&spec, "joints.crank-coupler.hole");
    assert_true(hole->deviation == 0.5e-6);
    assert_true(isinf(hole->low) && isinf(hole->high));
    const Variable *stiffness = study_variable(&spec, "contact.stiffness");
    assert_int_equal(stiffness->kind, VARIABLE_LOG_UNIFORM);
    assert_string_equal(stiffness->unit, "N/m^1.5");
    spec_finish(&spec);
}

static void keys_stand_from_slow_to_fast(void **state)
{
    (void)state;
    Spec spec = study_read("paper/impact-k66.yaml",
                           "vary:\n"
                           "  ode.map: [textbook, exact]\n"
                           "  contact.damping: [none, flores]\n"
                           "  run.step: [1 us, 2 us]\n"
                           "  drive.speed: [100 rpm, 200 rpm]\n"
                           "draw: {count: 2, keys: {ode.cfm: {uniform: [0, 1]}}}\n");
    static const char *const ORDER[] = {"contact.damping", "drive.speed", "ode.cfm", "ode.map",
                                        "run.step"};
    assert_int_equal(spec.variable_count, 5);
    for (size_t i = 0; i < 5; i++) {
        assert_string_equal(spec.variables[i].key, ORDER[i]);
        assert_int_equal(spec.variables[i].changes_truth, i < 2);
    }
    assert_string_equal(spec.variables[2].unit, "");
    assert_string_equal(spec.variables[2].column_unit, "s/kg");
    spec_finish(&spec);
}

static void a_joint_gets_play_from_what_varies(void **state)
{
    (void)state;
    Spec spec = study_read("paper/impact-k66.yaml",
                           "vary:\n  joints.coupler-follower.radial-clearance: [1 um, 2 um]\n");
    assert_int_equal(spec.base->linkage.joints[2].kind, JOINT_CLEARANCE);
    assert_int_equal(spec.base->linkage.joints[3].kind, JOINT_REVOLUTE);
    spec_finish(&spec);
}

static uint64_t print_of(const char *name, const char *text)
{
    Spec spec = study_read(name, text);
    const uint64_t print = spec.print;
    spec_finish(&spec);
    return print;
}

static void the_fingerprint_is_that_of_the_runs(void **state)
{
    (void)state;
    static const char CASE[] = "paper/impact-k66.yaml";
    const uint64_t print = print_of(CASE, STEPS);
    // layout, title, limits and other words for the same number
    assert_true(print == print_of(CASE, "# a comment\nvary: {run.step: [1000e-3 us, 0.002 ms]}\n"));
    assert_true(print == print_of(CASE, "title: x\nlimits: {time: 5 s}\n"
                                        "vary:\n  run.step: [1 us, 2 us]\n"));
    assert_true(print == print_of(CASE, "set: {run.revolutions: 1}\n"
                                        "vary:\n  run.step: [1 us, 2 us]\n"));
    // and what makes other runs
    static const char *const OTHERS[] = {
        "vary:\n  run.step: [2 us, 1 us]\n",
        "vary:\n  run.step: [1 us, 3 us]\n",
        "vary:\n  run.step: {from: 1 us, to: 2 us, count: 2}\n",
        "set: {run.revolutions: 2}\nvary:\n  run.step: [1 us, 2 us]\n",
        "vary:\n  run.step: [1 us, 2 us]\ntruth: false\n",
        "vary:\n  run.step: [1 us, 2 us]\n  scheme: reference\n",
    };
    for (size_t i = 0; i < sizeof OTHERS / sizeof OTHERS[0]; i++) {
        assert_true(print != print_of(CASE, OTHERS[i]));
    }
    assert_true(print != print_of("paper/stackup-impact.yaml", STEPS));
    static const char DRAW[] = "draw: {count: 2, seed: %d, keys: {ode.cfm: {uniform: [0, 1]}}}\n";
    char first[128];
    char second[128];
    snprintf(first, sizeof first, DRAW, 1);
    snprintf(second, sizeof second, DRAW, 2);
    assert_true(print_of(CASE, first) != print_of(CASE, second));
}

// A joint that keeps its restitution while that of the contacts varies has the number that the
// others have in the case as it stands.
static void a_number_that_is_a_joints_own_makes_other_runs(void **state)
{
    (void)state;
    static const char CASE[] = "paper/impact-k66.yaml";
    static const char VARY[] = "vary:\n  contact.restitution: [0.5, 0.9]\n";
    char own[192];
    snprintf(own, sizeof own, "set: {joints.crank-coupler.restitution: 0.9}\n%s", VARY);
    assert_true(print_of(CASE, VARY) != print_of(CASE, own));
}

static void a_study_that_is_not_there_is_an_error_of_the_file(void **state)
{
    (void)state;
    Spec spec;
    Err err = {0};
    assert_false(spec_read("no-such-study.yaml", &spec, &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_string_equal(err.text, "no-such-study.yaml: cannot be read: No such file or directory");
    Err other = {0};
    assert_false(spec_read("cases", &spec, &other));
    assert_int_equal(other.kind, ERR_CASE);
    assert_string_equal(other.text, "cases: is a directory\nallowed: a study file");
}

// A variable of a study as the one scenario of its first run has it.
static void expect_limit(const char *file, const char *words, const char *unit, double first,
                         double (*of)(const Limits *limits))
{
    Spec spec = study_read(file, words);
    assert_int_equal(spec.variable_count, 1);
    assert_string_equal(spec.variables[0].column_unit, unit);
    Scenario scenario = first_scenario(&spec);
    double found = NAN;
    for (size_t i = 0; i < scenario.linkage.joint_count; i++) {
        const Limits *limits = &scenario.linkage.joints[i].limits;
        found = limits->kind != LIMIT_NONE ? of(limits) : found;
    }
    assert_close(found, first, 1e-14);
    scenario_free(&scenario);
    spec_finish(&spec);
}

static double backlash_of(const Limits *limits)
{
    return limits->backlash;
}

static double high_of(const Limits *limits)
{
    return limits->high;
}

// Of gears the backlash is an angle or a length, whichever the values say.
static void limits_of_a_joint_vary_in_its_own_units(void **state)
{
    (void)state;
    const double degree = M_PI / 180.0;
    expect_limit("mechanisms/servo-backlash.yaml",
                 "vary:\n  joints.output.backlash: [0.5 deg, 1 deg]\n", "rad", 0.5 * degree,
                 backlash_of);
    expect_limit("mechanisms/gear-pair.yaml", "vary:\n  joints.mesh.backlash: [0.2 mm, 0.3 mm]\n",
                 "m", 2e-4, backlash_of);
    expect_limit("mechanisms/stop-rebound.yaml",
                 "vary:\n  joints.hinge.high: {from: 80 deg, to: 90 deg, count: 2}\n", "rad",
                 80.0 * degree, high_of);
    Spec spec = study_read("mechanisms/servo-backlash.yaml",
                           "vary:\n"
                           "  joints.output.stiffness: [100 N m/rad, 200 N m/rad]\n"
                           "  joints.output.start: [0.1 deg, 0.2 deg]\n");
    assert_string_equal(spec.variables[0].column_unit, "N m/rad");
    assert_true(spec.variables[0].numbers[1] == 200.0);
    spec_finish(&spec);
}

// Parts of sinusoids vary as numbers in units of their own: of a signal in those of what uses it.
static void parts_of_sinusoids_vary(void **state)
{
    (void)state;
    Spec spec = study_read("mechanisms/shaken-lever.yaml",
                           "vary:\n"
                           "  signals.shaker.amplitude: {from: 5 N, to: 6 N, count: 3}\n"
                           "  loads.across.force.phase: [0 deg, 90 deg]\n"
                           "  loads.end.force.frequency: [19 Hz, 20 Hz]\n");
    assert_string_equal(spec.variables[0].column_unit, "N");
    assert_true(spec.variables[0].low == 5.0 && spec.variables[0].high == 6.0);
    assert_string_equal(spec.variables[1].column_unit, "rad");
    assert_string_equal(spec.variables[2].column_unit, "Hz");
    Scenario first = first_scenario(&spec);
    assert_true(first.linkage.loads[0].table.wave.amplitude == 5.0);
    assert_true(first.linkage.loads[1].table.wave.amplitude == 5.0);
    scenario_free(&first);
    spec_finish(&spec);
}

// Those that come with the program are read, and their first, middle and last runs are cases.
static void the_studies_of_the_program_are_good(void **state)
{
    (void)state;
    static const char *const PATHS[] = {"cases/studies/mapping.yaml",
                                        "cases/studies/stackup-monte-carlo.yaml",
                                        "cases/studies/clearance-spikes.yaml"};
    for (size_t i = 0; i < 3; i++) {
        Spec spec;
        Err err = {0};
        if (!spec_read(PATHS[i], &spec, &err)) {
            fail_msg("%s", err.text);
        }
        const uint64_t runs = design_run_count(&spec);
        assert_true(runs >= 2000);
        const uint64_t tried[] = {0, runs / 2, runs - 1};
        for (size_t k = 0; k < 3; k++) {
            Cell values[RECORD_SETTING_MAX];
            Scenario scenario;
            BackendKind backend;
            design_values(&spec, tried[k], values);
            if (!design_scenario(&spec, values, &scenario, &backend, &err)) {
                fail_msg("%s", err.text);
            }
            scenario_free(&scenario);
        }
        spec_finish(&spec);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_left_out_has_its_default),
        cmocka_unit_test(what_is_said_is_kept),
        cmocka_unit_test(distributions_are_those_of_the_file),
        cmocka_unit_test(keys_stand_from_slow_to_fast),
        cmocka_unit_test(a_joint_gets_play_from_what_varies),
        cmocka_unit_test(the_fingerprint_is_that_of_the_runs),
        cmocka_unit_test(a_number_that_is_a_joints_own_makes_other_runs),
        cmocka_unit_test(a_study_that_is_not_there_is_an_error_of_the_file),
        cmocka_unit_test(limits_of_a_joint_vary_in_its_own_units),
        cmocka_unit_test(parts_of_sinusoids_vary),
        cmocka_unit_test(the_studies_of_the_program_are_good),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
