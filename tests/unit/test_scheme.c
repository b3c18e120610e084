// Do the lists of choices make every scheme that differs, and none that does not?
#include "measure/scheme.h"

#include "close.h"
#include "mechanism.h"

#include <string.h>

static size_t words(const char *const *list)
{
    size_t count = 0;
    while (list[count] != NULL) {
        count++;
    }
    return count;
}

static size_t steppers(const Scheme *schemes, size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        found += scheme_has_step(&schemes[i]) ? 1 : 0;
    }
    return found;
}

static void with_play_every_choice_counts(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    Scheme schemes[SCHEME_MAX];
    const size_t count = scheme_list(&scenario, schemes);
    // every map and collider with plain and staggered stepping, none with extrapolated; impulse
    // with staggered stepping and the exact collider alone
    assert_int_equal(steppers(schemes, count),
                     words(OPTIONS_ODE_SOLVERS) *
                         (2 * (words(OPTIONS_ODE_MAPS) - 1) * words(OPTIONS_ODE_COLLIDERS) + 1));
    assert_string_equal(schemes[count - 2].name, "auto/1e-6");
    assert_string_equal(schemes[count - 1].name, "reference");
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < i; k++) {
            assert_string_not_equal(schemes[i].name, schemes[k].name);
        }
    }
}

static void the_map_is_left_out_for_poisson(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.contact.model = CONTACT_POISSON;
    scenario.ode.map = ODE_MAP_CORRECTED;
    Scheme schemes[SCHEME_MAX];
    const size_t count = scheme_list(&scenario, schemes);
    assert_int_equal(steppers(schemes, count), words(OPTIONS_ODE_SOLVERS) *
                                                   (words(OPTIONS_ODE_STEPPINGS) - 1) *
                                                   words(OPTIONS_ODE_COLLIDERS));
    assert_string_not_equal(schemes[count - 2].name, "auto/1e-6");
    assert_int_equal(schemes[0].map, ODE_MAP_CORRECTED);
    assert_null(strstr(schemes[0].name, "corrected"));
}

static void without_play_solver_and_stepping_are_left(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    Scheme schemes[SCHEME_MAX];
    const size_t count = scheme_list(&scenario, schemes);
    assert_int_equal(steppers(schemes, count),
                     words(OPTIONS_ODE_SOLVERS) * words(OPTIONS_ODE_STEPPINGS));
    assert_string_equal(schemes[0].name, "direct/plain");
    assert_string_equal(schemes[count - 2].name, "reference");
    assert_string_equal(schemes[count - 1].name, "analytic");
}

static void the_closed_form_is_of_four_bars_alone(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_parallelogram();
    assert_false(scenario.has_fourbar || scenario_has_clearance(&scenario));
    Scheme schemes[SCHEME_MAX];
    const size_t count = scheme_list(&scenario, schemes);
    for (size_t i = 0; i < count; i++) {
        assert_string_not_equal(schemes[i].name, "analytic");
    }
}

static void what_is_driven_alone_cannot_be_in_error(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    Err err = {0};
    assert_true(scheme_check(&scenario, &err));
    scenario.linkage.body_count = 1;
    assert_false(scheme_check(&scenario, &err));
    assert_int_equal(err.kind, ERR_CASE);
    assert_non_null(strstr(err.text, "there is nothing to compare"));
    // one body that nothing drives does move by itself
    const Scenario pin = mechanism_pin(1.0, 1e-4);
    assert_true(scheme_check(&pin, &err));
}

static void a_scheme_sets_what_it_stands_for(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    const Scheme scheme = {.backend = BACKEND_ODE,
                           .solver = ODE_QUICK,
                           .map = ODE_MAP_CORRECTED,
                           .collider = ODE_COLLIDER_PIN_HOLE};
    scheme_apply(&scheme, 3e-6, &scenario);
    assert_int_equal(scenario.ode.solver, ODE_QUICK);
    assert_int_equal(scenario.ode.map, ODE_MAP_CORRECTED);
    assert_near(scenario.run.step, 3e-6, 0.0);
    const Scheme reference = {.backend = BACKEND_REFERENCE};
    scheme_apply(&reference, 1e-6, &scenario);
    assert_near(scenario.run.step, 3e-6, 0.0);
}

static void a_list_keeps_those_with_all_of_its_words(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    Scheme schemes[SCHEME_MAX];
    Err err = {0};
    size_t count = scheme_list(&scenario, schemes);
    const size_t all = steppers(schemes, count);
    assert_true(scheme_filter("direct", schemes, &count, &err));
    assert_int_equal(steppers(schemes, count), 2 * words(OPTIONS_ODE_MAPS) - 1);
    assert_true(steppers(schemes, count) < all / words(OPTIONS_ODE_SOLVERS));
    assert_true(scheme_filter("textbook/plain, direct/plain/corrected", schemes, &count, &err));
    assert_int_equal(steppers(schemes, count), 2);
    // what has no step stays
    assert_string_equal(schemes[count - 1].name, "reference");
}

