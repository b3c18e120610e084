// Does the reference follow contacts whose damping is so strong that they hardly give anything
// back?
#include "complete_run.h"

#include "contact/damping.h"
#include "contact/law.h"
#include "four_bars.h"
#include "kept.h"
#include "measure/error.h"
#include "measure/truth.h"
#include "mechanism.h"
#include "reference/stepper.h"
#include "sinking.h"

#include <stdlib.h>

static const RunWatch NOBODY = {NULL, NULL};

// An explicit method takes some 15 evaluations for three time constants: 1e7 and more here.
enum { EVALUATIONS_MOST = 500000 };

// A pin that flies at the wall and sticks there nearly.
static void next_to_no_restitution_is_delivered(void **state)
{
    (void)state;
    const double asked[] = {1e-3, 1e-6, 1e-9};
    const double lasts_s[] = {3e-3, 1.0, 40.0};
    // of the speed given back: the whole speed is held to some 1e-13 of itself
    const double within[] = {1e-8, 1e-6, 1e-3};
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
        Scenario scenario = mechanism_pin(0.1, 1e-4);
        scenario.contact.stiffness = 6.6e10;
        scenario.contact.damping = DAMPING_FLORES;
        scenario.contact.restitution = asked[i];
        scenario.linkage.bodies[0].start.velocity.x = 0.5;
        scenario.run.duration = lasts_s[i];
        scenario.run.samples = 2;
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        const double chi = damping_factor(DAMPING_FLORES, asked[i]);
        const double delivered = -trajectory_motion(trajectory, 2, 0)->velocity.x / 0.5;
        assert_close(delivered, damping_delivered(chi), within[i]);
        assert_close(trajectory->joints[0].penetration_max.value,
                     damping_depth_max(6.6e10, 1.5, chi, 0.1, 0.5), 1e-9);
        assert_true(trajectory->evaluations < EVALUATIONS_MOST);
        trajectory_destroy(trajectory);
    }
}

// 0.1 kg that rest on the wall of a hole with 0.1 mm of play, for 0.1 s.
static Scenario weight_on_wall(void)
{
    Scenario scenario = mechanism_pin(0.1, 1e-4);
    scenario.gravity = scenario_downward(9.80665);
    scenario.linkage.bodies[0].start.position = (Vec2){0.0, -1e-4};
    scenario.run.duration = 0.1;
    scenario.run.samples = 2;
    return scenario;
}

// Inertia has no part in it but at the very start: 0.1 kg against a damper of some 1e12 N s/m.
static void a_weight_sinks_into_its_damper(void **state)
{
    (void)state;
    const double weight = 0.1 * 9.80665;
    for (int digits = 6; digits <= 12; digits += 3) {
        const double restitution = pow(10.0, -digits);
        Scenario scenario = weight_on_wall();
        scenario.contact.stiffness = 6.6e10;
        scenario.contact.damping = DAMPING_FLORES;
        scenario.contact.restitution = restitution;
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        const double depth = trajectory->joints[0].penetration_max.value;
        const double rate = 1e-3 / damping_factor(DAMPING_FLORES, restitution);
        assert_close(sinking_time(depth, pow(weight / 6.6e10, 1.0 / 1.5), rate), 0.1, 1e-6);
        assert_true(trajectory->evaluations < EVALUATIONS_MOST);
        trajectory_destroy(trajectory);
    }
}

// d = (m g / k) (1 - exp(-k t / c)) but for the start, in which the weight takes m / c to stop.
static void a_weight_sinks_into_a_viscous_damper(void **state)
{
    (void)state;
    const double stiffness = 1e7;
    for (int digits = 6; digits <= 10; digits += 2) {
        const double damper = pow(10.0, digits);
        Scenario scenario = weight_on_wall();
        scenario.contact.stiffness = stiffness;
        scenario.contact.exponent = 1.0;
        scenario.contact.damping = DAMPING_VISCOUS;
        scenario.contact.viscous_coefficient = damper;
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        const double expected = 0.1 * 9.80665 / stiffness * -expm1(-stiffness * 0.1 / damper);
        const double stopping_s = 0.1 / damper;
        // the place in a hole of 0.1 mm is held to some of its roundings
        const double rounding = 4.0 * 0x1p-52 * 1e-4;
        assert_near(trajectory->joints[0].penetration_max.value, expected,
                    expected * (stopping_s / 0.1 + 1e-9) + rounding);
        assert_true(trajectory->evaluations < EVALUATIONS_MOST);
        trajectory_destroy(trajectory);
    }
}

