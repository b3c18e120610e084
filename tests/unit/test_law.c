// Do the laws give the numbers their books give, under the names a case uses?
#include "close.h"

#include "contact/damping.h"
#include "contact/law.h"
#include "contact/map_impact.h"

#include <string.h>

// the paper's joint: hole 10.015, pin 9.986, width 13 mm, steel, at its force of 1.05 N
static const ContactPair PAPER_PAIR = {
    .hole_radius = 5.0075e-3,
    .pin_radius = 4.993e-3,
    .width = 13e-3,
    .youngs_modulus = 2.07e11,
    .poisson_ratio = 0.29,
    .reference_force = 1.05,
};

static ForceLaw paper_law(LawKind kind)
{
    ForceLaw law = {0};
    Err err = {0};
    assert_true(law_make(kind, &PAPER_PAIR, &law, &err));
    return law;
}

static void the_socket_has_the_stiffness_of_the_papers_equation_3(void **state)
{
    (void)state;
    const ForceLaw law = paper_law(LAW_HERTZ_SOCKET);
    const double pi = acos(-1.0);
    const double sigma = (1.0 - 0.29 * 0.29) / (pi * 2.07e11);
    const double r1 = 5.0075e-3;
    const double r2 = 4.993e-3;
    const double k = 4.0 / (3.0 * pi * 2.0 * sigma) * sqrt(r1 * r2 / (r1 - r2));
    assert_close(law.stiffness, k, 1e-12);
    assert_close(law.stiffness, 1.978e11, 5e-4);
    assert_near(law.exponent, 1.5, 0.0);
    // control: two spheres side by side, with the plus, are far softer
    assert_true(k > 10.0 * 4.0 / (3.0 * pi * 2.0 * sigma) * sqrt(r1 * r2 / (r1 + r2)));
}

static void approach_and_stiffness_at_the_papers_force_are_the_known_ones(void **state)
{
    (void)state;
    // micron and N/m, computed once by hand from the books' formulas, to the digits given
    static const double EXPECTED[LAW_COUNT][2] = {
        [LAW_HERTZ_SOCKET] = {0.0305, 5.2e7},
        [LAW_JOHNSON] = {0.0026, 4.4e8},
        [LAW_RADZIMOVSKY] = {0.0027, 4.3e8},
        [LAW_ESDU_78035] = {0.0031, 3.7e8},
        [LAW_DUBOWSKY_FREUDENSTEIN] = {0.0032, 3.6e8},
        [LAW_PAPER_TABLE_2] = {0.0453, 2.3e7},
        [LAW_PAPER_TABLE_3] = {0.194, 8.1e6},
        [LAW_ELASTIC] = {0.00245, 4.73e8},
        [LAW_AUTO] = {0.00245, 4.73e8},
    };
    for (int i = 0; i < LAW_COUNT; i++) {
        if (EXPECTED[i][0] == 0.0) {
            fail_msg("EXPECTED lacks the law %s: add its approach, um, and tangent stiffness, N/m, "
                     "at 1.05 N, computed by hand",
                     OPTIONS_LAWS[i]);
        }
        const ForceLaw law = paper_law((LawKind)i);
        const double d = force_law_penetration(&law, 1.05);
        assert_near(d * 1e6, EXPECTED[i][0], 1.5e-4);
        assert_close(force_law_tangent(&law, d), EXPECTED[i][1], 0.02);
    }
}

static void the_cylinder_laws_satisfy_their_books_formulas(void **state)
{
    (void)state;
    const double pi = acos(-1.0);
    const double e_star = 2.07e11 / (2.0 * (1.0 - 0.29 * 0.29));
    const double s = 1.0 / (pi * e_star);
    const double length = 13e-3;
    const double ri = 5.0075e-3;
    const double rj = 4.993e-3;
    const double dr = ri - rj;
    for (double force = 1e-3; force < 3e3; force *= 10.0) {
        const double b = 2.15 * sqrt(force * ri * rj / dr / (e_star * length));
        const double logs = log(4.0 * ri / b) + log(4.0 * rj / b);
        // the four formulas as printed, in the order of the kinds
        const double johnson =
            force / (pi * length * e_star) * (log(4.0 * pi * length * e_star * dr / force) - 1.0);
        const double radzimovsky = force / (pi * e_star * length) * (2.0 / 3.0 + logs);
        const double esdu = force * s / length * (log(4.0 * length * dr / (force * s)) + 1.0);
        const double dubowsky =
            force * s / length * (log(length * length * length * dr / (force * ri * rj * s)) + 1.0);
        const double printed[] = {johnson, radzimovsky, esdu, dubowsky};
        const LawKind kinds[] = {LAW_JOHNSON, LAW_RADZIMOVSKY, LAW_ESDU_78035,
                                 LAW_DUBOWSKY_FREUDENSTEIN};
        for (int i = 0; i < 4; i++) {
            const ForceLaw law = paper_law(kinds[i]);
            assert_close(force_law_penetration(&law, force), printed[i], 1e-12);
            assert_close(force_law_elastic(&law, printed[i]), force, 1e-12);
        }
    }
}

