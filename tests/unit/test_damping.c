// Do the damping laws deliver what their formulas say, seen by integrating one impact?
#include "close.h"

#include "contact/damping.h"
#include "kernel/force_law.h"

typedef struct Impact {
    double restitution;
    double depth_max; // m
} Impact;

typedef struct State {
    double depth; // m
    double rate;  // m/s
} State;

static State derivative(const ForceLaw *law, double mass, double speed, State s)
{
    return (State){s.rate, -force_law_force(law, s.depth, s.rate, speed) / mass};
}

// One impact by the classical Runge-Kutta method, in so many steps of the duration given.
static Impact integrate(const ForceLaw *law, double mass, double speed, double step)
{
    State s = {1e-30, speed}; // inside, so that a damper acts from the first stage on
    Impact impact = {0};
    while (s.depth >= 0.0) {
        const State a = derivative(law, mass, speed, s);
        const State sb = {s.depth + 0.5 * step * a.depth, s.rate + 0.5 * step * a.rate};
        const State b = derivative(law, mass, speed, sb);
        const State sc = {s.depth + 0.5 * step * b.depth, s.rate + 0.5 * step * b.rate};
        const State c = derivative(law, mass, speed, sc);
        const State sd = {s.depth + step * c.depth, s.rate + step * c.rate};
        const State d = derivative(law, mass, speed, sd);
        s.depth += step / 6.0 * (a.depth + 2.0 * b.depth + 2.0 * c.depth + d.depth);
        s.rate += step / 6.0 * (a.rate + 2.0 * b.rate + 2.0 * c.rate + d.rate);
        impact.depth_max = fmax(impact.depth_max, s.depth);
    }
    impact.restitution = -s.rate / speed;
    return impact;
}

static void delivered_restitutions_are_the_published_ones(void **state)
{
    (void)state;
    // rows .9 .7 .5 .3 .1; Lankarani-Nikravesh, Hunt-Crossley, Flores, Gonthier, Hu-Guo
    static const double ASKED[] = {0.9, 0.7, 0.5, 0.3, 0.1};
    static const double DELIVERED[5][5] = {
        {0.9132, 0.9090, 0.8939, 0.8764, 0.8999}, {0.7960, 0.7680, 0.6832, 0.6696, 0.6973},
        {0.7252, 0.6630, 0.4704, 0.4877, 0.4877}, {0.6842, 0.5813, 0.2562, 0.3042, 0.2707},
        {0.6653, 0.5158, 0.0694, 0.1010, 0.0741},
    };
    static const DampingKind KINDS[] = {DAMPING_LANKARANI_NIKRAVESH, DAMPING_HUNT_CROSSLEY,
                                        DAMPING_FLORES, DAMPING_GONTHIER, DAMPING_HU_GUO};
    static const double EXACT[] = {0.166482, 0.634828, 1.432751, 3.087082, 9.998159};
    for (int row = 0; row < 5; row++) {
        for (int i = 0; i < 5; i++) {
            const double chi = damping_factor(KINDS[i], ASKED[row]);
            assert_near(damping_delivered(chi), DELIVERED[row][i], 5.1e-5);
        }
        assert_near(damping_factor(DAMPING_EXACT, ASKED[row]), EXACT[row], 5.1e-7);
    }
}

static void an_integrated_impact_gives_back_the_delivered_restitution(void **state)
{
    (void)state;
    // mass, stiffness, exponent and speed must not matter
    static const double CASES[][4] = {{0.1, 2e11, 1.5, 0.3}, {3.0, 1e6, 1.0, 2.0}};
    static const double CHI[] = {0.05, 0.6, 3.0, 20.0};
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 4; j++) {
            ForceLaw law = force_law_power(CASES[i][1], CASES[i][2]);
            law.hysteresis = CHI[j];
            const double mass = CASES[i][0];
            const double speed = CASES[i][3];
            const double deep = damping_depth_max(law.stiffness, law.exponent, 0.0, mass, speed);
            // the last steps creep out at a small share of the speed, so the step is small
            const Impact impact = integrate(&law, mass, speed, 2e-5 * deep / speed);
            assert_close(impact.restitution, damping_delivered(CHI[j]), 2e-4);
            const double expected =
                damping_depth_max(law.stiffness, law.exponent, CHI[j], mass, speed);
            assert_close(impact.depth_max, expected, 1e-7);
        }
    }
}

