// What does an impact on ODE's row give, and what on the law itself?
#include "close.h"

#include "contact/damping.h"
#include "contact/map_impact.h"

static MapImpact one_impact(OdeMap map, ForceLaw law, double mass, double speed, double step)
{
    const MapImpactCase impact = {
        .law = law, .mass = mass, .speed = speed, .step = step, .rows = {.map = map_get(map)}};
    return map_impact(&impact, 0.5);
}

static MapImpact law_impact(ForceLaw law, double mass, double speed)
{
    const MapImpactCase impact = {.law = law, .mass = mass, .speed = speed};
    return map_impact_law(&impact);
}

// F = K d^n (1 + chi d'/v): restitution and depth have closed forms, whatever n.
static void a_hysteretic_law_gives_back_what_its_closed_form_says(void **state)
{
    (void)state;
    static const double CHI[] = {0.0, 0.05, 0.5, 2.0, 15.0};
    static const double EXPONENT[] = {1.0, 1.5, 2.0};
    for (size_t i = 0; i < sizeof CHI / sizeof *CHI; i++) {
        for (size_t k = 0; k < sizeof EXPONENT / sizeof *EXPONENT; k++) {
            ForceLaw law = force_law_power(3e9, EXPONENT[k]);
            law.hysteresis = CHI[i];
            const MapImpact impact = law_impact(law, 0.2, 0.4);
            assert_true(impact.is_ended);
            assert_close(impact.restitution, damping_delivered(CHI[i]), 1e-7);
            assert_close(impact.penetration_max,
                         damping_depth_max(3e9, EXPONENT[k], CHI[i], 0.2, 0.4), 1e-7);
            // control: a law a hundredth stiffer goes less deep
            law.stiffness *= 1.01;
            assert_true(law_impact(law, 0.2, 0.4).penetration_max <
                        (1.0 - 1e-3) * impact.penetration_max);
        }
    }
}

// Force clamped at zero: exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)), and its continuation.
static void a_linear_damper_gives_back_what_its_closed_form_says(void **state)
{
    (void)state;
    for (double zeta = 0.0; zeta < 4.0; zeta = 1.5 * zeta + 0.01) {
        const double k = 1e7;
        const double m = 0.1;
        const MapImpact impact = law_impact(map_impact_linear(k, 2.0 * zeta * sqrt(k * m)), m, 0.5);
        assert_close(impact.restitution, damping_linear_restitution(zeta), 1e-6);
        if (zeta > 0.0 && zeta < 0.5) {
            const double phase = (3.0 * acos(zeta) - acos(-1.0)) / sqrt(1.0 - zeta * zeta);
            assert_close(impact.force_max, 0.5 * sqrt(k * m) * exp(-zeta * phase), 1e-6);
        }
        if (zeta > 0.5) {
            // the damper's first blow is the largest force
            assert_close(impact.force_max, 2.0 * zeta * sqrt(k * m) * 0.5, 1e-6);
        }
    }
}

// Two 10 mm steel spheres at 1 m/s, as in the field's texts.
static void hertzs_impact_is_the_textbooks(void **state)
{
    (void)state;
    const double depth = 20.5598e-6;
    const double mass =
        7800.0 * 4.0 / 3.0 * acos(-1.0) * 1e-6 / 2.0; // one of two alike, radius 1 cm
    const double stiffness = 5.0 * mass / (4.0 * pow(depth, 2.5));
    const MapImpact impact = law_impact(force_law_power(stiffness, 1.5), mass, 1.0);
    assert_close(impact.penetration_max, depth, 1e-6);
    assert_close(impact.duration, 60.5131e-6, 1e-5);
    assert_close(impact.duration, 2.943275 * depth, 1e-6);
    assert_close(impact.force_max, stiffness * pow(depth, 1.5), 1e-6);
}

// The recurrence on Hertz's law goes to the law itself: first order for the textbook's.
static void every_map_goes_to_the_law_as_the_step_goes_to_nothing(void **state)
{
    (void)state;
    ForceLaw law = force_law_power(6.6e10, 1.5);
    law.hysteresis = damping_factor(DAMPING_FLORES, 0.7);
    const MapImpact asked = law_impact(law, 0.1, 0.5);
    static const double ORDER[] = {1.0, 1.0, 2.0, 2.0};
    for (int kind = ODE_MAP_TEXTBOOK; kind < ODE_MAP_IMPULSE; kind++) {
        const double coarse = asked.duration / 200.0;
        const double off = one_impact((OdeMap)kind, law, 0.1, 0.5, coarse).force_max;
        const double fine = one_impact((OdeMap)kind, law, 0.1, 0.5, coarse / 16.0).force_max;
        const double fall = fabs(fine - asked.force_max) / fabs(off - asked.force_max);
        assert_true(fall < 2.0 * pow(16.0, -ORDER[kind]));
    }
}

