// Is the verdict of a mapping right when the setting is run, on joints of every kind?
//
// Joints are drawn at random: linear springs with a viscous damper and Hertzian contacts with a
// hysteretic one, over six decades of stiffness and four of mass, at steps on both sides of every
// map's limit of stability. The verdict comes from the one-freedom prediction; what is right comes
// from the engine, judged alike. Where the two say valid, they must agree within a hundredth.
#include "close.h"
#include "mechanism.h"

#include "compare/mapping_verdict.h"
#include "contact/damping.h"

#include <stdlib.h>

enum { JOINTS = 50 };

static const unsigned short SEED[3] = {2026, 5, 1};

static const double AGREEMENT = 0.01; // of what is predicted, where it is valid

static double draw(unsigned short *state, double low, double high)
{
    return low + (high - low) * erand48(state);
}

static double draw_log(unsigned short *state, double low, double high)
{
    return low * pow(high / low, erand48(state));
}

// A contact and a step.
typedef struct Drawn {
    MappingContact contact;
    double step_s;
} Drawn;

// What a joint is made of is drawn first, then the step, then a hole that leaves room for both.
static Drawn draw_joint(unsigned short *state, int number)
{
    static const DampingKind DAMPINGS[] = {DAMPING_LANKARANI_NIKRAVESH, DAMPING_FLORES,
                                           DAMPING_EXACT};
    const double stiffness = draw_log(state, 1e5, 1e11);
    const double mass = draw_log(state, 1e-3, 10.0);
    const double restitution = draw(state, 0.1, 1.0);
    const double speed = draw_log(state, 0.01, 1.0);
    const double steps_a_contact = draw_log(state, 0.6, 150.0);
    const bool is_linear = number % 2 == 0;

    Scenario scenario = mechanism_pin(mass, 1.0);
    ContactOptions *options = &scenario.contact;
    options->stiffness = stiffness;
    options->restitution = restitution;
    options->exponent = is_linear ? 1.0 : 1.5;
    options->damping = is_linear ? DAMPING_VISCOUS : DAMPINGS[number / 2 % 3];
    options->viscous_coefficient = 2.0 * damping_linear_ratio(restitution) * sqrt(stiffness * mass);
    Clearance *clearance = &scenario.linkage.joints[0].clearance;
    clearance->pin_radius = 10.0; // no depth is too deep for it
    clearance->hole_radius = 11.0;
    Drawn drawn;
    Err err = {ERR_NONE, ""};
    assert_true(mapping_contact_make(&scenario, &(MappingJoint){.joint = 0}, mass, speed,
                                     &drawn.contact, &err));
    drawn.step_s = drawn.contact.half_period_s / steps_a_contact;
    const double longest = fmax(drawn.step_s, drawn.contact.asked.duration);
    drawn.contact.scenario.linkage.joints[0].clearance.hole_radius = 10.0 + 20.0 * speed * longest;
    return drawn;
}

static ImpactFigures deliver(const Drawn *drawn, OdeMap map, const ImpactFigures *predicted)
{
    const MappingContact *contact = &drawn->contact;
    const Scenario ready = mapping_scenario(contact, map, drawn->step_s);
    const ImpactDelivered delivered = impact_deliver(
        &ready, 0, contact->impact.mass, contact->impact.speed, predicted->duration.most);
    if (!delivered.is_measured) {
        fail_msg("%s, %g us: %s", OPTIONS_ODE_MAPS[map], 1e6 * drawn->step_s, delivered.message);
    }
    return delivered.figures;
}

static double apart(const ImpactSpread *a, const ImpactSpread *b)
{
    return fabs(a->mean / b->mean - 1.0);
}

// The largest difference of the three numbers that are judged, relative.
static double difference(const ImpactFigures *a, const ImpactFigures *b)
{
    return fmax(
        apart(&a->restitution, &b->restitution),
        fmax(apart(&a->force_max, &b->force_max), apart(&a->penetration_max, &b->penetration_max)));
}

