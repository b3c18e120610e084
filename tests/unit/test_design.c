// Do runs follow from their numbers, do shards make up the whole, and do values arrive unchanged?
#include "commands/study/design.h"

#include "kept.h"
#include "same_scenario.h"
#include "study_file.h"

#include <stdlib.h>

// A study that is nothing but its counts: slow grid, draws, fast grid.
static Spec make_spec(uint64_t slow, uint64_t draws, uint64_t fast, bool draws_change_truth)
{
    Spec spec = {.draws = draws, .variable_count = 3, .method = DRAW_LATIN_HYPERCUBE};
    spec.variables[0] = (Variable){
        .key = "slow", .kind = VARIABLE_LINEAR, .changes_truth = true, .count = slow, .high = 1.0};
    spec.variables[1] = (Variable){.key = "drawn",
                                   .kind = VARIABLE_UNIFORM,
                                   .is_drawn = true,
                                   .changes_truth = draws_change_truth,
                                   .high = 1.0};
    spec.variables[2] =
        (Variable){.key = "fast", .kind = VARIABLE_LINEAR, .count = fast, .high = 1.0};
    return spec;
}

static void runs_are_nested_loops(void **state)
{
    (void)state;
    Spec spec =
        study_read("paper/impact-k66.yaml", "vary:\n"
                                            "  run.step: [1 us, 2 us, 5 us]\n"
                                            "  drive.speed: [100 rad/s, 50 rad/s]\n"
                                            "  scheme: [reference, direct/plain/textbook]\n"
                                            "  contact.damping: [flores, none, exact]\n"
                                            "draw:\n"
                                            "  count: 4\n"
                                            "  keys:\n"
                                            "    contact.restitution: {uniform: [0.5, 0.9]}\n");
    static const double STEPS[] = {1e-6, 2e-6, 5e-6};
    static const double SPEEDS[] = {100.0, 50.0};
    static const char *const SCHEMES[] = {"reference", "direct/plain/textbook"};
    static const char *const DAMPINGS[] = {"flores", "none", "exact"};
    assert_int_equal(design_run_count(&spec), 2 * 3 * 4 * 3 * 2);
    double drawn[4];
    uint64_t run = 0;
    for (size_t speed = 0; speed < 2; speed++) {
        for (size_t damping = 0; damping < 3; damping++) {
            for (size_t draw = 0; draw < 4; draw++) {
                for (size_t step = 0; step < 3; step++) {
                    for (size_t scheme = 0; scheme < 2; scheme++, run++) {
                        Cell values[RECORD_SETTING_MAX];
                        design_values(&spec, run, values);
                        assert_true(values[0].number == SPEEDS[speed]);
                        assert_string_equal(values[1].word, DAMPINGS[damping]);
                        assert_true(values[3].number == STEPS[step]);
                        assert_string_equal(values[4].word, SCHEMES[scheme]);
                        // the same draws at every point of the grid
                        drawn[draw] =
                            speed + damping + step + scheme == 0 ? values[2].number : drawn[draw];
                        assert_true(values[2].number == drawn[draw]);
                        assert_int_equal(design_group(&spec, run), run / 6);
                    }
                }
            }
        }
    }
    assert_int_equal(run, design_run_count(&spec));
    spec_finish(&spec);
}

static void ranges_have_exact_ends_and_even_steps(void **state)
{
    (void)state;
    Spec spec = study_read("paper/impact-k66.yaml",
                           "vary:\n"
                           "  run.step: {from: 0.3 us, to: 30 us, count: 5, scale: log}\n"
                           "  drive.speed: {from: 100 rad/s, to: 500 rad/s, count: 5}\n"
                           "  ode.iterations: {from: 1, to: 64, count: 7, scale: log}\n");
    Cell values[RECORD_SETTING_MAX];
    for (uint64_t i = 0; i < 5; i++) {
        design_values(&spec, i * 35, values);
        assert_true(values[0].number == 100.0 * (double)(i + 1));
        design_values(&spec, i * 7, values);
        assert_close(values[1].number, 0.3e-6 * pow(10.0, 0.5 * (double)i), 1e-15);
    }
    assert_true(values[1].number == 30e-6);
    for (uint64_t i = 0; i < 7; i++) {
        design_values(&spec, i, values);
        assert_true(values[2].number == (double)(1u << i));
    }
    spec_finish(&spec);
}