static void johnson_gives_the_known_approach_at_the_real_pin_force(void **state)
{
    (void)state;
    const ForceLaw law = paper_law(LAW_JOHNSON);
    const double d = force_law_penetration(&law, 1505.0);
    assert_near(d * 1e6, 1.36, 5e-3);
    assert_close(force_law_tangent(&law, d), 1.45e9, 5e-3);
}

static void a_pair_out_of_range_is_refused(void **state)
{
    (void)state;
    ForceLaw law = {.stiffness = -7.0};
    ContactPair pair = PAPER_PAIR;
    pair.width = 0.0;
    Err err = {0};
    assert_false(law_make(LAW_JOHNSON, &pair, &law, &err));
    assert_int_equal(err.kind, ERR_CASE);
    assert_string_equal(err.text, "the contact law johnson needs the width of the joint");
    assert_true(law_make(LAW_HERTZ_SOCKET, &pair, &law, &err));

    law.stiffness = -7.0;
    pair = PAPER_PAIR;
    pair.pin_radius = pair.hole_radius;
    assert_false(law_make(LAW_HERTZ_SOCKET, &pair, &law, &(Err){0}));
    pair = PAPER_PAIR;
    pair.youngs_modulus = NAN;
    assert_false(law_make(LAW_HERTZ_SOCKET, &pair, &law, &(Err){0}));
    pair = PAPER_PAIR;
    pair.reference_force = 0.0;
    assert_false(law_make(LAW_PAPER_TABLE_2, &pair, &law, &(Err){0}));
    assert_near(law.stiffness, -7.0, 0.0); // untouched
}

static void the_options_make_the_whole_law(void **state)
{
    (void)state;
    const Clearance clearance = {.hole_radius = 5.0075e-3, .pin_radius = 4.993e-3, .width = 13e-3};
    const MaterialOptions steel = material_options_default();
    ContactOptions contact = contact_options_default();
    contact.law = LAW_HERTZ_SOCKET;
    contact.impact_speed_floor = 2e-3;
    contact.damping = DAMPING_LANKARANI_NIKRAVESH;
    ForceLaw law;
    Err err = {0};

    assert_true(law_build(&contact, &steel, &clearance, 0.0, &law, &err));
    assert_close(law.stiffness, 1.978e11, 5e-4);
    assert_close(law.hysteresis, 0.75 * (1.0 - 0.81), 1e-14);
    assert_near(law.impact_speed_floor, 2e-3, 0.0);

    contact.stiffness = 6.6e10;
    contact.exponent = 1.5;
    contact.damping = DAMPING_VISCOUS;
    contact.viscous_coefficient = 12.0;
    assert_true(law_build(&contact, &steel, &clearance, 0.0, &law, &err));
    assert_near(law.stiffness, 6.6e10, 0.0);
    assert_near(law.hysteresis, 0.0, 0.0);
    assert_near(law.viscous, 12.0, 0.0);

    // the law whose stiffness depends on a load takes it at the driver's speed, either way round
    contact.stiffness = 0.0;
    contact.law = LAW_PAPER_TABLE_2;
    const double thousand_rpm = 1000.0 / 30.0 * acos(-1.0);
    ForceLaw faster;
    assert_true(law_build(&contact, &steel, &clearance, 0.0, &law, &err));
    assert_true(law_build(&contact, &steel, &clearance, -2.0 * thousand_rpm, &faster, &err));
    assert_close(faster.stiffness, 2.0 * law.stiffness, 1e-14);

    contact.law = LAW_JOHNSON;
    const Clearance thin = {.hole_radius = 5e-3, .pin_radius = 4.9e-3};
    assert_false(law_build(&contact, &steel, &thin, 0.0, &law, &err));
}

