// Is the verdict of a mapping right when the setting is run, on joints of every kind?
//
// Joints are drawn at random (tests/support/random_joint.h), over nine decades of mass and five of
// speed, at steps on both sides of every map's limit of stability. The verdict comes from the
// one-freedom prediction; what is right comes from the engine, judged alike. Where the two say
// valid, they must agree within a hundredth. build/tests/measure/map_verdicts does it on 2,000.
#include "close.h"
#include "mechanism.h"
#include "random_joint.h"

#include <stdlib.h>

enum { JOINTS = 60 };

static const unsigned short SEED[3] = {2026, 11, 22};

static const double AGREEMENT = 0.01; // of what is predicted, where it is valid

static const double SCALE_MOST = 1e6; // and its inverse

static void the_verdict_is_right_on_random_joints(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    size_t counts[VERDICT_COUNT] = {0};
    double worst = 0.0;
    for (int i = 0; i < JOINTS; i++) {
        const RandomJoint drawn = random_joint_draw(draws, i);
        for (int map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map++) {
            ImpactFigures predicted;
            ImpactDelivered delivered;
            const VerdictKind verdict = random_joint_predict(&drawn, (OdeMap)map, &predicted);
            const VerdictKind right =
                random_joint_deliver(&drawn, (OdeMap)map, &predicted, &delivered);
            if (verdict != right) {
                fail_msg("joint %d, %s: said %s, is %s %s", i, OPTIONS_ODE_MAPS[map],
                         VERDICT_NAMES[verdict],
                         right < VERDICT_COUNT ? VERDICT_NAMES[right] : "not measured:",
                         delivered.message);
            }
            counts[verdict]++;
            if (verdict == VERDICT_VALID) {
                worst = fmax(worst, random_joint_difference(&delivered.figures, &predicted));
            }
        }
    }
    for (int i = 0; i < VERDICT_COUNT; i++) {
        print_message("# %-12s %zu\n", VERDICT_NAMES[i], counts[i]);
    }
    print_message("# delivered and predicted differ by at most %.2e where valid\n", worst);
    assert_true(worst <= AGREEMENT);
    // the draws are no trial if they are all of one kind
    assert_true(counts[VERDICT_VALID] >= JOINTS);
    assert_true(counts[VERDICT_UNSTABLE] >= 10);
    assert_true(counts[VERDICT_OVER_DAMPED] >= 10);
    assert_true(counts[VERDICT_TOO_COARSE] >= 5);
    assert_true(counts[VERDICT_PEAK] >= 5);
    assert_true(counts[VERDICT_PAST_END] >= 2);
}

// Forces and depths off by less than this many newtons or metres were once called right.
static bool is_right_by_absolute_floor(const ImpactFigures *figures, const MapImpact *asked)
{
    const double floor = MAPPING_VALID_SHARE * MAPPING_VALID_SHARE;
    const double values[] = {figures->force_max.least - asked->force_max,
                             figures->force_max.most - asked->force_max,
                             figures->penetration_max.least - asked->penetration_max,
                             figures->penetration_max.most - asked->penetration_max};
    const double asked_of[] = {asked->force_max, asked->force_max, asked->penetration_max,
                               asked->penetration_max};
    for (int i = 0; i < 4; i++) {
        if (!(fabs(values[i]) <= fmax(MAPPING_VALID_SHARE * asked_of[i], floor))) {
            return false;
        }
    }
    return true;
}

// The same impact in other units, or at another size: a verdict has no dimension. Control: a
// judgement with an absolute floor moves.
static void the_verdict_is_the_same_at_any_mass_length_and_time(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    size_t moved_by_floor = 0;
    for (int i = 0; i < 4 * JOINTS; i++) {
        const RandomJoint drawn = random_joint_draw(draws, i);
        double scales[3];
        for (int k = 0; k < 3; k++) {
            scales[k] = pow(SCALE_MOST, 2.0 * erand48(draws) - 1.0);
        }
        const RandomJoint scaled = random_joint_scaled(&drawn, scales[0], scales[1], scales[2]);
        for (int map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map++) {
            ImpactFigures one;
            ImpactFigures other;
            const VerdictKind verdict = random_joint_predict(&drawn, (OdeMap)map, &one);
            const VerdictKind again = random_joint_predict(&scaled, (OdeMap)map, &other);
            if (verdict != again) {
                fail_msg("joint %d, %s: %s, and %s when scaled", i, OPTIONS_ODE_MAPS[map],
                         VERDICT_NAMES[verdict], VERDICT_NAMES[again]);
            }
            moved_by_floor += is_right_by_absolute_floor(&one, &drawn.contact.asked) !=
                              is_right_by_absolute_floor(&other, &scaled.contact.asked);
        }
    }
    print_message("# an absolute floor moves %zu of %d\n", moved_by_floor,
                  4 * JOINTS * MAPPING_MAP_COUNT);
    assert_true(moved_by_floor > JOINTS);
}

// The depth can be what is wrong alone.
static void an_impact_that_is_off_in_depth_alone_is_said_to_be(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    size_t depths = 0;
    for (int i = 0; i < 8 * JOINTS; i++) {
        const RandomJoint drawn = random_joint_draw(draws, i);
        for (int map = ODE_MAP_TEXTBOOK; map < ODE_MAP_IMPULSE; map++) {
            ImpactFigures predicted;
            ImpactDelivered delivered;
            if (random_joint_predict(&drawn, (OdeMap)map, &predicted) != VERDICT_DEPTH) {
                continue;
            }
            depths++;
            assert_int_equal(random_joint_deliver(&drawn, (OdeMap)map, &predicted, &delivered),
                             VERDICT_DEPTH);
            const double asked = drawn.contact.asked.penetration_max;
            assert_true(fabs(delivered.figures.penetration_max.mean / asked - 1.0) >
                        MAPPING_VALID_SHARE);
        }
    }
    print_message("# off in depth alone: %zu\n", depths);
    assert_true(depths >= 5);
}

