// Do ERP and CFM stand for the spring and damper they were made from, and deliver what is foretold?
#include "close.h"

#include "contact/damping.h"
#include "contact/map.h"

#include <string.h>

// The force of one row, solved for F: v_out = v + h F / m, v separating.
static double row_force(ErpCfm row, double step, double mass, double depth, double closing)
{
    return (row.erp / step * depth + closing) / (row.cfm + step / mass);
}

static void names_are_the_words_of_a_case(void **state)
{
    (void)state;
    for (int kind = ODE_MAP_TEXTBOOK; kind <= ODE_MAP_CORRECTED; kind++) {
        assert_string_equal(map_get((OdeMap)kind)->name, OPTIONS_ODE_MAPS[kind]);
        assert_true(strlen(map_get((OdeMap)kind)->summary) > 0);
    }
    assert_null(OPTIONS_ODE_MAPS[ODE_MAP_CORRECTED + 1]);
}

static void the_textbook_map_is_inverted_exactly(void **state)
{
    (void)state;
    for (double damping = 0.0; damping < 2e4; damping = 10.0 * damping + 1.0) {
        const ErpCfm row = map_get(ODE_MAP_TEXTBOOK)->convert(3e8, damping, 1e-6);
        double k;
        double c;
        map_invert(row, 1e-6, &k, &c);
        assert_close(k, 3e8, 1e-12);
        assert_near(c, damping, 1e-9 * (damping + 300.0)); // 1 - ERP loses digits where c << h k
    }
    // control: the corrected map read as implicit Euler is another damper
    double k;
    double c;
    map_invert(map_get(ODE_MAP_CORRECTED)->convert(3e8, 100.0, 1e-6), 1e-6, &k, &c);
    assert_close(k, 3e8, 1e-12);
    assert_close(c, 100.0 - 300.0, 1e-12);
}

static void each_map_makes_the_row_the_force_it_says(void **state)
{
    (void)state;
    const double h = 2e-6;
    const double m = 0.15;
    const double k = 4e8;
    const double c = 500.0;
    const double d = 3e-7;
    const double closing = 0.2;
    // textbook: the force at the end of the step
    double force = row_force(map_get(ODE_MAP_TEXTBOOK)->convert(k, c, h), h, m, d, closing);
    double out = -closing + h * force / m;
    assert_close(force, k * (d - h * out) - c * out, 1e-12);
    // corrected: the spring at the start, the damper at the end
    force = row_force(map_get(ODE_MAP_CORRECTED)->convert(k, c, h), h, m, d, closing);
    out = -closing + h * force / m;
    assert_close(force, k * d - c * out, 1e-12);
}

static void the_stand_in_damper_changes_the_force_by_less_than_a_billionth(void **state)
{
    (void)state;
    const Map *map = map_get(ODE_MAP_CORRECTED);
    assert_true(map->stand_in_share > 0.0 && map->stand_in_share < 1e-9);
    const double m = 0.15;
    const double k = 4e8;
    for (double h = 1e-7; h < 2e-5; h *= 2.0) {
        // from the first step of a contact, moved on by a tenth of a step, to its depth
        for (double share = 0.1; share < 100.0; share *= 3.0) {
            const double d = share * 0.2 * h;
            const double force = row_force(map->convert(k, 0.0, h), h, m, d, 0.2);
            const double out = fabs(-0.2 + h * force / m);
            assert_close(force, k * d, 1e-9 * fmax(1.0, out / 0.2));
        }
    }
}

static void the_predicted_restitution_is_the_known_one(void **state)
{
    (void)state;
    // c = 0, restitution 1 asked: what the textbook map delivers at Tc / h steps to a contact
    static const double STEPS[] = {1000.0, 300.0, 100.0, 30.0, 10.0};
    static const double TEXTBOOK[] = {0.995, 0.984, 0.952, 0.853, 0.646};
    const double pi = acos(-1.0);
    for (int i = 0; i < 5; i++) {
        const double h = pi / STEPS[i]; // omega = 1: the contact lasts pi
        const double textbook = map_delivered_restitution(map_get(ODE_MAP_TEXTBOOK), 1, 1, 0, h);
        const double corrected = map_delivered_restitution(map_get(ODE_MAP_CORRECTED), 1, 1, 0, h);
        assert_near(textbook, TEXTBOOK[i], 6e-4);
        assert_near(corrected, 1.0, 1e-3);
    }
}

