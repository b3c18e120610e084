// Does the reference give what can be known of one impact without any integrator?
#include "complete_run.h"

#include "mechanism.h"

#include "contact/damping.h"
#include "run/registry.h"
#include "run/run.h"

#include <stdio.h>

static const RunWatch NOBODY = {NULL, NULL};

// A pin that flies across its hole at a speed and hits the wall once.
static Scenario flight(double mass, double speed, double stiffness)
{
    Scenario scenario = mechanism_pin(mass, 1e-3);
    scenario.contact.stiffness = stiffness;
    scenario.contact.exponent = 1.5;
    scenario.contact.damping = DAMPING_NONE;
    scenario.linkage.bodies[0].start.velocity.x = speed;
    scenario.run.samples = 2;
    return scenario;
}

// Two steel spheres of radius 10 mm at 1 m/s, 7800 kg/m^3, E = 207 GPa, nu = 0.29: depth 20.5598
// micron, peak 993.2175 N, 60.5131 us. Each is the other's mirror image, so half of the mass flies
// against a rigid wall with the pair's stiffness.
static void an_undamped_hertz_impact_is_that_of_the_closed_form(void **state)
{
    (void)state;
    const double radius = 10e-3;
    const double mass = 0.5 * 7800.0 * 4.0 / 3.0 * M_PI * radius * radius * radius;
    const double modulus = 2.07e11 / (2.0 * (1.0 - 0.29 * 0.29));
    const double stiffness = 4.0 / 3.0 * modulus * sqrt(0.5 * radius);
    Scenario scenario = flight(mass, 1.0, stiffness);
    scenario.run.duration = 1.2e-3;
    scenario.reference.tolerance = 1e-13;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    const Spike *spike = &trajectory->joints[0].spikes[0];
    const double depth = pow(5.0 * mass / (4.0 * stiffness), 0.4);
    // 2.943275...: twice the integral of 1 / sqrt(1 - x^2.5) from 0 to 1, by its gamma functions
    const double duration = 2.0 * depth * sqrt(M_PI) * tgamma(1.0 + 0.4) / tgamma(0.5 + 0.4);
    assert_close(depth, 20.5598e-6, 3e-6);
    assert_close(spike->penetration_max, depth, 1e-9);
    assert_close(spike->force_max, stiffness * pow(depth, 1.5), 1e-9);
    assert_close(spike->force_max, 993.2175, 1e-6);
    assert_close(spike->duration_s, duration, 1e-9);
    assert_close(spike->duration_s, 60.5131e-6, 1e-5);
    assert_close(spike->impulse, 2.0 * mass, 1e-9);
    assert_near(trajectory_motion(trajectory, 2, 0)->velocity.x, -1.0, 1e-9);
    trajectory_destroy(trajectory);
}

// What each law delivers follows from chi (1 + e) = ln((1 + chi) / (1 - chi e)).
static void every_damping_law_delivers_its_exact_restitution(void **state)
{
    (void)state;
    const DampingKind kinds[] = {DAMPING_LANKARANI_NIKRAVESH,
                                 DAMPING_HUNT_CROSSLEY,
                                 DAMPING_FLORES,
                                 DAMPING_GONTHIER,
                                 DAMPING_HU_GUO,
                                 DAMPING_EXACT};
    const double asked[] = {0.9, 0.7, 0.5, 0.3, 0.1};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        for (size_t k = 0; k < sizeof asked / sizeof *asked; k++) {
            Scenario scenario = flight(0.1, 0.5, 6.6e10);
            scenario.contact.damping = kinds[i];
            scenario.contact.restitution = asked[k];
            scenario.run.duration = 2.4e-3;
            Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
            const double expected = damping_delivered(damping_factor(kinds[i], asked[k]));
            const double delivered = -trajectory_motion(trajectory, 2, 0)->velocity.x / 0.5;
            assert_near(delivered, expected, 1e-6);
            trajectory_destroy(trajectory);
        }
    }
    assert_near(damping_delivered(damping_factor(DAMPING_EXACT, 0.5)), 0.5, 1e-12);
}

