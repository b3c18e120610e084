// Does a block with play between its guides move in ODE as it must, its contacts integrated within
// the step?
//
// The slider-crank of Flores, Leine and Glocker, Multibody Syst. Dyn. 23 (2010) 165; the numbers of
// its flight and of a rigid impact come from 50-digit arithmetic (test_play_in_guides.c has them of
// the reference). And a block on a lever that turns, whose guides turn with it.
#include "kept.h"
#include "ode_error.h"

#include "slider.h"

#include <stdio.h>

static void integrate_contacts(Scenario *scenario, double step_s)
{
    scenario->ode.stepping = ODE_STAGGERED;
    scenario->ode.map = ODE_MAP_IMPULSE;
    scenario->ode.contact_phase = 0.0125; // of errors of 2e-8 in a contact
    scenario->run.step = step_s;
}

static Scenario flores(double stiffness, double step_s)
{
    Scenario scenario = slider_flores_loose(stiffness);
    scenario.run.duration = 5e-3;
    scenario.run.samples = 100;
    integrate_contacts(&scenario, step_s);
    return scenario;
}

// The first contact: when and how fast it begins, and the speeds of crank and rod where it ends.
typedef struct Impact {
    double onset_s;
    double approach;  // m/s
    double omegas[2]; // rad/s
    bool is_level;    // both upper corners touch at once, and the slider does not turn
} Impact;

static Impact first_impact(const Scenario *scenario)
{
    const Solver *solver = registry_solver(BACKEND_ODE);
    Impact impact = {.is_level = true};
    Err err = {ERR_NONE, ""};
    void *ode = NULL;
    assert_true(solver->open(scenario, &ode, &err));
    bool was_touching = false;
    for (bool is_over = false; !is_over;) {
        if (!solver->step(ode, INFINITY, &err)) {
            fail_msg("%s", err.text);
        }
        const StepRecord record = solver->record(ode);
        const bool is_touching = record.joints[SLIDER_GUIDE].is_touching;
        if (is_touching && !was_touching) {
            impact.onset_s = record.start_s;
            impact.approach = record.approach[SLIDER_GUIDE];
        }
        if (is_touching) {
            impact.is_level = impact.is_level && fabs(record.omega[2]) < 1e-8 &&
                              solver->model(ode).contact_rows == 2;
            impact.omegas[0] = record.omega[0];
            impact.omegas[1] = record.omega[1];
        }
        is_over = was_touching && !is_touching;
        was_touching = is_touching;
    }
    solver->close(ode);
    return impact;
}

static void the_first_contact_comes_with_the_second_order_of_the_step(void **state)
{
    (void)state;
    static const double ONSET_S = 2.69250275202e-3;
    static const double APPROACH = 0.841612322033;
    Impact impacts[3];
    for (int i = 0; i < 3; i++) {
        const Scenario scenario = flores(1e8, 10e-6 / pow(4.0, i));
        impacts[i] = first_impact(&scenario);
        assert_true(impacts[i].is_level);
        print_message("# step %g us: onset off by %.3g s, speed by %.3g m/s\n",
                      1e6 * scenario.run.step, impacts[i].onset_s - ONSET_S,
                      impacts[i].approach - APPROACH);
    }
    for (int i = 0; i < 2; i++) {
        assert_near(ode_order(fabs(impacts[i].onset_s - ONSET_S),
                              fabs(impacts[i + 1].onset_s - ONSET_S), 4.0),
                    2.0, 0.05);
    }
    // the speed's share of the step's square hangs on where in the step the contact begins
    for (int i = 0; i < 3; i++) {
        const double step_s = 10e-6 / pow(4.0, i);
        assert_near(impacts[i].approach, APPROACH, 5e4 * step_s * step_s);
    }
    // the two finest steps, extrapolated
    assert_near((16.0 * impacts[2].onset_s - impacts[1].onset_s) / 15.0, ONSET_S, 5e-12);
    // control: guides 10 nm wider
    Scenario wider = flores(1e8, 10e-6 / 16.0);
    wider.linkage.joints[SLIDER_GUIDE].guide.opening += 1e-8;
    assert_true(fabs(first_impact(&wider).onset_s - impacts[2].onset_s) > 5e-9);
}