static void a_fourbar_has_a_truth_at_any_restitution(void **state)
{
    (void)state;
    const double asked[] = {1e-2, 1e-6, 1e-12};
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
        Scenario scenario = mechanism_loose(1);
        scenario.contact.damping = DAMPING_FLORES;
        scenario.contact.restitution = asked[i];
        Truth truth = truth_make(&scenario, NOBODY);
        assert_true(truth.trajectory->is_complete);
        assert_string_equal(truth.message, "");
        assert_true(truth.uncertainty > 0.0 && truth.uncertainty < 1e-9);
        assert_close(truth.horizon_s, scenario_duration(&scenario), 1e-9);
        assert_true(truth.trajectory->evaluations < EVALUATIONS_MOST);
        truth_finish(&truth);
    }
}

// Nor does the limit make a truth of a loose tolerance look better than it is: the two runs that it
// compares differ.
static void a_loose_truth_says_how_uncertain_it_is(void **state)
{
    (void)state;
    Scenario scenario = mechanism_loose(1);
    scenario.contact.damping = DAMPING_FLORES;
    scenario.contact.restitution = 1e-6;
    Trajectory *best = complete_run(&scenario, BACKEND_REFERENCE);
    scenario.reference.tolerance = 1e-5;
    Truth loose = truth_make(&scenario, NOBODY);
    const TrajectoryError error = error_against(loose.trajectory, best, loose.horizon_s);
    assert_true(error.max_in_horizon > 0.0 && error.max_in_horizon <= 3.0 * loose.uncertainty);
    assert_true(loose.uncertainty < 1e-4);
    const Scenario other = truth_at_other_tolerance(&scenario);
    Trajectory *run = complete_run(&other, BACKEND_REFERENCE);
    assert_true(run->hash != loose.trajectory->hash);
    trajectory_destroy(run);
    trajectory_destroy(best);
    truth_finish(&loose);
}

// A pin that comes to the wall so slowly that its depth is less than rounding sees of it: the end
// of such a contact is seen late, below zero depth.
static void a_touch_within_rounding_takes_no_more_steps_than_others(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.3, 2e-6);
    scenario.contact.law = LAW_ESDU_78035;
    scenario.contact.damping = DAMPING_GONTHIER;
    scenario.contact.restitution = 0.45;
    // the pin at the end of an arm, whose digits the event has to do with
    Linkage *linkage = &scenario.linkage;
    linkage->joints[0].anchor_b = (Vec2){0.1, 0.0};
    linkage->bodies[0].inertia = 1e-3;
    linkage->bodies[0].start.position = (Vec2){-0.1 + 2e-6 - 2e-13, 0.0};
    linkage->bodies[0].start.velocity.x = 1e-11;
    scenario.run.duration = 0.5;
    scenario.run.samples = 10;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(trajectory->steps < 1000);
    trajectory_destroy(trajectory);
}

// A pin let go along the wall sinks in until the force turns it, F = m v^2 / r, and keeps its
// angular momentum, v r = v_0 c. The damping outweighs the spring by far and has nothing to do with
// it: steps are a share of a turn, at a small tolerance too.
static void a_pin_that_whirls_takes_steps_as_long_as_its_motion_is_smooth(void **state)
{
    (void)state;
    const double play = 8e-6;
    const double speed = 0.17;
    Scenario scenario = mechanism_pin(0.1, play);
    scenario.contact.stiffness = 1.7e11;
    scenario.contact.damping = DAMPING_LANKARANI_NIKRAVESH;
    scenario.contact.restitution = 0.7;
    scenario.linkage.bodies[0].start.position = (Vec2){0.0, (1.0 - 1e-15) * play};
    scenario.linkage.bodies[0].start.velocity.x = speed;
    scenario.reference.tolerance = 1e-14;
    // 40 times the time in which it sinks in, 70 turns
    scenario.run.duration = 0.02;
    scenario.run.samples = 2;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    double depth = 0.0;
    for (int i = 0; i < 100; i++) {
        const double radius = play + depth;
        const double turned = 0.1 * pow(speed * play / radius, 2.0) / radius;
        depth = pow(turned / 1.7e11, 1.0 / 1.5);
    }
    const Vec2 velocity = trajectory_motion(trajectory, 2, 0)->velocity;
    assert_close(trajectory->joints[0].penetration_max.value, depth, 1e-6);
    assert_close(vec2_length(velocity), speed * play / (play + depth), 1e-9);
    // control: that it has sunk in shows
    assert_true(vec2_length(velocity) < 0.95 * speed);
    // explicit steps, shorter the smaller the tolerance, take 1.6 million
    assert_true(trajectory->evaluations < EVALUATIONS_MOST / 4);
    trajectory_destroy(trajectory);
}

