// Is the reference right, and by how much? The same contacts, integrated in quadruple precision by
// another method from other coordinates, say so.
//
// The error is the largest difference of omega at the samples over the largest |omega| of the body,
// coupler and follower alike. The truth's own is below 1e-17 at the tolerance used here (see
// the_truth_converges_far_below_a_double).
#include "close.h"

#include "problems.h"
#include "truth_samples.h"

#include "run/registry.h"
#include "run/run.h"

#include <stdlib.h>

enum { SAMPLES_A_TURN = 480 };

typedef struct Claim {
    const ProblemChoice *problem;
    double turns;
    double tolerance; // of the reference; 0: its default
    double bound;     // of the error
    double flores;    // restitution asked of Flores's damping; 0: the problem's own damping
} Claim;

static const RunWatch NOBODY = {NULL, NULL};

static Scenario claim_scenario(const Claim *claim)
{
    Scenario scenario = problem_scenario(claim->problem);
    scenario.run.revolutions = claim->turns;
    scenario.run.samples = SAMPLES_A_TURN;
    if (claim->flores > 0.0) {
        scenario.contact.damping = DAMPING_FLORES;
        scenario.contact.restitution = claim->flores;
    }
    scenario.reference.tolerance =
        claim->tolerance > 0.0 ? claim->tolerance : scenario.reference.tolerance;
    return scenario;
}

