// Is ODE of second order when it is read as a leapfrog: with ideal joints, with play, with
// friction?
//
// Outside truths: the closed form of the four-bar with ideal joints, the reference with play.
#include "mechanism.h"
#include "ode_error.h"

#include "kept.h"
#include "model/kinematics.h"

#include <stdlib.h>

static Scenario ideal(OdeStepping stepping)
{
    Scenario scenario = mechanism_paper();
    scenario.ode.stepping = stepping;
    return scenario;
}

static Scenario loose(OdeMap map, size_t joints)
{
    Scenario scenario = mechanism_loose(joints);
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = map;
    return scenario;
}

static void ideal_joints_are_of_second_order_from_the_first_sample_on(void **state)
{
    (void)state;
    const Scenario scenario = ideal(ODE_STAGGERED);
    const OdeClimb climb = ode_climb(&scenario, BACKEND_ANALYTIC, 125e-6, 2.0, 4);
    for (size_t i = 0; i + 1 < climb.count; i++) {
        // the h^3 term is below 1 % here; 0.15 leaves room for where the largest error falls
        assert_near(ode_climb_order(&climb, i, i + 1), 2.0, 0.15);
        assert_near(ode_order(climb.errors[i].alpha_max, climb.errors[i + 1].alpha_max, 2.0), 2.0,
                    0.15);
    }
}

// The control: the same world read at the end of the step, as the manual has it.
static void plain_stepping_is_of_first_order_and_a_hundred_times_worse(void **state)
{
    (void)state;
    const Scenario plain = ideal(ODE_PLAIN);
    const OdeClimb climb = ode_climb(&plain, BACKEND_ANALYTIC, 62.5e-6, 2.0, 3);
    assert_near(ode_climb_order(&climb, 0, 2), 1.0, 0.15);
    const double at_end = ode_error_at(plain, BACKEND_ANALYTIC, 10e-6).max;
    const double leapfrog = ode_error_at(ideal(ODE_STAGGERED), BACKEND_ANALYTIC, 10e-6).max;
    assert_true(at_end > 100.0 * leapfrog);
}

// What is largest in the first turn of a run and in its last.
typedef struct Turns {
    double errors[2];   // 1, of omega
    double openings[2]; // m, of any joint
} Turns;

static Turns first_and_last(const Scenario *scenario)
{
    Trajectory *ode = complete_run(scenario, BACKEND_ODE);
    Trajectory *exact = complete_run(scenario, BACKEND_ANALYTIC);
    double *errors = calloc(ode->sample_count, sizeof *errors);
    DistanceMeasure measure = distance_measure(exact);
    assert_true(error_series(ode, exact, &measure, errors));
    distance_finish(&measure);
    Turns turns = {{0.0}, {0.0}};
    for (size_t k = 0; k <= scenario->run.samples; k++) {
        const size_t samples[2] = {k, ode->sample_count - 1 - k};
        for (int i = 0; i < 2; i++) {
            const Motion *bodies = trajectory_motion(ode, samples[i], 0);
            turns.errors[i] = fmax(turns.errors[i], errors[samples[i]]);
            turns.openings[i] =
                fmax(turns.openings[i], kinematics_closure_error(&scenario->linkage, bodies));
        }
    }
    free(errors);
    trajectory_destroy(ode);
    trajectory_destroy(exact);
    return turns;
}

static void a_hundred_turns_leave_no_drift(void **state)
{
    (void)state;
    Scenario scenario = ideal(ODE_STAGGERED);
    scenario.run.revolutions = 100.0;
    scenario.run.samples = 60;
    scenario.run.step = 20e-6;
    const Turns turns = first_and_last(&scenario);
    // nothing is added up but the joint rows' rounding: a fifth is far more than that
    assert_true(turns.errors[1] <= 1.2 * turns.errors[0]);
    assert_true(turns.errors[0] < 1e-5);
    // a joint stays open by (h^2 / 2) |w^2 r| of its two arms, of which the crank's w^2 r is
    // 592 m/s^2 and the other links' are no larger
    const double opening = 0.5 * scenario.run.step * scenario.run.step * 2.0 * 592.0;
    assert_true(turns.openings[0] <= opening && turns.openings[1] <= opening);
    // control: joint rows that do not take errors back open by millimetres
    scenario.ode.stepping = ODE_PLAIN;
    scenario.ode.erp = 0.0;
    const Turns adrift = first_and_last(&scenario);
    assert_true(adrift.errors[1] > 10.0 * adrift.errors[0]);
    assert_true(adrift.openings[1] > 1e-3);
}