// Counts how often each run is in one of the shards; true if once each.
static bool shards_are_whole(const Spec *spec, uint64_t shard_count)
{
    const uint64_t runs = design_run_count(spec);
    uint8_t *counts = calloc(runs, 1);
    bool is_whole = true;
    for (uint64_t index = 0; index < shard_count; index++) {
        const Shard shard = {index, shard_count};
        uint64_t own = 0;
        for (uint64_t run = 0; (run = design_next(spec, shard, run)) < runs; run++) {
            counts[run]++;
            own++;
        }
        is_whole = is_whole && own == design_shard_count(spec, shard);
    }
    for (uint64_t run = 0; run < runs; run++) {
        is_whole = is_whole && counts[run] == 1;
    }
    free(counts);
    return is_whole;
}

static void shards_are_disjoint_and_make_up_the_whole(void **state)
{
    (void)state;
    static const uint64_t SIZES[] = {1, 2, 3, 7, 12};
    enum { SIZE_COUNT = sizeof SIZES / sizeof SIZES[0] };
    for (size_t i = 0; i < SIZE_COUNT * SIZE_COUNT * SIZE_COUNT; i++) {
        for (int changes = 0; changes < 2; changes++) {
            // a range of one value never is, but it counts like any other
            Spec spec = make_spec(SIZES[i % SIZE_COUNT], SIZES[i / SIZE_COUNT % SIZE_COUNT],
                                  SIZES[i / SIZE_COUNT / SIZE_COUNT], changes == 1);
            for (uint64_t shards = 1; shards < 20; shards += 3) {
                spec.has_neighbours = false;
                assert_true(shards_are_whole(&spec, shards));
                spec.has_neighbours = true;
                assert_true(shards_are_whole(&spec, shards));
            }
        }
    }
}

static void a_shard_keeps_groups_whole_where_there_are_enough(void **state)
{
    (void)state;
    const Spec spec = make_spec(3, 4, 5, true); // 12 groups of 5
    for (uint64_t index = 0; index < 7; index++) {
        const Shard shard = {index, 7};
        for (uint64_t run = 0; (run = design_next(&spec, shard, run)) < 60; run++) {
            assert_int_equal(design_group(&spec, run) % 7, index);
        }
    }
    // more shards than groups: single runs, so that no shard is empty
    for (uint64_t index = 0; index < 13; index++) {
        assert_true(design_shard_count(&spec, (Shard){index, 13}) >= 4);
    }
}

static void a_shard_keeps_blocks_whole_where_there_are_enough(void **state)
{
    (void)state;
    Spec spec = make_spec(10, 9, 3, true); // 90 groups of 3: four blocks of 60 and one of 30
    spec.has_neighbours = true;
    assert_int_equal(design_block_size(&spec), 60);
    for (uint64_t index = 0; index < 4; index++) {
        const Shard shard = {index, 4};
        for (uint64_t run = 0; (run = design_next(&spec, shard, run)) < 270; run++) {
            assert_int_equal(run / 60 % 4, index);
        }
        assert_int_equal(design_shard_count(&spec, shard), index == 0 ? 90 : 60);
    }
    // with no more blocks than that groups are divided
    assert_int_equal(design_shard_count(&spec, (Shard){5, 6}), 45);
}

static void draws_that_leave_the_truth_share_one(void **state)
{
    (void)state;
    const Spec shared = make_spec(3, 4, 5, false);
    const Spec own = make_spec(3, 4, 5, true);
    assert_int_equal(design_group(&shared, 59), 2);
    assert_int_equal(design_group(&own, 59), 11);
}

static void a_run_of_a_billion_needs_no_list(void **state)
{
    (void)state;
    const Spec spec = make_spec(1000, 1000, 1000, true);
    Cell values[RECORD_SETTING_MAX];
    assert_int_equal(design_run_count(&spec), 1000000000);
    design_values(&spec, 999999999, values);
    assert_true(values[0].number == 1.0 && values[2].number == 1.0);
    design_values(&spec, 123456789, values);
    assert_near(values[0].number, 123.0 / 999.0, 1e-16);
    assert_near(values[2].number, 789.0 / 999.0, 1e-16);
    // group 999990 is shard 16's, the next that is shard 3's is 999994
    assert_int_equal(design_next(&spec, (Shard){16, 17}, 999990500), 999990500);
    assert_int_equal(design_next(&spec, (Shard){3, 17}, 999990500), 999994000);
    assert_int_equal(design_next(&spec, (Shard){0, 17}, 999999000), 1000000000);
    assert_int_equal(design_shard_count(&spec, (Shard){0, 17}), 58824000);
    // and as many as there may be
    const Spec most = make_spec((uint64_t)1 << 20, (uint64_t)1 << 20, (uint64_t)1 << 13, true);
    design_values(&most, ((uint64_t)1 << 53) - 1, values);
    assert_true(values[0].number == 1.0 && values[2].number == 1.0);
    assert_int_equal(design_next(&most, (Shard){5, 7}, ((uint64_t)1 << 53) - 1), (uint64_t)1 << 53);
}

