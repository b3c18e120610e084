// Does a pin press on the hole of an eye as elasticity has it, and does the law keep to that?
#include "base/lcg.h"
#include "close.h"
#include "contact/eye.h"
#include "contact/law.h"
#include "eye_truth.h"
#include "kernel/conforming.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

// outer radius, the eye's share of 1 / E*, Poisson's ratios of eye and pin
static const Eye EYES[] = {
    {2.0, 0.5, 0.3, 0.3},   {1.5, 0.5, 0.3, 0.3},  {10.0, 0.5, 0.29, 0.29},
    {1.5, 0.5, 0.45, 0.45}, {2.0, 0.25, 0.3, 0.2}, // a hard eye, a soft pin
    {3.0, 0.75, 0.2, 0.4},                         // the other way round
    {2.0, 1.0, 0.3, 0.3},                          // a rigid pin
};
enum { EYE_COUNT = sizeof EYES / sizeof *EYES };

// Rings and pins by integration over the radius, contact by panels of which none pulls. 60 panels
// are right to 2e-6; what the contact is wide is found there, too.
static void force_and_approach_are_those_of_panels(void **state)
{
    (void)state;
    static const double ANGLES[] = {1e-3, 0.3, 1.2, 1.45};
    const double most = 1e-5;
    for (size_t i = 0; i < EYE_COUNT; i++) {
        for (size_t k = 0; k < sizeof ANGLES / sizeof *ANGLES; k++) {
            EyePress press;
            double touching;
            assert_true(eye_press(&EYES[i], ANGLES[k], &press));
            // panels that end where the contact does
            const double force =
                eye_truth_force(&EYES[i], press.approach, ANGLES[k], 60, &touching);
            assert_close(press.force, force, most);
            assert_close(touching, ANGLES[k], 1e-12);
        }
    }
    // where panels go on, those that would pull are found, and the force is the same
    EyePress press;
    double touching;
    assert_true(eye_press(&EYES[0], 0.6, &press));
    const double force = eye_truth_force(&EYES[0], press.approach, 0.75, 120, &touching);
    assert_close(press.force, force, 1e-3); // the last panel ends beside the contact
    assert_close(touching, 0.6, 0.01);
    // controls: a thicker eye, and one of a material that gives way more to the side
    const Eye thicker = {2.2, 0.5, 0.3, 0.3};
    const Eye other = {2.0, 0.5, 0.35, 0.35};
    const double right = press.force;
    assert_true(fabs(eye_truth_force(&thicker, press.approach, 0.6, 60, &touching) / right - 1.0) >
                100.0 * most);
    assert_true(fabs(eye_truth_force(&other, press.approach, 0.6, 60, &touching) / right - 1.0) >
                100.0 * most);
}

static void a_narrow_contact_is_that_of_hertz(void **state)
{
    (void)state;
    for (size_t i = 0; i < EYE_COUNT; i++) {
        const double angle = 1e-4;
        EyePress press;
        assert_true(eye_press(&EYES[i], angle, &press));
        // a^2 = 4 F R / (pi L E*), p = E* a / (2 R), of radii that differ by the play; with other
        // materials on both sides this is off by the angle
        const double most = EYES[i].hole_share == 0.5 ? 1e-6 : 20.0 * angle;
        assert_close(press.force, 0.25 * PI * angle * angle, most);
        assert_close(press.pressure, 0.5 * angle, 0.01); // beside the middle
    }
}

// Johnson, Contact Mechanics (1985), Eq. (5.57): a cylinder pressed between two planes, from its
// centre to one of them, d = F / (pi L E') (2 ln(4 R / a) - 1), 1 / E' = (1 - nu^2) / E.
static void a_cylinder_between_planes_has_johnsons_approach(void **state)
{
    (void)state;
    const double ratio = 0.3;
    const double half_width = 1e-3;
    const double k = 3.0 - 4.0 * ratio;
    double moved = 0.0;
    for (size_t n = 0; n < 200000; n += 2) {
        const double x = (double)n * half_width;
        // of Hertz's pressure with a resultant of 1, and of its like on the other side
        const double harmonic = (n == 0 ? 0.5 : 2.0 * j1(x) / x) * 2.0 / PI;
        const double own = (double)(n * n) - 1.0;
        // the truth's number, and the formula where integration over the radius takes long
        const double formula = 0.5 * ((double)n * (k + 1.0) - (k - 1.0)) / own / (1.0 - ratio);
        if (n > 0 && n < 12) {
            assert_close(eye_truth_pin(n, ratio), formula, 1e-6);
        }
        moved += harmonic * (n < 12 ? eye_truth_pin(n, ratio) : formula);
    }
    // what Johnson's approach leaves out is of the first power of the width
    assert_close(moved, (2.0 * log(4.0 / half_width) - 1.0) / PI, 1e-4);
}