static double error_of(const Scenario *scenario, const TruthSample *truth)
{
    Trajectory *trajectory = run_scenario(scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
    if (!trajectory->is_complete) {
        print_error("%s\n", trajectory->message);
    }
    assert_true(trajectory->is_complete);
    double error = 0.0;
    for (size_t body = 0; body < trajectory->body_count; body++) {
        if (linkage_is_driven(&trajectory->linkage, (int)body)) {
            continue;
        }
        double scale = 0.0;
        double difference = 0.0;
        for (size_t k = 0; k < trajectory->sample_count; k++) {
            const Quad omega = truth[k * trajectory->body_count + body].omega;
            const Quad apart = (Quad)trajectory_motion(trajectory, k, body)->omega - omega;
            scale = fmax(scale, fabs((double)omega));
            // a NaN must not pass for no difference
            difference = !(fabsq(apart) <= difference) ? (double)fabsq(apart) : difference;
        }
        error = !(difference / scale <= error) ? difference / scale : error;
    }
    trajectory_destroy(trajectory);
    return error;
}

// Holds the claim, and lets a reference with another damping law fail it.
static void check(const Claim *claim)
{
    Scenario scenario = claim_scenario(claim);
    const QuadProblem problem = quad_problem(&scenario);
    TruthSample *truth = truth_at_samples(&scenario, &problem, NULL);
    const double error = error_of(&scenario, truth);
    print_message("# %s, %.4g turns, tolerance %.3g: error %.3g\n", claim->problem->name,
                  claim->turns, scenario.reference.tolerance, error);
    assert_true(error <= claim->bound);
    scenario.contact.damping = DAMPING_HUNT_CROSSLEY;
    assert_true(error_of(&scenario, truth) > 1e3 * claim->bound);
    free(truth);
}

static void one_loose_joint_is_right_over_a_turn_at_the_default_tolerance(void **state)
{
    (void)state;
    check(&(Claim){&PROBLEMS[0], 1.0, 0.0, 1e-9, 0.0});
}

// Below, the tolerance is the least that helps: what is left, some 1e-11, is the rounding of places
// in metres where depths are in microns.

static void two_loose_joints_are_right_over_a_quarter_turn(void **state)
{
    (void)state;
    check(&(Claim){&PROBLEMS[1], 0.25, 1e-13, 1e-10, 0.0});
}

static void three_loose_joints_are_right_over_a_quarter_turn(void **state)
{
    (void)state;
    check(&(Claim){&PROBLEMS[2], 0.25, 1e-13, 1e-10, 0.0});
}

static void friction_is_right_over_a_quarter_turn(void **state)
{
    (void)state;
    check(&(Claim){&PROBLEMS[3], 0.25, 1e-13, 1e-10, 0.0});
    // the control: a coefficient off by a hundred-thousandth is seen at once
    const Claim claim = {&PROBLEMS[3], 0.025, 1e-13, 1e-10, 0.0};
    const Scenario scenario = claim_scenario(&claim);
    QuadProblem problem = quad_problem(&scenario);
    problem.friction *= 1 + (Quad)1e-5;
    TruthSample *truth = truth_at_samples(&scenario, &problem, NULL);
    assert_true(error_of(&scenario, truth) > 1e1 * claim.bound);
    free(truth);
}

// In the joint of coupler and follower sliding starts from rest and turns back at half a turn.
static void friction_is_right_where_sliding_turns_back(void **state)
{
    (void)state;
    check(&(Claim){&PROBLEMS[5], 0.6, 1e-13, 1e-10, 0.0});
    // the control: so is another speed over which friction sets in
    const Claim claim = {&PROBLEMS[5], 0.025, 1e-13, 1e-10, 0.0};
    const Scenario scenario = claim_scenario(&claim);
    QuadProblem problem = quad_problem(&scenario);
    problem.friction_speed *= 1 + (Quad)1e-2;
    TruthSample *truth = truth_at_samples(&scenario, &problem, NULL);
    assert_true(error_of(&scenario, truth) > 1e1 * claim.bound);
    free(truth);
}

// Wide play magnifies what went before: 20 times in 5 ms, 9000 times and sixteen impacts in 10 ms.
static void wide_play_is_right_as_far_as_rounding_grows(void **state)
{
    (void)state;
    check(&(Claim){&PROBLEMS[4], 1.0 / 30.0, 1e-13, 1e-10, 0.0});
    check(&(Claim){&PROBLEMS[4], 1.0 / 12.0, 1e-13, 1e-9, 0.0});
    check(&(Claim){&PROBLEMS[4], 1.0 / 6.0, 1e-13, 1e-6, 0.0});
}

// With damping this heavy a spring that is let go cannot follow: its force ends before the overlap.
static void a_contact_whose_force_ends_early_is_right(void **state)
{
    (void)state;
    const double restitutions[] = {0.1, 0.02};
    for (int i = 0; i < 2; i++) {
        const Claim claim = {&PROBLEMS[2], 3.0 / 480.0, 1e-13, 1e-10, restitutions[i]};
        const Scenario scenario = claim_scenario(&claim);
        const QuadProblem problem = quad_problem(&scenario);
        TruthFigures figures;
        free(truth_at_samples(&scenario, &problem, &figures));
        assert_true(figures.clamps >= 1);
        check(&claim);
    }
}

// The sharpest of the event's data: the speed at which the pin meets the wall.
static void an_impact_speed_off_by_a_millionth_is_seen(void **state)
{
    (void)state;
    const Claim claim = {&PROBLEMS[0], 1.0 / 40.0, 1e-13, 1e-10, 0.0};
    const Scenario scenario = claim_scenario(&claim);
    QuadProblem problem = quad_problem(&scenario);
    TruthSample *truth = truth_at_samples(&scenario, &problem, NULL);
    assert_true(error_of(&scenario, truth) <= claim.bound);
    free(truth);
    const double wrong[] = {0.01, 1e-6};
    for (int i = 0; i < 2; i++) {
        problem.impact_speed_share = 1 + (Quad)wrong[i];
        truth = truth_at_samples(&scenario, &problem, NULL);
        assert_true(error_of(&scenario, truth) > 1e1 * claim.bound);
        free(truth);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_loose_joint_is_right_over_a_turn_at_the_default_tolerance),
        cmocka_unit_test(two_loose_joints_are_right_over_a_quarter_turn),
        cmocka_unit_test(three_loose_joints_are_right_over_a_quarter_turn),
        cmocka_unit_test(friction_is_right_over_a_quarter_turn),
        cmocka_unit_test(friction_is_right_where_sliding_turns_back),
        cmocka_unit_test(wide_play_is_right_as_far_as_rounding_grows),
        cmocka_unit_test(a_contact_whose_force_ends_early_is_right),
        cmocka_unit_test(an_impact_speed_off_by_a_millionth_is_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