// Eight four-bars in a row that are let go upright, with play in every joint.
static Scenario loose_row(double restitution)
{
    Scenario scenario = mechanism_default();
    four_bars_fill(&scenario, 8, 0.03);
    for (size_t i = 0; i < scenario.linkage.joint_count; i++) {
        Joint *joint = &scenario.linkage.joints[i];
        joint->kind = JOINT_CLEARANCE;
        joint->clearance = (Clearance){.hole_radius = 5.05e-3, .pin_radius = 5e-3, .width = 10e-3};
    }
    scenario.contact.stiffness = 1e8;
    scenario.contact.restitution = restitution;
    scenario.contact.damping = DAMPING_EXACT;
    scenario.contact.resting_speed = 0.0; // damped by the speeds of impacts, which are small
    return scenario;
}

typedef struct Methods {
    size_t explicit_steps;
    size_t implicit_steps;
    size_t evaluations;
} Methods;

static Methods count_methods(const Scenario *of_case, double tolerance)
{
    Scenario scenario = *of_case;
    scenario.reference.tolerance = tolerance;
    Stepper *stepper = calloc(1, sizeof *stepper);
    Err err = {ERR_NONE, ""};
    Methods methods = {0, 0, 0};
    assert_true(stepper_init(stepper, &scenario, &err));
    for (double time_s = 0.0; time_s < scenario_duration(&scenario);) {
        if (!stepper_next(stepper, &err)) {
            fail_msg("%s", err.text);
        }
        *(stepper->integrator.method != NULL ? &methods.implicit_steps : &methods.explicit_steps) +=
            1;
        time_s = stepper->system->kind->time(stepper->system, stepper->integrator.tried);
    }
    methods.evaluations = stepper->integrator.evaluations;
    stepper_finish(stepper);
    free(stepper);
    return methods;
}

// An implicit step of a row takes the work of some sixty explicit ones and more: at a restitution
// of 0.6 it is hardly ever worth that, and a looser tolerance never costs more; at next to none it
// is.
static void a_row_is_left_to_the_method_that_costs_less(void **state)
{
    (void)state;
    const double tolerances[] = {1e-5, 1e-7, 1e-9, 1e-11};
    size_t before = 0;
    for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++) {
        const Scenario scenario = loose_row(0.6);
        const Methods methods = count_methods(&scenario, tolerances[i]);
        assert_int_equal(methods.implicit_steps, 0);
        assert_true(methods.evaluations > before);
        before = methods.evaluations;
    }
    const Scenario sticking = loose_row(1e-6);
    const Methods methods = count_methods(&sticking, 1e-9);
    assert_true(methods.implicit_steps > 10);
    assert_true(methods.evaluations < EVALUATIONS_MOST / 50);
}

// Of contacts that give next to nothing back, a loose tolerance is one that takes no more work than
// a tight one, whose error is still what it says. Without its limit, 1e-5 took 1.3 and 4.6 times
// the evaluations of 1e-9 here, with 4 and 120 times what the uncertainty is now. The control is
// the limit itself: it leaves a usual contact alone.
static void a_looser_tolerance_takes_no_more_work(void **state)
{
    (void)state;
    for (int digits = 3; digits <= 9; digits += 3) {
        const Scenario scenario = loose_row(pow(10.0, -digits));
        const size_t loose = count_methods(&scenario, 1e-5).evaluations;
        const size_t tight = count_methods(&scenario, 1e-9).evaluations;
        assert_true((double)loose <= 1.2 * (double)tight);
        assert_true(law_loosest_tolerance(&scenario) < 1e-6);
    }
    const Scenario usual = loose_row(0.8);
    assert_true(law_loosest_tolerance(&usual) > 1e-5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_looser_tolerance_takes_no_more_work),
        cmocka_unit_test(a_row_is_left_to_the_method_that_costs_less),
        cmocka_unit_test(next_to_no_restitution_is_delivered),
        cmocka_unit_test(a_weight_sinks_into_its_damper),
        cmocka_unit_test(a_weight_sinks_into_a_viscous_damper),
        cmocka_unit_test(a_fourbar_has_a_truth_at_any_restitution),
        cmocka_unit_test(a_loose_truth_says_how_uncertain_it_is),
        cmocka_unit_test(a_pin_that_whirls_takes_steps_as_long_as_its_motion_is_smooth),
        cmocka_unit_test(a_touch_within_rounding_takes_no_more_steps_than_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
