// Does a block with play between its guides fly, touch and tilt as it must?
//
// The slider-crank of Flores, Leine and Glocker, Multibody Syst. Dyn. 23 (2010) 165: a block 50 mm
// high in guides 52 mm apart, no drive, started level at 150 rad/s. Until its first contact crank
// and rod are a double pendulum with the slider's mass at its end; the numbers of that motion, and
// what a rigid impact with a restitution of 0.4 makes of its speeds, come from 50-digit arithmetic.
#include "complete_run.h"

#include "kept.h"
#include "slider.h"

#include <stdio.h>

// Its first contact, with friction.
static Scenario flores(double stiffness, double friction)
{
    Scenario scenario = slider_flores_loose(stiffness);
    scenario.contact.friction = friction;
    scenario.contact.friction_speed = 1e-3;
    scenario.reference.tolerance = 1e-13;
    scenario.run.duration = 3e-3;
    scenario.run.samples = 3;
    return scenario;
}

// The speeds of turning where the first contact begins and where it ends.
typedef struct Impact {
    double onset_s;
    double approach;  // m/s
    double angles[3]; // rad, at the onset
    double before[3]; // rad/s
    double after[3];  // rad/s
    double duration_s;
} Impact;

static Impact first_impact(const Scenario *scenario)
{
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    Impact impact = {.duration_s = -1.0};
    Err err = {ERR_NONE, ""};
    void *reference = NULL;
    assert_true(solver->open(scenario, &reference, &err));
    bool has_begun = false;
    double ended_s = 0.0;
    while (impact.duration_s < 0.0) {
        if (!solver->step(reference, INFINITY, &err)) {
            fail_msg("%s", err.text);
        }
        const StepRecord record = solver->record(reference);
        const bool is_touching = record.joints[SLIDER_GUIDE].is_touching;
        if (is_touching && !has_begun) {
            Sample sample = sample_create(&scenario->linkage);
            solver->observe(reference, record.end_s, &sample);
            impact.onset_s = record.end_s;
            impact.approach = record.approach[SLIDER_GUIDE];
            for (int i = 0; i < 3; i++) {
                impact.angles[i] = sample.bodies[i].angle;
                impact.before[i] = record.omega[i];
            }
            sample_free(&sample);
        } else if (has_begun && !is_touching) {
            impact.duration_s = ended_s - impact.onset_s;
        }
        // the step behind the contact is as long as it likes: the contact ends where it begins
        ended_s = record.end_s;
        for (int i = 0; is_touching && i < 3; i++) {
            impact.after[i] = record.omega[i];
        }
        has_begun = is_touching;
    }
    solver->close(reference);
    return impact;
}

static void the_flight_to_the_first_contact_is_that_of_the_double_pendulum(void **state)
{
    (void)state;
    const Scenario scenario = flores(1e8, 0.0);
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    const Motion *motions = trajectory_motion(trajectory, 1, 0);
    assert_near(motions[0].angle, 0.1460908438116, 1e-12);
    assert_near(motions[1].angle, -0.0725963953962, 1e-12);
    assert_near(motions[0].omega, 139.1158757899, 1e-9);
    assert_near(motions[1].omega, -68.2762941942, 1e-9);
    trajectory_destroy(trajectory);
    const Impact impact = first_impact(&scenario);
    assert_near(impact.onset_s, 2.69250275202e-3, 1e-14);
    assert_near(impact.angles[0], 0.355304455028, 2e-12);
    assert_near(impact.angles[1], -0.171509540940, 2e-12);
    assert_near(impact.before[0], 109.557681543, 1e-9);
    assert_near(impact.before[1], -49.330789962, 1e-9);
    assert_near(impact.approach, 0.841612322033, 2e-12);
    // the control: guides a nanometre wider are reached later
    Scenario wider = kept_copy(&scenario);
    wider.linkage.joints[SLIDER_GUIDE].guide.opening += 1e-9;
    assert_true(fabs(first_impact(&wider).onset_s - 2.69250275202e-3) > 1e-10);
}

// What a rigid impact makes of the speeds is reached as the contact gets shorter: its duration, and
// with it all that happens meanwhile, goes with 1 / sqrt(k).
static void check_limit(double friction, double restitution, double rigid[2], double error[3])
{
    Impact impacts[3];
    const double stiffness[3] = {1e8, 1e10, 1e12};
    for (int i = 0; i < 3; i++) {
        Scenario scenario = flores(stiffness[i], friction);
        scenario.contact.restitution = restitution;
        impacts[i] = first_impact(&scenario);
        error[i] = fabs(impacts[i].after[0] - rigid[0]);
    }
    for (int i = 0; i < 2; i++) {
        // the polynomial through the three in 1 / sqrt(k), at 0
        const double limit =
            (impacts[0].after[i] - 110.0 * impacts[1].after[i] + 1000.0 * impacts[2].after[i]) /
            891.0;
        rigid[i] -= limit;
    }
}

