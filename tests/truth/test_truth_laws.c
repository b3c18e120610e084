// Does the truth know every contact law? Each impact without damping gives back its speed, that of
// a spring and damper what the closed form says, and the forces are those of the program's own
// laws.
#include "close.h"

#include "quad_truth.h"

#include "contact/damping.h"
#include "contact/law.h"
#include "mechanism.h"
#include "model/kinematics.h"

enum { LAWS = LAW_PAPER_TABLE_3 + 1 };

// An exact power of two, so that its position is known without rounding.
static const double CLEARANCE = 0x1p-14;

static const double TRUE_SHARE = 1e-16;

static Scenario flung_pin(LawKind law)
{
    Scenario scenario = mechanism_pin(0.1, CLEARANCE);
    scenario.contact.law = law;
    scenario.contact.stiffness = 0.0;
    scenario.contact.damping = DAMPING_NONE;
    scenario.linkage.joints[0].clearance.width = 0.013;
    scenario.linkage.bodies[0].start.velocity = (Vec2){1.0, 0.0};
    return scenario;
}

static Quad given_back(const QuadProblem *problem, double tolerance)
{
    TruthOptions options = truth_options_default();
    options.tolerance = tolerance;
    TruthSample pin[KINEMATICS_BODY_MAX];
    TruthFigures figures = {.ends = 0};
    // until it has left the wall, and is on its way to the other
    for (double time = 1e-4; figures.ends == 0 && time < 1e-2; time += 5e-5) {
        assert_true(truth_run(problem, &options, 1, &time, pin, &figures));
    }
    assert_int_equal(figures.ends, 1);
    return figures.end_speed / figures.onset_speed;
}

static void an_undamped_impact_gives_back_its_speed_by_every_law(void **state)
{
    (void)state;
    for (int law = 0; law < LAWS; law++) {
        const Scenario scenario = flung_pin((LawKind)law);
        QuadProblem problem = quad_problem(&scenario);
        assert_true(fabsq(given_back(&problem, 1e-18) - 1) < TRUE_SHARE);
        // the control
        problem.hysteresis = 1e-9;
        assert_true(fabsq(given_back(&problem, 1e-18) - 1) > 1e-10);
    }
}

static void a_spring_and_damper_gives_back_what_the_closed_form_says(void **state)
{
    (void)state;
    Scenario scenario = flung_pin(LAW_PAPER_TABLE_2);
    const double stiffness = (double)quad_problem(&scenario).joints[0].law.stiffness;
    scenario.contact.damping = DAMPING_VISCOUS;
    const double ratios[] = {0.05, 0.3};
    for (int i = 0; i < 2; i++) {
        scenario.contact.viscous_coefficient = 2.0 * ratios[i] * sqrt(0.1 * stiffness);
        const QuadProblem problem = quad_problem(&scenario);
        // its force ends before the overlap does, and the speed stays as it is then
        const double e = (double)given_back(&problem, 1e-18);
        assert_near(e, damping_linear_restitution(ratios[i]), 1e-14);
        assert_true(fabs(e - damping_linear_restitution(1.000001 * ratios[i])) > 1e-8);
    }
}

static void forces_and_damping_factors_are_those_of_the_program(void **state)
{
    (void)state;
    const double depths[] = {1e-9, 1e-7, 3e-6};
    for (int law = 0; law < LAWS; law++) {
        const Scenario scenario = flung_pin((LawKind)law);
        const Joint *joint = &scenario.linkage.joints[0];
        const QuadLaw own = quad_law(&scenario, joint);
        ForceLaw theirs;
        Err err = {ERR_NONE, ""};
        assert_true(law_of_joint(&scenario, joint, &theirs, &err));
        for (int i = 0; i < 3; i++) {
            const double force = (double)quad_law_force(&own, depths[i]);
            assert_close(force_law_elastic(&theirs, depths[i]), force, 2e-14);
            // by a rule on twenty points
            assert_close(force_law_energy(&theirs, depths[i]),
                         (double)quad_law_energy(&own, depths[i]),
                         own.is_conforming ? 1e-7 : 2e-14);
        }
    }
    ContactOptions contact = contact_options_default();
    for (int kind = DAMPING_NONE; kind <= DAMPING_VISCOUS; kind++) {
        contact.damping = (DampingKind)kind;
        contact.restitution = 0.37;
        assert_near(damping_factor(contact.damping, contact.restitution),
                    (double)quad_law_hysteresis(&contact), 1e-14);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_undamped_impact_gives_back_its_speed_by_every_law),
        cmocka_unit_test(a_spring_and_damper_gives_back_what_the_closed_form_says),
        cmocka_unit_test(forces_and_damping_factors_are_those_of_the_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