static void the_midpoint_map_is_of_second_order_with_play(void **state)
{
    (void)state;
    const Scenario scenario = loose(ODE_MAP_MIDPOINT, 1);
    const OdeClimb climb = ode_climb(&scenario, BACKEND_REFERENCE, 10e-6, sqrt(10.0), 4);
    for (size_t i = 0; i + 1 < climb.count; i++) {
        // onsets fall into steps by chance, and an order of 1 would be seen by far
        assert_near(ode_climb_order(&climb, i, i + 1), 2.0, 0.15);
    }
    assert_true(climb.errors[3].omega_max < 3e-6);
}

// The control: the damper at the step's end instead of its middle.
static void the_corrected_map_is_of_first_order_below_three_microseconds(void **state)
{
    (void)state;
    const Scenario scenario = loose(ODE_MAP_CORRECTED, 1);
    const OdeClimb climb = ode_climb(&scenario, BACKEND_REFERENCE, 3e-6, sqrt(10.0), 3);
    // onsets in a step's first or second half make 0.8 of it between neighbours
    assert_near(ode_climb_order(&climb, 0, 2), 1.0, 0.25);
}

// Over six steps, each half the one before: where in its step an impact falls makes the orders from
// one to the next scatter by chance, between 1 and 3 with friction in three joints, and little is
// left of it over 1.5 decades. With bodies that answer the contacts as at mid-step throughout the
// order is seen down to the last step; with what turns in a step errors are too small for that, as
// those of the local steps show below 3e-10.
static void contacts_within_the_step_are_of_second_order(void **state)
{
    (void)state;
    const struct {
        size_t joints;
        double friction; // 1
        size_t gear;     // 1
        double first_s;  // s, below which one power of the step is left
    } rows[] = {
        {1, 0.0, 1, 8e-6},  {1, 0.1, 1, 4e-6},  {3, 0.0, 1, 8e-6},
        {3, 0.1, 1, 16e-6}, {1, 0.0, 4, 16e-6},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        Scenario scenario = loose(ODE_MAP_IMPULSE, rows[i].joints);
        scenario.contact.friction = rows[i].friction;
        scenario.ode.gear = rows[i].gear;
        const OdeClimb climb = ode_climb(&scenario, BACKEND_REFERENCE, rows[i].first_s, 2.0, 4);
        scenario.ode.is_frozen = true;
        const OdeClimb frozen = ode_climb(&scenario, BACKEND_REFERENCE, rows[i].first_s, 2.0, 6);
        assert_near(ode_climb_order(&frozen, 0, 5), 2.0, 0.15);
        for (size_t k = 0; k < climb.count; k++) {
            assert_true(climb.errors[k].omega_max < 0.5 * frozen.errors[k].omega_max);
        }
    }
}

// The reference's forces and energy. An ideal joint holds as its bodies turn within the step, too:
// what the rows of ODE's step at mid-step do is 3/8 of the centripetal force short of it.
static void contacts_within_the_step_leave_the_ideal_joints_their_forces(void **state)
{
    (void)state;
    for (size_t joint = 1; joint < 3; joint++) {
        Scenario scenario = loose(ODE_MAP_IMPULSE, 1);
        Joint *joints = scenario.linkage.joints;
        const Joint loosened = joints[1];
        joints[1].kind = JOINT_REVOLUTE;
        joints[joint].kind = JOINT_CLEARANCE;
        joints[joint].clearance = loosened.clearance;
        scenario.run.step = 2e-6;
        Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
        Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
        for (size_t i = 0; i < scenario.linkage.joint_count; i++) {
            double largest = 0.0;
            double apart = 0.0;
            for (size_t k = 0; k < truth->sample_count; k++) {
                const Vec2 given = trajectory_state(truth, k, i)->force_on_b;
                const Vec2 found = trajectory_state(ode, k, i)->force_on_b;
                largest = fmax(largest, vec2_length(given));
                apart = fmax(apart, vec2_length(vec2_sub(found, given)));
            }
            assert_true(apart < 1e-3 * largest);
        }
        assert_near(ode->energy.residual, 0.0, 1e-5 * fabs(truth->energy.change));
        trajectory_destroy(ode);
        trajectory_destroy(truth);
    }
}