// A logarithmic law has no closed form: energy tells how deep it goes without damping.
static void a_logarithmic_law_takes_up_the_energy_of_the_impact(void **state)
{
    (void)state;
    const ForceLaw law = force_law_logarithmic(1e-10, 25.0);
    const MapImpact impact = law_impact(law, 0.2, 0.3);
    assert_close(force_law_energy(&law, impact.penetration_max), 0.5 * 0.2 * 0.3 * 0.3, 1e-6);
    assert_close(impact.restitution, 1.0, 1e-6);
    // more than it can take is no impact of it
    assert_false(law_impact(law, 1e6, 300.0).is_ended);
}

static void velocity_level_rows_bounce_as_their_closed_form_says(void **state)
{
    (void)state;
    MapImpactCase impact = {.mass = 0.16, .speed = 0.1, .step = 1e-5};
    impact.rows = (MapImpactRows){.cfm = 1.0 / 973330.0, .push_out = 0.2, .restitution = 0.9};
    const double expected = map_bounce_delivered(0.9, impact.rows.cfm, 0.16, 1e-5);
    const MapImpact one = map_impact(&impact, 0.5);
    assert_close(one.restitution, expected, 1e-12);
    // what is too slow does not bounce
    impact.rows.bounce_speed = 0.2;
    assert_true(map_impact(&impact, 0.5).restitution < 0.5);
}

// The corrected map without the engine's guard.
static ErpCfm explicit_spring(const MapContact *contact)
{
    return map_get(ODE_MAP_CORRECTED)->convert(contact);
}

static const Map WITHOUT_LIMIT = {.stability_limit = INFINITY, .convert = explicit_spring};

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

static void the_new_maps_deliver_the_law_down_to_ten_steps_a_contact(void **state)
{
    (void)state;
    static const OdeMap KINDS[] = {ODE_MAP_MIDPOINT, ODE_MAP_EXACT};
    static const double ASKED[] = {1.0, 0.9, 0.7, 0.5};
    const double pi = acos(-1.0);
    for (size_t i = 0; i < sizeof ASKED / sizeof *ASKED; i++) {
        const double zeta = damping_linear_ratio(ASKED[i]);
        const double contact = pi / sqrt(1.0 - zeta * zeta);
        for (double steps = 1000.0; steps >= 10.0; steps /= 10.0) {
            const double h = contact / steps;
            for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS; k++) {
                const Map *map = map_get(KINDS[k]);
                const double e = map_delivered_restitution(map, 1, 1, 2 * zeta, h);
                assert_close(e, ASKED[i], 0.01);
            }
        }
        // control: the textbook map loses more than a sixth at ten steps
        assert_true(map_delivered_restitution(map_get(ODE_MAP_TEXTBOOK), 1, 1, 2 * zeta,
                                              0.1 * contact) < 0.85 * ASKED[i]);
    }
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
    const MapImpact impact = one_impact(ODE_MAP_CORRECTED, map_impact_linear(k, 0.0), m, 0.3, 1e-9);
    assert_close(impact.penetration_max, 0.3 / omega, 1e-4);
    assert_close(impact.force_max, 0.3 * sqrt(k * m), 1e-4);
    assert_close(impact.duration, acos(-1.0) / omega, 1e-3);
}

static void beyond_its_limit_a_map_throws_the_pin_out_faster_than_it_came(void **state)
{
    (void)state;
    // a touch that begins with the deepest overlap
    MapImpactCase impact = {
        .law = map_impact_linear(1.0, 0.0), .mass = 1.0, .speed = 1.0, .step = 1.9};
    impact.rows.map = &WITHOUT_LIMIT;
    assert_true(map_impact(&impact, 1.0).restitution < 1.9 * 1.9);
    impact.step = 2.5;
    assert_true(map_impact(&impact, 1.0).restitution > 4.0);
    // in the engine the textbook's row stands in there
    impact.rows.map = map_get(ODE_MAP_CORRECTED);
    const MapImpact safe = map_impact(&impact, 1.0);
    assert_int_equal(safe.fallbacks, safe.steps);
    assert_true(safe.restitution < 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hysteretic_law_gives_back_what_its_closed_form_says),
        cmocka_unit_test(a_linear_damper_gives_back_what_its_closed_form_says),
        cmocka_unit_test(hertzs_impact_is_the_textbooks),
        cmocka_unit_test(every_map_goes_to_the_law_as_the_step_goes_to_nothing),
        cmocka_unit_test(a_logarithmic_law_takes_up_the_energy_of_the_impact),
        cmocka_unit_test(velocity_level_rows_bounce_as_their_closed_form_says),
        cmocka_unit_test(the_predicted_restitution_is_the_known_one),
        cmocka_unit_test(a_restitution_of_nine_tenths_survives_only_the_corrected_map),
        cmocka_unit_test(the_new_maps_deliver_the_law_down_to_ten_steps_a_contact),
        cmocka_unit_test(mass_and_stiffness_enter_only_through_omega),
        cmocka_unit_test(one_impact_has_the_force_and_depth_of_its_closed_form),
        cmocka_unit_test(beyond_its_limit_a_map_throws_the_pin_out_faster_than_it_came),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