static Scenario make_run(const Spec *spec, uint64_t run, BackendKind *backend)
{
    Cell values[RECORD_SETTING_MAX];
    Scenario scenario;
    Err err = {0};
    design_values(spec, run, values);
    if (!design_scenario(spec, values, &scenario, backend, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

static void values_arrive_as_if_written_in_the_case(void **state)
{
    (void)state;
    Spec spec =
        study_read("paper/impact-k66.yaml", "set: {run.revolutions: 0.1, drive.start: 33 deg}\n"
                                            "vary:\n"
                                            "  drive.speed: [997 rpm]\n"
                                            "  contact.stiffness: [6.7e10 N/m^1.5]\n"
                                            "  joints.crank-coupler.hole: [10.017 mm]\n"
                                            "  joints.crank-coupler.pin: [9.987 mm]\n"
                                            "  joints.crank-coupler.start: [[3 um, 1.1 um]]\n"
                                            "  contact.damping: flores\n"
                                            "  ode.map: corrected\n"
                                            "  run.step: 0.7 us\n"
                                            "  run.samples: 360\n");
    static const char *const BY_HAND[] = {
        "run.revolutions=0.1",
        "drive.start=33 deg",
        "drive.speed=997 rpm",
        "contact.stiffness=6.7e10 N/m^1.5",
        "joints.crank-coupler.hole=10.017 mm",
        "joints.crank-coupler.pin=9.987 mm",
        "joints.crank-coupler.start=[3 um, 1.1 um]",
        "contact.damping=flores",
        "ode.map=corrected",
        "run.step=0.7 us",
        "run.samples=360",
    };
    BackendKind backend = BACKEND_ANALYTIC;
    Scenario drawn = make_run(&spec, 0, &backend);
    Scenario written;
    Err err = {0};
    assert_true(casefile_load("cases/paper/impact-k66.yaml", BY_HAND,
                              sizeof BY_HAND / sizeof BY_HAND[0], &written, &err));
    assert_int_equal(backend, BACKEND_ODE);
    assert_same_scenario(&drawn, &written);
    scenario_free(&written);
    spec_finish(&spec);
}

static void a_drawn_value_arrives_with_all_its_digits(void **state)
{
    (void)state;
    Spec spec = study_read("paper/stackup-impact.yaml",
                           "draw:\n"
                           "  count: 20\n"
                           "  keys:\n"
                           "    four-bar.coupler.length: tolerance\n"
                           "    joints.crank-coupler.hole: {uniform: [10.01 mm, 10.02 mm]}\n"
                           "    contact.restitution: {uniform: [0.7, 0.9]}\n");
    for (uint64_t run = 0; run < 20; run++) {
        Cell values[RECORD_SETTING_MAX];
        BackendKind backend;
        design_values(&spec, run, values);
        const Scenario scenario = make_run(&spec, run, &backend);
        assert_true(scenario.fourbar.coupler.nominal == values[0].number);
        assert_true(scenario.linkage.joints[1].clearance.hole_radius == 0.5 * values[1].number);
        assert_true(scenario.contact.restitution == values[2].number);
        // within the tolerance, which a drawn length has no more
        assert_true(fabs(values[0].number - 0.2794) <= 0.5e-3);
        assert_true(scenario.fourbar.coupler.upper == 0.0);
    }
    spec_finish(&spec);
}

static void schemes_set_what_compare_sets(void **state)
{
    (void)state;
    Spec spec = study_read("paper/impact-k66.yaml",
                           "vary:\n"
                           "  scheme: [direct/staggered/impulse, quick/plain/corrected, auto/1e-4, "
                           "reference]\n"
                           "  run.step: 3 us\n");
    BackendKind backend;
    Scenario scenario = make_run(&spec, 0, &backend);
    assert_int_equal(backend, BACKEND_ODE);
    assert_int_equal(scenario.ode.stepping, ODE_STAGGERED);
    assert_int_equal(scenario.ode.map, ODE_MAP_IMPULSE);
    assert_true(scenario.run.step == 3e-6);
    scenario = make_run(&spec, 1, &backend);
    assert_int_equal(scenario.ode.solver, ODE_QUICK);
    scenario = make_run(&spec, 2, &backend);
    assert_int_equal(backend, BACKEND_ODE);
    assert_true(scenario.run.step == 0.0 && scenario.run.tolerance == 1e-4);
    make_run(&spec, 3, &backend);
    assert_int_equal(backend, BACKEND_REFERENCE);
    spec_finish(&spec);
}

static void schemes_and_keys_set_the_collider(void **state)
{
    (void)state;
    Spec spec =
        study_read("paper/impact-k66.yaml",
                   "vary:\n"
                   "  scheme: [direct/staggered/midpoint, direct/staggered/midpoint/trimesh]\n"
                   "  run.step: 3 us\n");
    BackendKind backend;
    Scenario scenario = make_run(&spec, 0, &backend);
    assert_int_equal(scenario.ode.collider, ODE_COLLIDER_PIN_HOLE);
    scenario = make_run(&spec, 1, &backend);
    assert_int_equal(scenario.ode.collider, ODE_COLLIDER_TRIMESH);
    assert_int_equal(scenario.ode.map, ODE_MAP_MIDPOINT);
    spec_finish(&spec);
    spec = study_read("paper/impact-k66.yaml", "vary:\n"
                                               "  ode.collider: [pin-hole, staves]\n"
                                               "  ode.facets: [64, 128]\n");
    scenario = make_run(&spec, 2, &backend);
    assert_int_equal(scenario.ode.collider, ODE_COLLIDER_STAVES);
    assert_int_equal(scenario.ode.facets, 64);
    scenario = make_run(&spec, 3, &backend);
    assert_int_equal(scenario.ode.facets, 128);
    spec_finish(&spec);
}

static void refuse(const Spec *spec, uint64_t run, const char *reason)
{
    Cell values[RECORD_SETTING_MAX];
    Scenario scenario;
    BackendKind backend;
    Err err = {0};
    design_values(spec, run, values);
    assert_false(design_scenario(spec, values, &scenario, &backend, &err));
    assert_int_equal(err.kind, ERR_CASE);
    assert_string_equal(err.text, reason);
}

static void values_that_make_no_case_are_refused_in_one_line(void **state)
{
    (void)state;
    Spec spec = study_read("paper/stackup-impact.yaml",
                           "vary:\n"
                           "  joints.crank-coupler.hole: [10.02 mm, 9.6 mm]\n");
    // as short as the number can be read back, not 0.0095999999999999992
    refuse(&spec, 1,
           "joints.crank-coupler.hole=0.0096 m: the pin (9.986 mm) must be smaller than the hole "
           "(0.0096 m)");
    spec_finish(&spec);
    spec = study_read("paper/impact-k66.yaml", "vary:\n"
                                               "  contact.model: [impact, poisson]\n"
                                               "  scheme: [direct/plain/exact, direct/plain]\n");
    refuse(&spec, 1, "with these values there is no scheme direct/plain");
    refuse(&spec, 2, "with these values there is no scheme direct/plain/exact");
    spec_finish(&spec);
    spec = study_read("paper/impact-k66.yaml", "set: {ode.stepping: plain}\n"
                                               "vary:\n"
                                               "  ode.map: [textbook, impulse]\n");
    refuse(&spec, 1, "ode.map=impulse: map impulse needs stepping staggered");
    spec_finish(&spec);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_are_nested_loops),
        cmocka_unit_test(ranges_have_exact_ends_and_even_steps),
        cmocka_unit_test(shards_are_disjoint_and_make_up_the_whole),
        cmocka_unit_test(a_shard_keeps_groups_whole_where_there_are_enough),
        cmocka_unit_test(a_shard_keeps_blocks_whole_where_there_are_enough),
        cmocka_unit_test(draws_that_leave_the_truth_share_one),
        cmocka_unit_test(a_run_of_a_billion_needs_no_list),
        cmocka_unit_test(values_arrive_as_if_written_in_the_case),
        cmocka_unit_test(a_drawn_value_arrives_with_all_its_digits),
        cmocka_unit_test(schemes_set_what_compare_sets),
        cmocka_unit_test(schemes_and_keys_set_the_collider),
        cmocka_unit_test(values_that_make_no_case_are_refused_in_one_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