static ForceLaw law_of(const Eye *eye)
{
    double series[CONFORMING_TERMS];
    assert_true(eye_series(eye, series));
    return force_law_conforming(PI, 1.0, series);
}

static void the_law_keeps_to_the_solution(void **state)
{
    (void)state;
    for (size_t i = 0; i < EYE_COUNT; i++) {
        const ForceLaw law = law_of(&EYES[i]);
        const double ratio = fmax(EYES[i].hole_ratio, EYES[i].pin_ratio);
        const double most = ratio > 0.4 ? 1e-4 : 1e-5;
        for (double angle = 1e-3; angle < 1.4; angle *= 1.5) {
            EyePress press;
            if (eye_press(&EYES[i], angle, &press) && press.approach < 30.0) {
                assert_close(force_law_elastic(&law, press.approach), press.force, most);
            }
        }
    }
    // control: the law of the wrong eye
    EyePress press;
    const ForceLaw other = law_of(&EYES[1]);
    assert_true(eye_press(&EYES[0], 0.6, &press));
    assert_true(fabs(force_law_elastic(&other, press.approach) / press.force - 1.0) > 0.05);
}

static void slope_energy_and_inverse_belong_to_the_force(void **state)
{
    (void)state;
    for (size_t i = 0; i < EYE_COUNT; i++) {
        const ForceLaw law = law_of(&EYES[i]);
        double before = 0.0;
        double stored = force_law_energy(&law, 1e-4);
        for (double depth = 1e-4; depth < 30.0; depth *= 1.3) {
            const double share = 1e-5;
            const double force = force_law_elastic(&law, depth);
            const double slope = (force_law_elastic(&law, depth * (1.0 + share)) -
                                  force_law_elastic(&law, depth * (1.0 - share))) /
                                 (2.0 * share * depth);
            double both[2];
            force_law_both(&law, depth, &both[0], &both[1]);
            assert_close(both[0], force, 1e-14);
            assert_close(both[1], slope, 1e-7);
            assert_close(force_law_penetration(&law, force), depth, 1e-10);
            assert_close(force_law_secant(&law, depth), force / depth, 1e-14);
            assert_true(force > before && both[1] > 0.0);
            before = force;
            // Simpson's rule over the depth that is added
            double added = 0.0;
            for (int k = 0; k < 40; k++) {
                const double width = 0.3 * depth / 40.0;
                const double at = depth + width * k;
                added +=
                    width / 6.0 *
                    (force_law_elastic(&law, at) + 4.0 * force_law_elastic(&law, at + 0.5 * width) +
                     force_law_elastic(&law, at + width));
            }
            const double next = force_law_energy(&law, 1.3 * depth);
            assert_close(next - stored, added, 2e-7);
            stored = next;
        }
    }
}

// ln of a force over ln of a depth has no step where the series begins, at 1e-8 of the play.
static void the_law_has_no_step_where_its_series_begins(void **state)
{
    (void)state;
    const ForceLaw law = law_of(&EYES[0]);
    const double below = force_law_elastic(&law, 1e-8 * (1.0 - 1e-6));
    const double above = force_law_elastic(&law, 1e-8 * (1.0 + 1e-6));
    assert_close(above / below, 1.0, 4e-6);
}

