// What does one impact in ODE give back, and how deep does a load press, by each map?
//
// A pin flies across its hole and hits the wall once. Outside truths: the one-freedom model of
// ODE's contact row, published delivered restitutions, the closed form of a linear damper.
#include "complete_run.h"

#include "one_impact.h"

#include "contact/law.h"
#include "kept.h"
#include "kernel/force_law.h"

// Speed after one impact over the speed before, the mean over where the steps fall.
static double delivered(const Scenario *scenario, double steps_a_contact)
{
    const OneImpact impact =
        one_impact_run(*scenario, one_impact_duration(scenario) / steps_a_contact);
    assert_true(impact.is_single);
    return impact.restitution;
}

// The table of the one-freedom model: restitution against steps per contact half-period.
static void the_textbook_map_loses_what_the_table_says(void **state)
{
    (void)state;
    const struct {
        double asked;
        double steps;
        double expected;
    } rows[] = {
        {1.0, 1000, 0.995}, {1.0, 300, 0.984}, {1.0, 100, 0.952}, {1.0, 30, 0.853},
        {1.0, 10, 0.646},   {0.9, 100, 0.861}, {0.9, 10, 0.595},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const Scenario scenario = one_impact_linear(ODE_MAP_TEXTBOOK, rows[i].asked);
        assert_near(delivered(&scenario, rows[i].steps), rows[i].expected, 0.01);
    }
}

static void the_corrected_map_keeps_what_is_asked(void **state)
{
    (void)state;
    const double steps[] = {1000, 300, 100, 30, 10, 5};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        const Scenario damped = one_impact_linear(ODE_MAP_CORRECTED, 0.9);
        assert_near(delivered(&damped, steps[i]), 0.9, 0.01);
        // no damping at all: the stand-in damper must not show
        const Scenario elastic = one_impact_linear(ODE_MAP_CORRECTED, 1.0);
        assert_near(delivered(&elastic, steps[i]), 1.0, 0.01);
    }
}

// Hysteretic laws do not deliver what they are asked for; what they deliver is known exactly.
static void each_damping_law_delivers_its_own_restitution(void **state)
{
    (void)state;
    const DampingKind kinds[] = {DAMPING_LANKARANI_NIKRAVESH, DAMPING_HUNT_CROSSLEY, DAMPING_FLORES,
                                 DAMPING_EXACT};
    const double at_half[] = {0.7252, 0.6630, 0.4704, 0.5};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const Scenario scenario = one_impact_hertz(ODE_MAP_CORRECTED, kinds[i], 0.5);
        // first order in the step: at 2000 steps a contact, some 1e-3
        assert_near(delivered(&scenario, 2000.0), at_half[i], 2e-3);
    }
}

// Penetration of a pin that lies still on the wall under its weight.
static double static_depth(Scenario scenario, double weight_n, double guess_m)
{
    scenario.gravity = scenario_downward(weight_n / ONE_IMPACT_MASS);
    scenario.linkage.bodies[0].start.position.y = -(ONE_IMPACT_CLEARANCE + guess_m);
    scenario.run.step = 1e-6;
    scenario.run.samples = 1;
    scenario.run.duration = 0.02;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_ODE);
    const double depth = -trajectory_state(trajectory, trajectory->sample_count - 1, 0)->gap;
    trajectory_destroy(trajectory);
    return depth;
}

static void a_constant_load_presses_as_deep_as_the_law_says(void **state)
{
    (void)state;
    const LawKind laws[] = {LAW_HERTZ_SOCKET, LAW_JOHNSON, LAW_ESDU_78035};
    for (int map = 0; map < 2; map++) {
        Scenario linear = one_impact_linear((OdeMap)map, 1.0);
        const double stiffness = linear.contact.stiffness;
        linear.contact.viscous_coefficient = 2.0 * sqrt(stiffness * ONE_IMPACT_MASS);
        const double weight = 1000.0;
        assert_close(static_depth(linear, weight, 0.5 * weight / stiffness), weight / stiffness,
                     1e-6);
        for (size_t i = 0; i < sizeof laws / sizeof *laws; i++) {
            Scenario scenario = kept_copy(&linear);
            scenario.contact.stiffness = 0.0;
            scenario.contact.law = laws[i];
            ForceLaw law;
            Err err = {ERR_NONE, ""};
            assert_true(law_build(&scenario.contact, &scenario.material,
                                  &scenario.linkage.joints[0].clearance, 0.0, &law, &err));
            const double expected = force_law_penetration(&law, weight);
            scenario.contact.viscous_coefficient = sqrt(ONE_IMPACT_MASS * weight / expected);
            assert_close(static_depth(scenario, weight, 0.9 * expected), expected, 1e-6);
        }
    }
}

// With its control: the depth of a neighbouring exponent is another one.
static void a_power_law_given_as_stiffness_presses_by_that_power(void **state)
{
    (void)state;
    Scenario scenario = one_impact_hertz(ODE_MAP_TEXTBOOK, DAMPING_VISCOUS, 0.9);
    scenario.contact.viscous_coefficient = 5e3;
    const double weight = 500.0;
    const double expected = pow(weight / 6.6e10, 1.0 / 1.5);
    const double depth = static_depth(scenario, weight, 0.9 * expected);
    assert_close(depth, expected, 1e-6);
    assert_true(fabs(depth / pow(weight / 6.6e10, 1.0 / 1.4) - 1.0) > 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_textbook_map_loses_what_the_table_says),
        cmocka_unit_test(the_corrected_map_keeps_what_is_asked),
        cmocka_unit_test(each_damping_law_delivers_its_own_restitution),
        cmocka_unit_test(a_constant_load_presses_as_deep_as_the_law_says),
        cmocka_unit_test(a_power_law_given_as_stiffness_presses_by_that_power),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
