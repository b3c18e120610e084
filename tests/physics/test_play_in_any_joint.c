// Can any joint have play, and does a run that goes wrong end as a failure instead of as numbers?
#include "close.h"

#include "mechanism.h"

#include "model/kinematics.h"
#include "ode/engine.h"
#include "ode/plane/world.h"
#include "run/registry.h"
#include "run/run.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <threads.h>
#include <unistd.h>

static const RunWatch NOBODY = {NULL, NULL};
static const char *const JOINTS[] = {"crank-coupler", "coupler-follower", "follower-ground"};

static Trajectory *run_ode(const Scenario *scenario)
{
    return run_scenario(scenario, registry_solver(BACKEND_ODE), NOBODY);
}

// The impulse that a joint carries over the run, by its samples.
static double sum_impulse(const Trajectory *run, size_t joint)
{
    double impulse = 0.0;
    for (size_t k = 0; k + 1 < run->sample_count; k++) {
        impulse += (run->times[k + 1] - run->times[k]) * trajectory_state(run, k, joint)->force;
    }
    return impulse;
}

// With little play the mean force in the joint is the ideal joint's: impulses must balance the
// same momenta over a turn.
static void each_joint_can_have_play_and_carries_the_ideal_impulse(void **state)
{
    (void)state;
    Scenario ideal = mechanism_paper();
    Trajectory *truth = run_scenario(&ideal, registry_solver(BACKEND_ANALYTIC), NOBODY);
    for (int i = 0; i < 3; i++) {
        Scenario scenario = mechanism_paper();
        mechanism_loosen(&scenario, JOINTS[i]);
        Trajectory *trajectory = run_ode(&scenario);
        assert_true(trajectory->is_complete);
        assert_int_equal(trajectory->constraint_rows, 6);
        assert_int_equal(trajectory->contact_rows, 1);
        const double ideal_impulse = sum_impulse(truth, (size_t)i + 1);
        const JointExtremes *joint = &trajectory->joints[i + 1];
        assert_true(joint->impacts >= 1);
        // play of 14.5 micron in links of 270 mm; the rattling at the start adds some
        assert_close(joint->impulse, ideal_impulse, 0.03);
        trajectory_destroy(trajectory);
    }
    trajectory_destroy(truth);
}

static void all_three_joints_can_have_play_at_once(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    Trajectory *truth = run_scenario(&scenario, registry_solver(BACKEND_ANALYTIC), NOBODY);
    for (int i = 0; i < 3; i++) {
        mechanism_loosen(&scenario, JOINTS[i]);
    }
    Trajectory *trajectory = run_ode(&scenario);
    assert_true(trajectory->is_complete);
    assert_int_equal(trajectory->constraint_rows, 0);
    assert_int_equal(trajectory->contact_rows, 3);
    for (size_t i = 1; i < 4; i++) {
        assert_true(trajectory->joints[i].impacts >= 1);
        const double ideal_impulse = sum_impulse(truth, i);
        // three plays rattle more than one: 0.6, 1.2 and 2.0 % above the ideal
        assert_close(trajectory->joints[i].impulse, ideal_impulse, 0.05);
    }
    trajectory_destroy(trajectory);
    trajectory_destroy(truth);
}

static void a_step_that_cannot_catch_the_wall_fails_and_says_when_and_why(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.contact.stiffness = 0.0; // the law of its steel, which has an end
    scenario.run.step = 1e-3;
    Trajectory *trajectory = run_ode(&scenario);
    assert_false(trajectory->is_complete);
    assert_non_null(strstr(trajectory->message, "at 1 ms, crank angle 6 deg"));
    assert_non_null(strstr(trajectory->message, "crank-coupler"));
    assert_non_null(strstr(trajectory->message, "inside the wall"));
    trajectory_destroy(trajectory);
    // the control: a step that can, does
    scenario.run.step = 1e-6;
    trajectory = run_ode(&scenario);
    assert_true(trajectory->is_complete);
    trajectory_destroy(trajectory);
}

static void a_velocity_that_is_not_finite_fails_the_run(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(1.0, 1e-3);
    scenario.gravity = scenario_downward(1e308);
    scenario.run.step = 10.0;
    scenario.run.duration = 100.0;
    Trajectory *trajectory = run_ode(&scenario);
    assert_false(trajectory->is_complete);
    assert_non_null(strstr(trajectory->message, "no longer finite"));
    trajectory_destroy(trajectory);
}