static void contacts_within_the_step_allow_steps_longer_than_a_contact(void **state)
{
    (void)state;
    // 900 steps a turn, 66.7 us, where a contact lasts 30 to 60 us
    const double step_s = 0.06 / 900.0;
    assert_true(ode_error_at(loose(ODE_MAP_IMPULSE, 1), BACKEND_REFERENCE, step_s).omega_max <
                1e-3);
    // control: a row a step cannot follow them at a sixth of that step
    const Scenario rows = loose(ODE_MAP_MIDPOINT, 1);
    assert_true(ode_error_at(rows, BACKEND_REFERENCE, step_s / 6.0).max > 1e-3);
}

static void the_quick_solver_is_as_good_where_it_iterates_enough(void **state)
{
    (void)state;
    Scenario scenario = ideal(ODE_STAGGERED);
    const double direct = ode_error_at(scenario, BACKEND_ANALYTIC, 1e-5).max;
    scenario.ode.solver = ODE_QUICK;
    scenario.ode.iterations = 50;
    assert_close(ode_error_at(scenario, BACKEND_ANALYTIC, 1e-5).max, direct, 0.05);
    // control: too few of them leave an error of their own
    scenario.ode.iterations = 2;
    assert_true(ode_error_at(scenario, BACKEND_ANALYTIC, 1e-5).max > 10.0 * direct);
    // with play six joint rows are left, and 20 iterations solve them
    for (int map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map++) {
        Scenario played = loose((OdeMap)map, 1);
        const double solved = ode_error_at(played, BACKEND_REFERENCE, 2e-6).omega_max;
        played.ode.solver = ODE_QUICK;
        assert_close(ode_error_at(played, BACKEND_REFERENCE, 2e-6).omega_max, solved, 0.05);
    }
}

static uint64_t hash_of(const Scenario *scenario)
{
    Trajectory *trajectory = complete_run(scenario, BACKEND_ODE);
    const uint64_t hash = trajectory->hash;
    trajectory_destroy(trajectory);
    return hash;
}

static void the_same_run_twice_has_the_same_hash(void **state)
{
    (void)state;
    for (int map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map++) {
        for (int solver = ODE_DIRECT; solver <= ODE_QUICK; solver++) {
            Scenario scenario = loose((OdeMap)map, 2);
            scenario.ode.solver = (OdeSolver)solver;
            scenario.run.step = 5e-6;
            const uint64_t first = hash_of(&scenario);
            assert_true(hash_of(&scenario) == first);
            // control: a hash that sees the step and, of the quick solver, the seed
            Scenario other = kept_copy(&scenario);
            other.ode.seed++;
            assert_int_equal(hash_of(&other) == first, solver == ODE_DIRECT);
            other.run.step = 4e-6;
            assert_true(hash_of(&other) != first);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ideal_joints_are_of_second_order_from_the_first_sample_on),
        cmocka_unit_test(plain_stepping_is_of_first_order_and_a_hundred_times_worse),
        cmocka_unit_test(a_hundred_turns_leave_no_drift),
        cmocka_unit_test(the_midpoint_map_is_of_second_order_with_play),
        cmocka_unit_test(the_corrected_map_is_of_first_order_below_three_microseconds),
        cmocka_unit_test(contacts_within_the_step_are_of_second_order),
        cmocka_unit_test(contacts_within_the_step_leave_the_ideal_joints_their_forces),
        cmocka_unit_test(contacts_within_the_step_allow_steps_longer_than_a_contact),
        cmocka_unit_test(the_quick_solver_is_as_good_where_it_iterates_enough),
        cmocka_unit_test(the_same_run_twice_has_the_same_hash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