static void the_exact_factor_delivers_what_is_asked(void **state)
{
    (void)state;
    for (double e = 0.04; e < 1.0; e += 0.003) {
        assert_close(damping_delivered(damping_factor(DAMPING_EXACT, e)), e, 1e-11);
    }
    for (double loss = 1e-15; loss < 0.1; loss *= 7.0) {
        const double chi = damping_factor(DAMPING_EXACT, 1.0 - loss);
        // near 1 every law of the family has chi = 3 (1 - e) / 2
        assert_close(chi, 1.5 * loss, 1e-15 / loss + 2.0 * loss);
        assert_near(damping_delivered(chi), 1.0 - loss, 1e-15);
    }
    // control: no other law does
    assert_true(fabs(damping_delivered(damping_factor(DAMPING_LANKARANI_NIKRAVESH, 0.5)) - 0.5) >
                0.2);
    // where e is small the factor is 1/e to the last digits
    assert_close(damping_factor(DAMPING_EXACT, 1e-3), 1e3, 1e-12);
    assert_close(damping_delivered(1e3), 1e-3, 1e-12);
}

static void every_law_gives_no_damping_for_restitution_1(void **state)
{
    (void)state;
    for (int kind = DAMPING_NONE; kind < DAMPING_COUNT; kind++) {
        assert_near(damping_factor((DampingKind)kind, 1.0), 0.0, 0.0);
    }
    assert_near(damping_delivered(0.0), 1.0, 0.0);
    assert_null(OPTIONS_DAMPINGS[DAMPING_COUNT]);
}

static void two_steel_spheres_meet_as_hertz_says(void **state)
{
    (void)state;
    // two spheres of 10 mm radius, 7800 kg/m^3, at 1 m/s: K = 4/3 E* sqrt(R/2), m half of one
    const double pi = acos(-1.0);
    const double e_star = 2.07e11 / (2.0 * (1.0 - 0.29 * 0.29));
    const double mass = 0.5 * 7800.0 * 4.0 / 3.0 * pi * 1e-6;
    const ForceLaw law = force_law_power(4.0 / 3.0 * e_star * sqrt(5e-3), 1.5);
    const double deep = damping_depth_max(law.stiffness, 1.5, 0.0, mass, 1.0);
    assert_close(deep, pow(5.0 * mass / (4.0 * law.stiffness), 0.4), 1e-14);
    assert_near(deep * 1e6, 20.5598, 1e-4);
    assert_near(force_law_elastic(&law, deep), 993.2175, 1e-3);
}

static void a_clamped_spring_and_damper_gives_back_its_closed_form(void **state)
{
    (void)state;
    const double mass = 0.2;
    const double stiffness = 1e7;
    const double period = sqrt(mass / stiffness);
    static const double RATIOS[] = {0.0, 0.05, 0.4, 0.9, 1.0, 1.5, 4.0};
    for (int i = 0; i < 7; i++) {
        ForceLaw law = force_law_power(stiffness, 1.0);
        law.viscous = 2.0 * RATIOS[i] * sqrt(stiffness * mass);
        const Impact impact = integrate(&law, mass, 1.0, 2e-5 * period);
        assert_close(damping_linear_restitution(RATIOS[i]), impact.restitution, 2e-6);
        const double e = damping_linear_restitution(RATIOS[i]);
        assert_near(damping_linear_ratio(e), RATIOS[i], 1e-9);
    }
    assert_close(damping_linear_restitution(1.0), exp(-2.0), 1e-15);
    // control: without the clamp the first zero of the penetration gives another number
    const double z = 0.4;
    const double unclamped = exp(-acos(-1.0) * z / sqrt(1.0 - z * z));
    assert_true(fabs(damping_linear_restitution(z) - unclamped) > 0.05);
    // the two branches meet without a step, and the far end is 1 / (4 z^2)
    assert_close(damping_linear_restitution(1.0 - 1e-9), damping_linear_restitution(1.0 + 1e-9),
                 1e-8);
    assert_close(damping_linear_restitution(1e4), 0.25e-8, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(delivered_restitutions_are_the_published_ones),
        cmocka_unit_test(an_integrated_impact_gives_back_the_delivered_restitution),
        cmocka_unit_test(the_exact_factor_delivers_what_is_asked),
        cmocka_unit_test(every_law_gives_no_damping_for_restitution_1),
        cmocka_unit_test(two_steel_spheres_meet_as_hertz_says),
        cmocka_unit_test(a_clamped_spring_and_damper_gives_back_its_closed_form),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