// Speeds after the impact go to those of a rigid one with the contact's duration, 1 / sqrt k.
static void a_stiff_contact_does_what_a_rigid_impact_does(void **state)
{
    (void)state;
    static const double RIGID[2][3] = {{0.0, 108.793728561, -52.875187875},
                                       {0.01, 108.724580002, -52.842290420}};
    for (int i = 0; i < 2; i++) {
        Impact impacts[3];
        double errors[3];
        for (int k = 0; k < 3; k++) {
            Scenario scenario = flores(1e8 * pow(100.0, k), 0.5e-6);
            scenario.contact.friction = RIGID[i][0];
            scenario.contact.friction_speed = 1e-3;
            impacts[k] = first_impact(&scenario);
            errors[k] = fabs(impacts[k].omegas[0] - RIGID[i][1]);
        }
        print_message("# friction %g: off by %.3g, %.3g, %.3g rad/s\n", RIGID[i][0], errors[0],
                      errors[1], errors[2]);
        assert_near(log10(errors[0] / errors[1]), 1.0, 0.02);
        for (int body = 0; body < 2; body++) {
            // the polynomial through the three in 1 / sqrt(k), at 0
            const double limit = (impacts[0].omegas[body] - 110.0 * impacts[1].omegas[body] +
                                  1000.0 * impacts[2].omegas[body]) /
                                 891.0;
            // errors of the step are 2e-5
            assert_near(limit, RIGID[i][1 + body], 5e-5);
        }
    }
    // control: the other friction
    assert_true(fabs(RIGID[0][1] - RIGID[1][1]) > 5e-3);
}

// Errors against the reference and what is left of the energy, at three steps, each a quarter
// of the one before.
static void assert_second_order(Scenario scenario, double first_s, const char *what)
{
    double errors[3];
    double residuals[3];
    Trajectory *exact = complete_run(&scenario, BACKEND_REFERENCE);
    for (int i = 0; i < 3; i++) {
        scenario.run.step = first_s / pow(4.0, i);
        Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
        const TrajectoryError error = error_against(ode, exact, INFINITY);
        assert_true(error.is_known);
        errors[i] = error.omega_rms;
        residuals[i] = fabs(ode->energy.residual);
        assert_int_equal(ode->joints[SLIDER_GUIDE].impacts, exact->joints[SLIDER_GUIDE].impacts);
        if (i == 2) {
            const double force = exact->joints[SLIDER_GUIDE].force_max.value;
            assert_close(ode->joints[SLIDER_GUIDE].force_max.value, force, 1e-3);
            assert_close(ode->energy.dissipated, exact->energy.dissipated, 1e-3);
            assert_near(ode->energy.friction, exact->energy.friction,
                        1e-3 * fabs(exact->energy.friction));
        }
        trajectory_destroy(ode);
    }
    print_message("# %s: error %.3g, %.3g, %.3g; energy %.3g, %.3g, %.3g J\n", what, errors[0],
                  errors[1], errors[2], residuals[0], residuals[1], residuals[2]);
    // where in its step a contact begins changes an error by half
    assert_near(ode_order(errors[0], errors[2], 16.0), 2.0, 0.3);
    assert_near(ode_order(residuals[1], residuals[2], 4.0), 2.0, 0.2);
    trajectory_destroy(exact);
}

static void blocks_level_tilted_and_rubbing_follow_the_reference(void **state)
{
    (void)state;
    static const double FRICTION[3] = {0.0, 0.0, 0.01};
    static const double TURNING[3] = {0.0, -0.01, -0.01};
    for (int i = 0; i < 3; i++) {
        Scenario scenario = flores(1e8, 1e-5);
        scenario.contact.friction = FRICTION[i];
        scenario.linkage.bodies[2].start.omega = TURNING[i];
        char what[64];
        snprintf(what, sizeof what, "turning %g rad/s, friction %g", TURNING[i], FRICTION[i]);
        assert_second_order(scenario, 20e-6, what);
    }
}

// The guides are on the lever. The drive turns the crank, or the lever itself.
static void guides_that_turn_with_their_body_follow_the_reference(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        Scenario scenario = slider_lever(40.0);
        slider_loosen_guide(&scenario, 0.0201, 0.02, 0.04);
        scenario.contact.stiffness = 1e7;
        scenario.contact.exponent = 1.0;
        scenario.contact.restitution = 0.7;
        scenario.contact.friction = i % 2 == 1 ? 0.1 : 0.0;
        scenario.run.revolutions = 0.1;
        scenario.run.samples = 1000;
        if (i / 2 == 1) {
            // the lever at the speed that the crank gives it; it drives the crank up to its dead
            // centre, 24 degrees
            scenario.linkage.driver.joint = 1;
            scenario.linkage.driver.speed = scenario.linkage.bodies[1].start.omega;
            scenario.run.revolutions = 0.05;
        }
        integrate_contacts(&scenario, 1e-5);
        char what[64];
        snprintf(what, sizeof what, "%s driven, friction %g", i / 2 == 1 ? "lever" : "crank",
                 scenario.contact.friction);
        assert_second_order(scenario, 20e-6, what);
    }
}