static void a_stiff_contact_does_what_a_rigid_impact_does(void **state)
{
    (void)state;
    static const double RIGID[2][3] = {{0.0, 108.793728561, -52.875187875},
                                       {0.01, 108.724580002, -52.842290420}};
    for (int i = 0; i < 2; i++) {
        double rates[2] = {RIGID[i][1], RIGID[i][2]};
        double error[3];
        check_limit(RIGID[i][0], 0.4, rates, error);
        print_message("# friction %g: off by %.3g, %.3g, %.3g rad/s; in the limit %.3g, %.3g\n",
                      RIGID[i][0], error[0], error[1], error[2], rates[0], rates[1]);
        for (int k = 0; k < 2; k++) {
            assert_near(log10(error[k] / error[k + 1]), 1.0, 0.01);
            assert_true(fabs(rates[k]) < 1e-5);
        }
    }
    // the control: a restitution off by a thousandth
    double rates[2] = {RIGID[0][1], RIGID[0][2]};
    double error[3];
    check_limit(0.0, 0.401, rates, error);
    assert_true(fabs(rates[0]) > 1e-4);
}

// A slider that turns a little touches with one corner after the other.
static void a_tilted_block_keeps_the_balance_of_energy(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        Scenario scenario = flores(1e8, i == 1 ? 0.1 : 0.0);
        scenario.linkage.bodies[2].start.omega = -0.01;
        scenario.run.duration = 0.05;
        scenario.run.samples = 1000;
        if (i == 2) {
            // a sleeve round a rod of the same play
            scenario.linkage.joints[SLIDER_GUIDE].guide.opening = 0.050;
            scenario.linkage.joints[SLIDER_GUIDE].guide.height = 0.052;
        }
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        const Energy *energy = &trajectory->energy;
        const JointExtremes *guide = &trajectory->joints[SLIDER_GUIDE];
        print_message("# %zu contacts, lost %.4g J, sliding %.4g J, residual %.2g J\n",
                      guide->impacts, energy->dissipated, energy->friction, energy->residual);
        assert_true(guide->impacts > 10);
        assert_true(energy->dissipated > 1e-2 && (energy->friction > 1e-2) == (i == 1));
        assert_true(fabs(energy->residual) < 1e-9 * energy->dissipated);
        double tilted = 0.0;
        for (size_t k = 0; k < trajectory->sample_count; k++) {
            const JointState *states = trajectory_state(trajectory, k, 0);
            const Motion *motions = trajectory_motion(trajectory, k, 0);
            tilted = fmax(tilted, fabs(states[SLIDER_GUIDE].tilt));
            // the force and couple of the corners are what moves the block
            assert_true(slider_unbalanced(&scenario, motions, states) < 1e-7);
            const double angle = motions[2].angle;
            const double half = 0.5 * scenario.linkage.joints[SLIDER_GUIDE].guide.height;
            const double wall = 0.5 * scenario.linkage.joints[SLIDER_GUIDE].guide.opening;
            const double least = fabs(half * cos(angle) - wall) - 0.05 * fabs(sin(angle)) -
                                 fabs(motions[2].position.y);
            assert_near(states[SLIDER_GUIDE].gap, least, 1e-15);
            assert_near(states[SLIDER_GUIDE].eccentricity.y, motions[2].position.y, 1e-15);
            assert_near(states[SLIDER_GUIDE].tilt, motions[2].angle, 1e-15);
        }
        assert_true(tilted > 1e-4);
        trajectory_destroy(trajectory);
    }
}

// A driven slider-crank with play in the guides, in the pin of the slider, in both, in a guide that
// turns, each without and with friction.
static void driven_sliders_with_play_keep_the_balance_of_energy(void **state)
{
    (void)state;
    // the last is the control: steps that are too long
    for (int i = 0; i < 9; i++) {
        const double friction = i % 2 == 0 ? 0.0 : 0.1;
        Scenario scenario = slider_driven(&SLIDER_USUAL, 5000.0 * 2.0 * M_PI / 60.0);
        if (i == 6 || i == 7) {
            scenario = slider_lever(40.0);
        }
        if (i < 2 || i >= 4) {
            slider_loosen_guide(&scenario, 0.0402, 0.0400, 0.050);
        }
        if (i >= 2 && i < 6) {
            slider_loosen_wrist(&scenario, 0.010, 0.5e-3);
        }
        scenario.contact.stiffness = 1e9;
        scenario.contact.exponent = 1.5;
        scenario.contact.restitution = 0.9;
        scenario.contact.friction = friction;
        scenario.run.revolutions = 0.5;
        scenario.run.samples = 360;
        scenario.reference.tolerance = i < 8 ? 1e-12 : 1e-6;
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        const Energy *energy = &trajectory->energy;
        print_message("# %d: %zu and %zu contacts, work %.4g J, lost %.4g J, sliding %.4g J, "
                      "residual %.2g J\n",
                      i, trajectory->joints[2].impacts, trajectory->joints[3].impacts,
                      energy->drive_work, energy->dissipated, energy->friction, energy->residual);
        assert_true(trajectory->joints[2].impacts + trajectory->joints[3].impacts > 2);
        const double work = fabs(energy->drive_work) + energy->dissipated + energy->friction;
        assert_true((fabs(energy->residual) < 1e-9 * work) == (i < 8));
        assert_true(energy->dissipated > 1e-6 * work);
        assert_true((energy->friction > 1e-6 * work) == (friction > 0.0));
        trajectory_destroy(trajectory);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_flight_to_the_first_contact_is_that_of_the_double_pendulum),
        cmocka_unit_test(a_stiff_contact_does_what_a_rigid_impact_does),
        cmocka_unit_test(a_tilted_block_keeps_the_balance_of_energy),
        cmocka_unit_test(driven_sliders_with_play_keep_the_balance_of_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