// Adams' IMPACT, 1e5 N/mm^2.2 with 10 N s/mm from a depth of full damping on: its force at half of
// that depth by hand, its slopes by differences, and the impact of 1 kg at 1 m/s.
static void a_damping_that_grows_is_half_of_itself_at_half_the_depth(void **state)
{
    (void)state;
    const Clearance clearance = {.hole_radius = 1.0, .pin_radius = 0.9};
    const MaterialOptions steel = material_options_default();
    ContactOptions contact = contact_options_default();
    ForceLaw law;
    Err err = {0};
    contact.stiffness = 1e5 * pow(1e3, 2.2);
    contact.exponent = 2.2;
    contact.damping = DAMPING_STEP;
    contact.viscous_coefficient = 1e4;
    contact.full_damping_depth = 1e-4;
    assert_true(law_build(&contact, &steel, &clearance, 0.0, &law, &err));
    assert_near(law.hysteresis, 0.0, 0.0);
    assert_near(law.resting_speed, 0.0, 0.0);
    assert_close(force_law_force(&law, 5e-5, 0.3, 1.0), 1e5 * pow(0.05, 2.2) + 0.5 * 1e4 * 0.3,
                 1e-13);
    assert_near(force_law_viscous(&law, 0.0), 0.0, 0.0);
    assert_near(force_law_viscous(&law, -1e-5), 0.0, 0.0);
    assert_near(force_law_viscous(&law, 1e-4), 1e4, 0.0);
    assert_near(force_law_viscous(&law, 1.0), 1e4, 0.0);
    for (double depth = 1e-5; depth < 2e-4; depth += 1e-5) {
        const double way = 1e-10;
        const double slope =
            0.5 * (force_law_viscous(&law, depth + way) - force_law_viscous(&law, depth - way)) /
            way;
        assert_near(force_law_viscous_slope(&law, depth), slope, 1e-5 * 1e4 / 1e-4);
    }
    // a wall that leaves faster than the spring follows does not pull
    assert_near(force_law_force(&law, 1e-4, -100.0, 1.0), 0.0, 0.0);
    assert_false(force_law_is_linear(&law));
    static const struct {
        double full_m;
        double force_N;
        double restitution;
    } GIVEN[] = {{1e-4, 6495.6, 0.0874}, {1e-3, 5167.0, 0.798}};
    for (size_t i = 0; i < sizeof GIVEN / sizeof *GIVEN; i++) {
        law.full_damping_depth = GIVEN[i].full_m;
        const MapImpactCase impact = {.law = law, .mass = 1.0, .speed = 1.0};
        const MapImpact made = map_impact_law(&impact);
        assert_close(made.force_max, GIVEN[i].force_N, 1e-4);
        assert_near(made.restitution, GIVEN[i].restitution, 2e-4);
    }
}

// What the material dissipates grows with the speed of the impact, whatever came before: from the
// law itself, integrated. The control, a law with a memory, gives back the same at every speed.
static void a_dissipating_law_gives_back_less_the_faster(void **state)
{
    (void)state;
    const Clearance clearance = {.hole_radius = 5.0075e-3, .pin_radius = 4.993e-3, .width = 13e-3};
    const MaterialOptions steel = material_options_default();
    ContactOptions contact = contact_options_default();
    ForceLaw with_memory;
    ForceLaw law;
    Err err = {0};
    assert_true(law_build(&contact, &steel, &clearance, 0.0, &with_memory, &err));
    contact.damping = DAMPING_DISSIPATION;
    assert_true(law_build(&contact, &steel, &clearance, 0.0, &law, &err));
    const double dissipation = law_dissipation(&law);
    static const double SPEEDS[] = {0.01, 0.1, 0.3, 1.0};
    double before = 1.0;
    for (size_t i = 0; i < sizeof SPEEDS / sizeof *SPEEDS; i++) {
        MapImpactCase impact = {.law = law, .mass = 0.2, .speed = SPEEDS[i]};
        const double given = map_impact_law(&impact).restitution;
        assert_near(given, law_restitution(&law, SPEEDS[i]), 1e-6);
        assert_true(given < before);
        before = given;
        // Hunt and Crossley's line, where the speed is small
        const double line = 1.0 - 2.0 / 3.0 * dissipation * SPEEDS[i];
        assert_near(given, line, pow(dissipation * SPEEDS[i], 2.0));
        impact.law = with_memory;
        assert_near(map_impact_law(&impact).restitution, contact.restitution, 1e-6);
    }
    assert_near(law_restitution(&law, contact.restitution_speed), contact.restitution, 1e-9);
    contact.dissipation = 0.25;
    assert_true(law_build(&contact, &steel, &clearance, 0.0, &law, &err));
    assert_near(law_dissipation(&law), 0.25, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_socket_has_the_stiffness_of_the_papers_equation_3),
        cmocka_unit_test(approach_and_stiffness_at_the_papers_force_are_the_known_ones),
        cmocka_unit_test(the_cylinder_laws_satisfy_their_books_formulas),
        cmocka_unit_test(johnson_gives_the_known_approach_at_the_real_pin_force),
        cmocka_unit_test(a_pair_out_of_range_is_refused),
        cmocka_unit_test(a_damping_that_grows_is_half_of_itself_at_half_the_depth),
        cmocka_unit_test(a_dissipating_law_gives_back_less_the_faster),
        cmocka_unit_test(the_options_make_the_whole_law),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