static void the_verdict_is_right_on_random_joints(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    size_t counts[VERDICT_COUNT] = {0};
    double worst = 0.0;
    for (int i = 0; i < JOINTS; i++) {
        const Drawn drawn = draw_joint(draws, i);
        for (int map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map++) {
            const ImpactFigures predicted =
                mapping_predict(&drawn.contact, (OdeMap)map, drawn.step_s);
            const VerdictKind verdict =
                verdict_judge(&drawn.contact, (OdeMap)map, drawn.step_s, &predicted);
            const ImpactFigures delivered = deliver(&drawn, (OdeMap)map, &predicted);
            const VerdictKind right =
                verdict_judge(&drawn.contact, (OdeMap)map, drawn.step_s, &delivered);
            if (verdict != right) {
                fail_msg("joint %d, %s: said %s, is %s", i, OPTIONS_ODE_MAPS[map],
                         VERDICT_NAMES[verdict], VERDICT_NAMES[right]);
            }
            counts[verdict]++;
            if (verdict == VERDICT_VALID) {
                worst = fmax(worst, difference(&delivered, &predicted));
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
}

// Controls: another map's prediction, and one from the tangent stiffness, are found out.
static void a_wrong_prediction_is_found_out(void **state)
{
    (void)state;
    unsigned short draws[3] = {SEED[0], SEED[1], SEED[2]};
    size_t other_verdicts = 0;
    size_t other_numbers = 0;
    size_t tangents = 0;
    size_t hertzian = 0;
    for (int i = 0; i < JOINTS; i++) {
        const Drawn drawn = draw_joint(draws, i);
        const MappingContact *contact = &drawn.contact;
        const OdeMap map = ODE_MAP_CORRECTED;
        const ImpactFigures wrong = mapping_predict(contact, ODE_MAP_TEXTBOOK, drawn.step_s);
        const ImpactFigures predicted = mapping_predict(contact, map, drawn.step_s);
        const ImpactFigures delivered = deliver(&drawn, map, &predicted);
        other_verdicts += verdict_judge(contact, map, drawn.step_s, &wrong) !=
                          verdict_judge(contact, map, drawn.step_s, &delivered);
        other_numbers += difference(&wrong, &delivered) > AGREEMENT;
        // the claim that is controlled is made of valid settings alone
        const ImpactFigures right = mapping_predict(contact, map, drawn.step_s);
        const bool is_valid = verdict_judge(contact, map, drawn.step_s, &right) == VERDICT_VALID;
        if (contact->impact.law.exponent > 1.0 && is_valid) {
            Drawn stiff = drawn;
            stiff.contact.impact.law.stiffness *= contact->impact.law.exponent;
            const ImpactFigures tangent = mapping_predict(&stiff.contact, map, drawn.step_s);
            tangents += difference(&tangent, &delivered) > AGREEMENT;
            hertzian++;
        }
    }
    print_message("# the textbook's for the corrected: verdict %zu, numbers %zu of %d; tangent for "
                  "secant: %zu of %zu\n",
                  other_verdicts, other_numbers, JOINTS, tangents, hertzian);
    assert_true(other_verdicts > JOINTS / 2);
    assert_true(other_numbers > JOINTS / 2);
    assert_true(hertzian >= 5);
    assert_int_equal(tangents, hertzian);
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
            worst = fmax(worst, difference(&row->delivered.figures, &row->predicted));
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
    for (int i = 0; i < 6; i++) {
        Drawn drawn = draw_joint(draws, i);
        verdict_find_steps(&drawn.contact);
        for (int map = ODE_MAP_TEXTBOOK; map < ODE_MAP_IMPULSE; map++) {
            const double longest_s = drawn.contact.largest_s[map];
            if (longest_s == 0.0) {
                continue;
            }
            drawn.step_s = longest_s;
            const ImpactFigures predicted =
                mapping_predict(&drawn.contact, (OdeMap)map, drawn.step_s);
            const ImpactFigures delivered = deliver(&drawn, (OdeMap)map, &predicted);
            assert_int_equal(verdict_judge(&drawn.contact, (OdeMap)map, drawn.step_s, &delivered),
                             VERDICT_VALID);
            drawn.step_s = 1.25 * longest_s;
            const ImpactFigures longer = mapping_predict(&drawn.contact, (OdeMap)map, drawn.step_s);
            assert_true(verdict_judge(&drawn.contact, (OdeMap)map, drawn.step_s, &longer) !=
                        VERDICT_VALID);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_verdict_is_right_on_random_joints),
        cmocka_unit_test(a_wrong_prediction_is_found_out),
        cmocka_unit_test(on_the_papers_joint_valid_settings_deliver_what_is_predicted),
        cmocka_unit_test(the_advised_step_is_valid_and_one_a_quarter_longer_is_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
