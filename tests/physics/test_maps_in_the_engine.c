// Does each map deliver the law's restitution and peak force in ODE, down to how many steps a
// contact?
//
// Outside truths: the closed forms of a clamped linear spring and damper and of Hertz contact with
// Lankarani's and Nikravesh's damping. Means over sixteen phases of the steps.
#include "close.h"

#include "kept.h"
#include "one_impact.h"

static const double STEPS_A_CONTACT[] = {1000.0, 300.0, 100.0, 30.0, 10.0, 5.0};
enum { ROWS = sizeof STEPS_A_CONTACT / sizeof *STEPS_A_CONTACT, LAWS = 2 };

static Scenario make(OdeMap map, int law)
{
    return law == 0 ? one_impact_linear(map, 0.9)
                    : one_impact_hertz(map, DAMPING_LANKARANI_NIKRAVESH, 0.9);
}

// Restitution and peak force over the law's own.
static OneImpact over_law(const Scenario *scenario, double steps_a_contact)
{
    OneImpact impact = one_impact_run(*scenario, one_impact_duration(scenario) / steps_a_contact);
    assert_true(impact.is_single);
    impact.restitution /= one_impact_law_restitution(scenario);
    impact.force_max /= one_impact_law_force(scenario);
    return impact;
}

static void midpoint_and_exact_are_within_a_hundredth_down_to_ten_steps(void **state)
{
    (void)state;
    static const OdeMap MAPS[] = {ODE_MAP_MIDPOINT, ODE_MAP_EXACT};
    for (size_t map = 0; map < 2; map++) {
        for (int law = 0; law < LAWS; law++) {
            const Scenario scenario = make(MAPS[map], law);
            for (size_t i = 0; i < ROWS && STEPS_A_CONTACT[i] >= 10.0; i++) {
                const OneImpact impact = over_law(&scenario, STEPS_A_CONTACT[i]);
                assert_true(impact.is_single && impact.fallback_rows == 0);
                assert_near(impact.restitution, 1.0, 0.01);
                assert_near(impact.force_max, 1.0, 0.01);
            }
            // of second order: at 100 steps a hundredth of what 10 may lose
            const OneImpact fine = over_law(&scenario, 100.0);
            assert_near(fine.restitution, 1.0, 1e-4);
            assert_near(fine.force_max, 1.0, 1e-4);
        }
    }
}

// The control: what implicit Euler adds to the damping is seen from 300 steps a contact on.
static void the_textbook_map_is_not(void **state)
{
    (void)state;
    for (int law = 0; law < LAWS; law++) {
        const Scenario scenario = make(ODE_MAP_TEXTBOOK, law);
        for (size_t i = 0; i < ROWS; i++) {
            const OneImpact impact = over_law(&scenario, STEPS_A_CONTACT[i]);
            const bool is_lossy = STEPS_A_CONTACT[i] <= 300.0;
            assert_int_equal(impact.restitution < 0.99, is_lossy);
            assert_true(impact.force_max < (STEPS_A_CONTACT[i] <= 100.0 ? 0.99 : 1.0));
        }
    }
}

static void the_corrected_map_keeps_restitution_and_loses_force(void **state)
{
    (void)state;
    for (int law = 0; law < LAWS; law++) {
        const Scenario scenario = make(ODE_MAP_CORRECTED, law);
        for (size_t i = 0; i < ROWS; i++) {
            const OneImpact impact = over_law(&scenario, STEPS_A_CONTACT[i]);
            assert_near(impact.restitution, 1.0, 0.01);
            // the deepest point falls between two steps, and the damper is half a step late: of
            // first order, 0.16 / (Tc/h) of Hertz
            assert_near(impact.force_max, 1.0, 0.16 / STEPS_A_CONTACT[i] + 1e-4);
        }
    }
}

static void an_impact_within_the_step_is_the_laws_at_any_step(void **state)
{
    (void)state;
    static const double LONG_STEPS[] = {1.0, 0.3};
    for (int law = 0; law < LAWS; law++) {
        const Scenario scenario = make(ODE_MAP_IMPULSE, law);
        for (size_t i = 0; i < ROWS + 2; i++) {
            const double steps = i < ROWS ? STEPS_A_CONTACT[i] : LONG_STEPS[i - ROWS];
            const OneImpact impact = over_law(&scenario, steps);
            assert_true(impact.is_single);
            // local steps of 0.05 rad at order 4, but for the linear law's last, where its force
            // bends to stay at zero: that is worth 1e-5; forces are recorded at a parabola's top
            assert_near(impact.restitution, 1.0, law == 0 ? 3e-5 : 1e-7);
            assert_near(impact.force_max, 1.0, 1e-4);
        }
    }
}

// omega h 3.9, beyond the limits of all three maps, which would throw the pin out faster than it
// came: the rows become the textbook's, each and every number of them.
static void beyond_its_limit_a_map_falls_back_to_the_textbooks(void **state)
{
    (void)state;
    for (int map = ODE_MAP_CORRECTED; map <= ODE_MAP_EXACT; map++) {
        const Scenario scenario = make((OdeMap)map, 0);
        Scenario textbook = kept_copy(&scenario);
        textbook.ode.map = ODE_MAP_TEXTBOOK;
        const OneImpact fallen = over_law(&scenario, 0.8);
        const OneImpact expected = over_law(&textbook, 0.8);
        assert_true(fallen.fallback_rows > 0 && expected.fallback_rows == 0);
        assert_true(fallen.restitution >= 0.0 && fallen.restitution <= 1.0);
        assert_near(fallen.restitution, expected.restitution, 0.0);
        assert_near(fallen.force_max, expected.force_max, 0.0);
        // control: below its limit, omega h 1.6, the map is its own
        const OneImpact own = over_law(&scenario, 2.0);
        assert_int_equal(own.fallback_rows, 0);
        assert_true(own.restitution > over_law(&textbook, 2.0).restitution + 0.1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(midpoint_and_exact_are_within_a_hundredth_down_to_ten_steps),
        cmocka_unit_test(the_textbook_map_is_not),
        cmocka_unit_test(the_corrected_map_keeps_restitution_and_loses_force),
        cmocka_unit_test(an_impact_within_the_step_is_the_laws_at_any_step),
        cmocka_unit_test(beyond_its_limit_a_map_falls_back_to_the_textbooks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