// In the middle of a contact: m a = F + m g and I alpha = M of every body.
static void forces_and_couples_balance_the_accelerations(void **state)
{
    (void)state;
    double left[2];
    for (int i = 0; i < 2; i++) {
        Scenario scenario = flores(1e7, i == 0 ? 1e-5 : 2.5e-6);
        scenario.linkage.bodies[2].start.omega = -0.5;
        scenario.contact.friction = 0.1;
        scenario.run.duration = 4e-3;
        scenario.run.samples = 4000;
        Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
        double force = 0.0;
        double couple = 0.0;
        left[i] = 0.0;
        for (size_t k = 2000; k < ode->sample_count; k++) {
            const JointState *states = trajectory_state(ode, k, 0);
            left[i] =
                fmax(left[i], slider_unbalanced(&scenario, trajectory_motion(ode, k, 0), states));
            force = fmax(force, states[SLIDER_GUIDE].force);
            couple = fmax(couple, fabs(states[SLIDER_GUIDE].moment_on_b));
        }
        print_message("# forces of %.4g N, couples of %.3g N m, unbalanced %.3g\n", force, couple,
                      left[i]);
        assert_true(force > 100.0 && couple > 1.0);
        trajectory_destroy(ode);
    }
    assert_true(left[0] < 2.0 && left[1] < 0.3 * left[0]);
}

// Copies of a mechanism, each tied to the next by a spring too weak to be seen: one mechanism, with
// so many places that its contacts are integrated by islands.
static Scenario copies_of(const Scenario *scenario, int copies)
{
    Scenario all = kept_copy(scenario);
    Linkage *linkage = &all.linkage;
    const int bodies = (int)linkage->body_count;
    const size_t joints = linkage->joint_count;
    for (int copy = 1; copy < copies; copy++) {
        for (int i = 0; i < bodies; i++) {
            linkage->bodies[linkage->body_count++] = linkage->bodies[i];
        }
        for (size_t i = 0; i < joints; i++) {
            Joint joint = linkage->joints[i];
            joint.body_a += joint.body_a != LINKAGE_GROUND ? copy * bodies : 0;
            joint.body_b += joint.body_b != LINKAGE_GROUND ? copy * bodies : 0;
            linkage->joints[linkage->joint_count++] = joint;
        }
        linkage->springs[linkage->spring_count++] =
            (Spring){.body_a = copy * bodies, .body_b = (copy - 1) * bodies, .stiffness = 1e-12};
    }
    return all;
}

static void many_blocks_move_as_one_does(void **state)
{
    (void)state;
    enum { COPIES = 5 };
    Scenario scenario = flores(1e7, 1e-5);
    assert_false(scenario.linkage.driver.is_present);
    const Scenario all = copies_of(&scenario, COPIES);
    Trajectory *one = complete_run(&scenario, BACKEND_ODE);
    Trajectory *many = complete_run(&all, BACKEND_ODE);
    const size_t joints = scenario.linkage.joint_count;
    for (size_t k = 0; k < COPIES; k++) {
        const JointExtremes *guide = &many->joints[k * joints + SLIDER_GUIDE];
        assert_int_equal(guide->impacts, one->joints[SLIDER_GUIDE].impacts);
        assert_close(guide->impulse, one->joints[SLIDER_GUIDE].impulse, 1e-5);
        assert_close(guide->force_max.value, one->joints[SLIDER_GUIDE].force_max.value, 1e-5);
        assert_close(many->bodies[k * one->body_count].omega_max.value,
                     one->bodies[0].omega_max.value, 1e-7);
    }
    assert_true(one->joints[SLIDER_GUIDE].impacts > 0);
    assert_close(many->energy.dissipated, COPIES * one->energy.dissipated, 1e-5);
    trajectory_destroy(many);
    trajectory_destroy(one);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_contact_comes_with_the_second_order_of_the_step),
        cmocka_unit_test(a_stiff_contact_does_what_a_rigid_impact_does),
        cmocka_unit_test(blocks_level_tilted_and_rubbing_follow_the_reference),
        cmocka_unit_test(guides_that_turn_with_their_body_follow_the_reference),
        cmocka_unit_test(many_blocks_move_as_one_does),
        cmocka_unit_test(forces_and_couples_balance_the_accelerations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