static void a_linear_damper_delivers_its_closed_form(void **state)
{
    (void)state;
    const double asked[] = {0.9, 0.5, 0.1};
    for (size_t k = 0; k < sizeof asked / sizeof *asked; k++) {
        Scenario scenario = flight(0.1, 0.5, 1e7);
        scenario.contact.exponent = 1.0;
        scenario.contact.damping = DAMPING_VISCOUS;
        scenario.contact.viscous_coefficient =
            2.0 * damping_linear_ratio(asked[k]) * sqrt(1e7 * 0.1);
        scenario.run.duration = 3.5e-3;
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        const double delivered = -trajectory_motion(trajectory, 2, 0)->velocity.x / 0.5;
        assert_near(delivered, asked[k], 1e-9);
        trajectory_destroy(trajectory);
    }
}

// Energy over a turn, with play in one, two and three joints, with friction and without.
static void energy_is_accounted_for_to_a_share_of_1e_10(void **state)
{
    (void)state;
    const char *const joints[] = {"crank-coupler", "coupler-follower", "follower-ground"};
    Scenario scenario = mechanism_paper();
    scenario.contact.stiffness = 6.6e10;
    for (int i = 0; i < 3; i++) {
        mechanism_loosen(&scenario, joints[i]);
        for (int k = 0; k < 2; k++) {
            scenario.contact.friction = 0.1 * k;
            Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
            const Energy *energy = &trajectory->energy;
            assert_true(energy->dissipated > 0.0);
            assert_true(k == 0 || energy->friction > 1.0);
            // the drive gives and takes back 40 J in a turn; what it leaves is some 0.1 to 2 J
            if (!(fabs(energy->residual) <= 1e-10 * fabs(energy->drive_work))) {
                fail_msg("%d joints, friction %g: residual %.3g J of %.3g J", i + 1,
                         scenario.contact.friction, energy->residual, energy->drive_work);
            }
            trajectory_destroy(trajectory);
        }
    }
}

static void ideal_loops_stay_closed_and_follow_the_closed_form(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.revolutions = 3.0;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    Trajectory *truth = run_scenario(&scenario, registry_solver(BACKEND_ANALYTIC), NOBODY);
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        for (size_t joint = 1; joint < 4; joint++) {
            const JointState *state_now = trajectory_state(trajectory, k, joint);
            assert_true(vec2_length(state_now->eccentricity) < 1e-12);
            assert_near(state_now->force, trajectory_state(truth, k, joint)->force, 1e-6);
        }
        assert_near(trajectory_motion(trajectory, k, 2)->omega,
                    trajectory_motion(truth, k, 2)->omega, 1e-9 * 80.0);
        assert_near(trajectory_motion(trajectory, k, 1)->alpha,
                    trajectory_motion(truth, k, 1)->alpha, 1e-9 * 12000.0);
    }
    trajectory_destroy(trajectory);
    trajectory_destroy(truth);
}

// The first impact's speed is that of a free flight across the play, sqrt(2 a c): with the play
// going to zero, omega tends to the ideal one with its square root.
static void with_play_going_to_zero_the_motion_becomes_the_ideal_one(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.contact.stiffness = 1e14;
    scenario.run.revolutions = 0.1;
    Trajectory *truth = run_scenario(&scenario, registry_solver(BACKEND_ANALYTIC), NOBODY);
    mechanism_loosen(&scenario, "crank-coupler");
    double last = 0.0;
    for (int decade = 4; decade <= 7; decade++) {
        Clearance *clearance = &scenario.linkage.joints[1].clearance;
        clearance->hole_radius = clearance->pin_radius + pow(10.0, -decade);
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        double largest = 0.0;
        for (size_t k = 0; k < trajectory->sample_count; k++) {
            largest = fmax(largest, fabs(trajectory_motion(trajectory, k, 1)->omega -
                                         trajectory_motion(truth, k, 1)->omega));
        }
        if (decade > 4) {
            assert_near(log10(last / largest), 0.5, 0.1);
        }
        last = largest;
        trajectory_destroy(trajectory);
    }
    trajectory_destroy(truth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_undamped_hertz_impact_is_that_of_the_closed_form),
        cmocka_unit_test(every_damping_law_delivers_its_exact_restitution),
        cmocka_unit_test(a_linear_damper_delivers_its_closed_form),
        cmocka_unit_test(energy_is_accounted_for_to_a_share_of_1e_10),
        cmocka_unit_test(ideal_loops_stay_closed_and_follow_the_closed_form),
        cmocka_unit_test(with_play_going_to_zero_the_motion_becomes_the_ideal_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