static void redundant_joint_rows_are_refused_before_ode_sees_them(void **state)
{
    (void)state;
    Scenario scenario = mechanism_parallelogram();
    Trajectory *trajectory = run_ode(&scenario);
    assert_false(trajectory->is_complete);
    // five joints beside the driven one, three rows each; two legs would do to carry the bar
    assert_non_null(
        strstr(trajectory->message, "1 of the 15 rows of the ideal joints follow from the others"));
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(&scenario.linkage, motions);
    World world;
    Err err = {ERR_NONE, ""};
    assert_false(world_build(&scenario, motions, &world, &err));
    assert_non_null(strstr(err.text, "follow from the others"));
    trajectory_destroy(trajectory);
}

// ODE ends the process on an internal error; here it must come back as one.
static void an_internal_error_of_ode_becomes_a_failed_step(void **state)
{
    (void)state;
    engine_start();
    const dWorldID world = dWorldCreate();
    const dBodyID body = dBodyCreate(world);
    dBodySetAngularVel(body, NAN, 0.0, 0.0);
    Err err = {ERR_NONE, ""};
    assert_false(engine_step(world, 1e-3, false, &err));
    assert_int_equal(err.kind, ERR_SOLVER);
    assert_non_null(strstr(err.text, "ODE error"));
    dWorldDestroy(world);
    // and the engine is fit for the next run
    Scenario scenario = mechanism_paper();
    scenario.run.step = 1e-4;
    Trajectory *trajectory = run_ode(&scenario);
    assert_true(trajectory->is_complete);
    trajectory_destroy(trajectory);
}

// Steps a world whose numbers are not finite; the number of the error's kind.
static int step_badly(void *context)
{
    engine_start();
    const dWorldID world = dWorldCreate();
    dBodySetAngularVel(dBodyCreate(world), NAN, 0.0, 0.0);
    Err *err = context;
    engine_step(world, 1e-3, false, err);
    dWorldDestroy(world);
    return (int)err->kind;
}

static void errors_of_threads_side_by_side_are_each_their_own(void **state)
{
    (void)state;
    enum { THREADS = 4 };
    thrd_t threads[THREADS];
    Err errs[THREADS] = {{ERR_NONE, ""}};
    engine_start();
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(thrd_create(&threads[i], step_badly, &errs[i]), thrd_success);
    }
    for (int i = 0; i < THREADS; i++) {
        int kind = ERR_NONE;
        assert_int_equal(thrd_join(threads[i], &kind), thrd_success);
        assert_int_equal(kind, ERR_SOLVER);
        assert_non_null(strstr(errs[i].text, "ODE error"));
    }
}

static void an_error_of_ode_outside_a_step_is_reported_and_aborts(void **state)
{
    (void)state;
    int pipe_ends[2];
    char said[256] = "";
    int status = 0;
    engine_start();
    assert_int_equal(pipe(pipe_ends), 0);
    const pid_t child = fork();
    if (child == 0) {
        dup2(pipe_ends[1], STDERR_FILENO);
        signal(SIGABRT, SIG_DFL);
        dError(7, "the words of %s", "ODE");
        _exit(0);
    }
    close(pipe_ends[1]);
    size_t length = 0;
    for (ssize_t part = 1; part > 0; length += (size_t)part) {
        part = read(pipe_ends[0], said + length, sizeof said - 1 - length);
        assert_true(part >= 0);
    }
    close(pipe_ends[0]);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
    assert_non_null(strstr(said, "the words of ODE"));
}

static void the_poisson_model_stays_near_the_wall_only_with_a_push_out(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.contact.model = CONTACT_POISSON;
    scenario.contact.penalty = 973.33e3;
    Trajectory *pushed = run_ode(&scenario);
    scenario.ode.push_out = 0.0;
    Trajectory *creeping = run_ode(&scenario);
    assert_true(pushed->is_complete && creeping->is_complete);
    assert_true(pushed->joints[1].penetration_max.value < 1e-6);
    // F = p dg/dt alone: 1 kN over 1e6 N s/m creeps 1 mm/s, some 20 micron in a turn
    assert_true(creeping->joints[1].penetration_max.value > 1e-5);
    trajectory_destroy(pushed);
    trajectory_destroy(creeping);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_joint_can_have_play_and_carries_the_ideal_impulse),
        cmocka_unit_test(all_three_joints_can_have_play_at_once),
        cmocka_unit_test(a_step_that_cannot_catch_the_wall_fails_and_says_when_and_why),
        cmocka_unit_test(a_velocity_that_is_not_finite_fails_the_run),
        cmocka_unit_test(redundant_joint_rows_are_refused_before_ode_sees_them),
        cmocka_unit_test(an_internal_error_of_ode_becomes_a_failed_step),
        cmocka_unit_test(errors_of_threads_side_by_side_are_each_their_own),
        cmocka_unit_test(an_error_of_ode_outside_a_step_is_reported_and_aborts),
        cmocka_unit_test(the_poisson_model_stays_near_the_wall_only_with_a_push_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