static void a_collider_is_taken_where_it_is_named(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    Scheme schemes[SCHEME_MAX];
    Err err = {0};
    size_t count = scheme_list(&scenario, schemes);
    assert_true(scheme_filter("direct/plain/textbook, direct/plain/textbook/trimesh", schemes,
                              &count, &err));
    assert_int_equal(steppers(schemes, count), 2);
    assert_string_equal(schemes[0].name, "direct/plain/textbook");
    assert_string_equal(schemes[1].name, "direct/plain/textbook/trimesh");
    count = scheme_list(&scenario, schemes);
    assert_true(scheme_filter("staves", schemes, &count, &err));
    assert_int_equal(steppers(schemes, count),
                     2 * words(OPTIONS_ODE_SOLVERS) * (words(OPTIONS_ODE_MAPS) - 1));
    count = scheme_list(&scenario, schemes);
    assert_true(scheme_filter("pin-hole", schemes, &count, &err));
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(schemes[i].collider, ODE_COLLIDER_PIN_HOLE);
    }
    // map impulse asks no collider
    count = scheme_list(&scenario, schemes);
    assert_false(scheme_filter("impulse/staves", schemes, &count, &err));
}

static void the_collider_of_the_case_is_usual_too(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.ode.collider = ODE_COLLIDER_STAVES;
    Scheme schemes[SCHEME_MAX];
    size_t count = scheme_list(&scenario, schemes);
    scheme_keep_usual(schemes, &count);
    // the six of the exact collider, and those of them that have rows
    assert_int_equal(steppers(schemes, count), 6 + 4);
    for (size_t i = 0; i < count; i++) {
        assert_true(schemes[i].collider == ODE_COLLIDER_PIN_HOLE ||
                    schemes[i].collider == ODE_COLLIDER_STAVES);
    }
}

static void a_word_that_no_scheme_has_is_told(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    Scheme schemes[SCHEME_MAX];
    size_t count = scheme_list(&scenario, schemes);
    const size_t before = count;
    Err err = {0};
    assert_false(scheme_filter("direct, direct/plane", schemes, &count, &err));
    assert_int_equal(err.kind, ERR_USAGE);
    assert_non_null(strstr(err.text, "did you mean 'direct/plain'"));
    err = (Err){0};
    assert_false(scheme_filter("something", schemes, &count, &err));
    assert_non_null(strstr(err.text, "one is 'direct/plain'"));
    err = (Err){0};
    assert_false(scheme_filter(" ,", schemes, &count, &err));
    assert_non_null(strstr(err.text, "empty"));
    assert_int_equal(count, before);
}

static void the_usual_ones_stand_for_their_kind(void **state)
{
    (void)state;
    static const char *const USUAL[] = {
        "direct/plain/textbook",    "direct/plain/corrected", "direct/staggered/midpoint",
        "direct/staggered/impulse", "quick/plain/textbook",   "quick/staggered/impulse",
    };
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    Scheme schemes[SCHEME_MAX];
    size_t count = scheme_list(&scenario, schemes);
    const size_t all = count;
    scheme_keep_usual(schemes, &count);
    assert_int_equal(steppers(schemes, count), 6);
    for (size_t i = 0; i < 6; i++) {
        assert_string_equal(schemes[i].name, USUAL[i]);
    }
    Err err = {0};
    count = scheme_list(&scenario, schemes);
    assert_true(scheme_filter("all", schemes, &count, &err));
    assert_int_equal(count, all);
}

static void a_chosen_step_is_applied_with_its_tolerance(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    Scheme schemes[SCHEME_MAX];
    const size_t count = scheme_list(&scenario, schemes);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(scheme_is_chosen(&schemes[i]), strncmp(schemes[i].name, "auto/", 5) == 0);
        if (strcmp(schemes[i].name, "auto/1e-5") == 0) {
            assert_false(scheme_has_step(&schemes[i]));
            scheme_apply(&schemes[i], 1e-6, &scenario);
            assert_near(scenario.run.step, 0.0, 0.0);
            assert_near(scenario.run.tolerance, 1e-5, 1e-20);
            return;
        }
    }
    fail_msg("no auto/1e-5");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(with_play_every_choice_counts),
        cmocka_unit_test(the_map_is_left_out_for_poisson),
        cmocka_unit_test(the_usual_ones_stand_for_their_kind),
        cmocka_unit_test(a_chosen_step_is_applied_with_its_tolerance),
        cmocka_unit_test(without_play_solver_and_stepping_are_left),
        cmocka_unit_test(the_closed_form_is_of_four_bars_alone),
        cmocka_unit_test(what_is_driven_alone_cannot_be_in_error),
        cmocka_unit_test(a_scheme_sets_what_it_stands_for),
        cmocka_unit_test(a_list_keeps_those_with_all_of_its_words),
        cmocka_unit_test(a_collider_is_taken_where_it_is_named),
        cmocka_unit_test(the_collider_of_the_case_is_usual_too),
        cmocka_unit_test(a_word_that_no_scheme_has_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