// Controls: another map's prediction, and one from the tangent stiffness, are found out.
static void a_wrong_prediction_is_found_out(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    const OdeMap map = ODE_MAP_CORRECTED;
    size_t other_verdicts = 0;
    size_t other_numbers = 0;
    size_t tangents = 0;
    size_t stiffening = 0;
    for (int i = 0; i < 2 * JOINTS; i++) {
        const RandomJoint drawn = random_joint_draw(draws, i);
        const MappingContact *contact = &drawn.contact;
        ImpactFigures wrong;
        ImpactFigures predicted;
        ImpactDelivered delivered;
        const VerdictKind wrong_verdict = random_joint_predict(&drawn, ODE_MAP_TEXTBOOK, &wrong);
        const VerdictKind verdict = random_joint_predict(&drawn, map, &predicted);
        const VerdictKind right = random_joint_deliver(&drawn, map, &predicted, &delivered);
        other_verdicts += wrong_verdict != right;
        if (verdict != VERDICT_VALID) {
            continue; // the claim that is controlled is made of valid settings alone
        }
        other_numbers += random_joint_difference(&wrong, &delivered.figures) > AGREEMENT;
        if (contact->impact.law.exponent > 1.2) {
            RandomJoint stiff = drawn;
            stiff.contact.impact.law.stiffness *= contact->impact.law.exponent;
            ImpactFigures tangent;
            random_joint_predict(&stiff, map, &tangent);
            tangents += random_joint_difference(&tangent, &delivered.figures) > AGREEMENT;
            stiffening++;
        }
    }
    print_message("# the textbook's for the corrected: verdict %zu of %d, numbers %zu; tangent for "
                  "secant: %zu of %zu\n",
                  other_verdicts, 2 * JOINTS, other_numbers, tangents, stiffening);
    assert_true(other_verdicts > JOINTS / 2);
    assert_true(other_numbers > JOINTS / 4);
    assert_true(stiffening >= 5);
    assert_int_equal(tangents, stiffening);
}

// The paper's own pin, every map, from three steps a contact to three hundred.
static void on_the_papers_joint_valid_settings_deliver_what_is_predicted(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_loose(1);
    const MappingSettings settings = {
        .step_count = 6,
        .steps = {3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7},
        .map_count = MAPPING_MAP_COUNT,
        .maps = {ODE_MAP_TEXTBOOK, ODE_MAP_CORRECTED, ODE_MAP_MIDPOINT, ODE_MAP_EXACT,
                 ODE_MAP_IMPULSE},
    };
    Mapping mapping;
    Err err = {ERR_NONE, ""};
    assert_true(mapping_make(&scenario, &settings, (MappingWatch){0}, &mapping, &err));
    assert_int_equal(mapping.contact_count, 1);
    assert_int_equal(mapping.row_count, 30);
    double worst = 0.0;
    size_t valid = 0;
    for (size_t i = 0; i < mapping.row_count; i++) {
        const MappingRow *row = &mapping.rows[i];
        assert_true(row->delivered.is_measured);
        assert_int_equal(
            verdict_judge(&mapping.contacts[0], row->map, row->step_s, &row->delivered.figures),
            row->verdict);
        if (row->verdict == VERDICT_VALID) {
            valid++;
            worst = fmax(worst, random_joint_difference(&row->delivered.figures, &row->predicted));
        }
    }
    print_message("# %zu of %zu settings valid, delivered within %.2e of predicted\n", valid,
                  mapping.row_count, worst);
    assert_true(valid >= 20 && valid < mapping.row_count);
    assert_true(worst <= AGREEMENT);
    mapping_finish(&mapping);
}

// The longest step that is called valid is so in the engine, and one a quarter longer is not.
static void the_advised_step_is_valid_and_one_a_quarter_longer_is_not(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    for (int i = 0; i < 8; i++) {
        RandomJoint drawn = random_joint_draw(draws, i);
        verdict_find_steps(&drawn.contact);
        for (int map = ODE_MAP_TEXTBOOK; map < ODE_MAP_IMPULSE; map++) {
            const double longest_s = drawn.contact.largest_s[map];
            // room for the step in a play that is not the law's
            if (longest_s == 0.0 || drawn.contact.impact.law.family != FORCE_LAW_POWER) {
                continue;
            }
            Clearance *clearance = &drawn.contact.scenario.linkage.joints[0].clearance;
            clearance->hole_radius =
                fmax(clearance->hole_radius,
                     clearance->pin_radius + 20.0 * drawn.contact.impact.speed * longest_s);
            drawn.step_s = longest_s;
            ImpactFigures predicted;
            ImpactDelivered delivered;
            random_joint_predict(&drawn, (OdeMap)map, &predicted);
            assert_int_equal(random_joint_deliver(&drawn, (OdeMap)map, &predicted, &delivered),
                             VERDICT_VALID);
            drawn.step_s = 1.25 * longest_s;
            assert_true(random_joint_predict(&drawn, (OdeMap)map, &predicted) != VERDICT_VALID);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_verdict_is_right_on_random_joints),
        cmocka_unit_test(the_verdict_is_the_same_at_any_mass_length_and_time),
        cmocka_unit_test(an_impact_that_is_off_in_depth_alone_is_said_to_be),
        cmocka_unit_test(a_wrong_prediction_is_found_out),
        cmocka_unit_test(on_the_papers_joint_valid_settings_deliver_what_is_predicted),
        cmocka_unit_test(the_advised_step_is_valid_and_one_a_quarter_longer_is_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