static void eyes_that_are_none_are_refused(void **state)
{
    (void)state;
    double series[CONFORMING_TERMS];
    const Eye bad[] = {
        {1.1, 0.5, 0.3, 0.3},       // too thin
        {NAN, 0.5, 0.3, 0.3},       // no number
        {2.0, 1.5, 0.3, 0.3},       // more than all
        {2.0, 0.5, 1.0, 0.3},       // no material
        {1.2, 0.5, 0.4999, 0.4999}, // a thin one that cannot be compressed
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_false(eye_series(&bad[i], series));
    }
}

static double unit_draw(uint64_t *seed)
{
    return 0.5 + 0.5 * lcg_draw(seed);
}

// Whatever the eye: seeded ones over all that is allowed.
static void any_eye_gives_a_force_that_grows(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (int i = 0; i < 40; i++) {
        const Eye eye = {
            .outer = 1.5 * exp(3.0 * unit_draw(&seed)),
            .hole_share = unit_draw(&seed),
            .hole_ratio = 0.45 * unit_draw(&seed),
            .pin_ratio = 0.45 * unit_draw(&seed),
        };
        EyePress press;
        const ForceLaw law = law_of(&eye);
        assert_true(eye_press(&eye, 0.1 + 0.9 * unit_draw(&seed), &press));
        assert_close(force_law_elastic(&law, press.approach), press.force, 1e-4);
    }
}

static void the_default_of_a_pin_is_by_its_width(void **state)
{
    (void)state;
    assert_int_equal(law_chosen(LAW_AUTO, 0.0), LAW_HERTZ_SOCKET);
    assert_int_equal(law_chosen(LAW_AUTO, 0.01), LAW_ELASTIC);
    assert_int_equal(law_chosen(LAW_JOHNSON, 0.0), LAW_JOHNSON);
    // twice the width, twice the force: where the sphere in its socket has no width
    ContactPair pair = {.hole_radius = 10e-3,
                        .pin_radius = 9.98e-3,
                        .width = 14e-3,
                        .youngs_modulus = 2.07e11,
                        .poisson_ratio = 0.29};
    ForceLaw narrow;
    ForceLaw wide;
    assert_true(law_make(LAW_AUTO, &pair, &narrow, &(Err){0}));
    pair.width *= 2.0;
    assert_true(law_make(LAW_AUTO, &pair, &wide, &(Err){0}));
    assert_close(force_law_elastic(&wide, 5e-6), 2.0 * force_law_elastic(&narrow, 5e-6), 1e-14);
    // a pin of bronze in an eye of steel is softer than one of steel, by what E* says in the main
    pair.pin_modulus = 1.1e11;
    pair.pin_ratio = 0.34;
    ForceLaw bronze;
    assert_true(law_make(LAW_AUTO, &pair, &bronze, &(Err){0}));
    const double softer = force_law_elastic(&bronze, 5e-6) / force_law_elastic(&wide, 5e-6);
    assert_true(softer > 0.6 && softer < 0.8);
    // of one material twice is of one material
    pair.pin_modulus = pair.youngs_modulus;
    pair.pin_ratio = pair.poisson_ratio;
    ForceLaw twice;
    assert_true(law_make(LAW_AUTO, &pair, &twice, &(Err){0}));
    assert_close(force_law_elastic(&twice, 5e-6), force_law_elastic(&wide, 5e-6), 1e-12);
    Err err = {0};
    pair.eye_radius = 11e-3;
    assert_false(law_make(LAW_ELASTIC, &pair, &twice, &err));
    assert_string_equal(err.text,
                        "the eye's radius, 11 mm, is not 1.2 times that of its hole, 10 mm");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(force_and_approach_are_those_of_panels),
        cmocka_unit_test(a_narrow_contact_is_that_of_hertz),
        cmocka_unit_test(a_cylinder_between_planes_has_johnsons_approach),
        cmocka_unit_test(the_law_keeps_to_the_solution),
        cmocka_unit_test(slope_energy_and_inverse_belong_to_the_force),
        cmocka_unit_test(the_law_has_no_step_where_its_series_begins),
        cmocka_unit_test(eyes_that_are_none_are_refused),
        cmocka_unit_test(any_eye_gives_a_force_that_grows),
        cmocka_unit_test(the_default_of_a_pin_is_by_its_width),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