static void a_restitution_of_nine_tenths_survives_only_the_corrected_map(void **state)
{
    (void)state;
    const double pi = acos(-1.0);
    const double zeta = damping_linear_ratio(0.9);
    const Map *textbook = map_get(ODE_MAP_TEXTBOOK);
    const Map *corrected = map_get(ODE_MAP_CORRECTED);
    const double damped = pi / sqrt(1.0 - zeta * zeta);
    // the accident of where the steps fall is worth 0.003 at 100 steps, 0.07 at 10
    assert_near(map_delivered_restitution(textbook, 1, 1, 2 * zeta, damped / 100), 0.861, 3e-3);
    assert_near(map_delivered_restitution(textbook, 1, 1, 2 * zeta, damped / 10), 0.595, 3e-3);
    for (double steps = 5.0; steps < 2000.0; steps *= 2.0) {
        const double e = map_delivered_restitution(corrected, 1, 1, 2 * zeta, damped / steps);
        assert_true(e > 0.8985 && e < 0.905);
    }
    // both converge to what was asked
    assert_near(map_delivered_restitution(textbook, 1, 1, 2 * zeta, damped / 1e5), 0.9, 1e-4);
    assert_near(map_delivered_restitution(corrected, 1, 1, 2 * zeta, damped / 1e5), 0.9, 1e-5);
}

static void mass_and_stiffness_enter_only_through_omega(void **state)
{
    (void)state;
    const Map *map = map_get(ODE_MAP_TEXTBOOK);
    const double here = map_delivered_restitution(map, 0.1, 1e9, 50.0, 1e-6);
    const double scaled = map_delivered_restitution(map, 0.2, 2e9, 100.0, 1e-6);
    assert_close(here, scaled, 1e-12);
}

static void one_impact_has_the_force_and_depth_of_its_closed_form(void **state)
{
    (void)state;
    const double m = 0.1;
    const double k = 1e9;
    const double omega = sqrt(k / m);
    const MapImpact impact = map_impact(map_get(ODE_MAP_CORRECTED), m, k, 0, 1e-9, 0.3, 0.5);
    assert_close(impact.penetration_max, 0.3 / omega, 1e-4);
    assert_close(impact.force_max, 0.3 * sqrt(k * m), 1e-4);
    assert_close(impact.steps * 1e-9, acos(-1.0) / omega, 1e-3);
}

static void the_corrected_map_is_stable_up_to_omega_h_2_and_no_further(void **state)
{
    (void)state;
    const Map *map = map_get(ODE_MAP_CORRECTED);
    assert_near(map->stability_limit, 2.0, 0.0);
    assert_true(isinf(map_get(ODE_MAP_TEXTBOOK)->stability_limit));
    // beyond it a touch that begins with the deepest overlap throws the pin out faster than it came
    assert_true(map_impact(map, 1, 1, 0, 1.9, 1.0, 1.0).restitution < 1.9 * 1.9);
    assert_true(map_impact(map, 1, 1, 0, 2.5, 1.0, 1.0).restitution > 4.0);
}

static void bounce_beside_a_cfm_delivers_less(void **state)
{
    (void)state;
    // ODE's own row with a bounce: v_out + CFM F = e v_in, v_out = -v_in + h F / m
    const double m = 0.3;
    const double h = 1e-5;
    const double cfm = 4e-6;
    const double force = (0.8 + 1.0) / (cfm + h / m);
    const double out = -1.0 + h * force / m;
    assert_close(map_bounce_delivered(0.8, cfm, m, h), out, 1e-12);
    assert_near(map_bounce_delivered(0.8, 0.0, m, h), 0.8, 0.0);
    assert_true(map_bounce_delivered(0.0, cfm, m, h) < 0.0);
}

static void a_penalty_is_the_inverse_of_a_cfm(void **state)
{
    (void)state;
    assert_close(map_poisson_cfm(973330.0), 1.0 / 973330.0, 1e-15);
    assert_near(map_poisson_cfm(INFINITY), 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_the_words_of_a_case),
        cmocka_unit_test(the_textbook_map_is_inverted_exactly),
        cmocka_unit_test(each_map_makes_the_row_the_force_it_says),
        cmocka_unit_test(the_stand_in_damper_changes_the_force_by_less_than_a_billionth),
        cmocka_unit_test(the_predicted_restitution_is_the_known_one),
        cmocka_unit_test(a_restitution_of_nine_tenths_survives_only_the_corrected_map),
        cmocka_unit_test(mass_and_stiffness_enter_only_through_omega),
        cmocka_unit_test(one_impact_has_the_force_and_depth_of_its_closed_form),
        cmocka_unit_test(the_corrected_map_is_stable_up_to_omega_h_2_and_no_further),
        cmocka_unit_test(bounce_beside_a_cfm_delivers_less),
        cmocka_unit_test(a_penalty_is_the_inverse_of_a_cfm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
