// Does a program made by hand for the paper's case alone have the reference's motion?
//
// It has other coordinates, its own equations of motion, and its own way to end steps at contacts
// (tests/support/hand_paper.c): what both have is true of the case, or both are wrong the same way.
#include "hand_paper.h"
#include "load_case.h"

#include "run/registry.h"
#include "run/run.h"

#include <stdlib.h>

enum { INTERVALS = 3600, FIRST_BODY = 1, PIN = 1 };

// Largest differences over the largest value in the reference: 1.
typedef struct Apart {
    double omega;
    double alpha;
    double force;
    double eccentricity;
} Apart;

static void widen(double own, double other, double *apart)
{
    const double difference = fabs(own - other);
    *apart = difference <= *apart ? *apart : difference; // a NaN stays
}

static Apart compare(const Trajectory *run, const HandPaperSample *samples)
{
    Apart apart = {0.0, 0.0, 0.0, 0.0};
    Apart most = apart;
    for (size_t k = 0; k <= INTERVALS; k++) {
        const HandPaperSample *hand = &samples[k];
        for (size_t i = 0; i < HAND_PAPER_BODIES; i++) {
            const Motion *motion = trajectory_motion(run, k, FIRST_BODY + i);
            widen(hand->omega[i], motion->omega, &apart.omega);
            widen(hand->alpha[i], motion->alpha, &apart.alpha);
            widen(0.0, motion->omega, &most.omega);
            widen(0.0, motion->alpha, &most.alpha);
        }
        const JointState *pin = trajectory_state(run, k, PIN);
        widen(hand->force, pin->force, &apart.force);
        widen(hand->eccentricity.x, pin->eccentricity.x, &apart.eccentricity);
        widen(hand->eccentricity.y, pin->eccentricity.y, &apart.eccentricity);
        widen(0.0, pin->force, &most.force);
        widen(0.0, pin->eccentricity.x, &most.eccentricity);
    }
    return (Apart){apart.omega / most.omega, apart.alpha / most.alpha, apart.force / most.force,
                   apart.eccentricity / most.eccentricity};
}

static Apart compare_at(double tolerance)
{
    const char *const settings[] = {"run.start=centred", "contact.resting-speed=0.3 m/s"};
    const Scenario scenario = load("cases/paper/impact-k66.yaml", settings, 2);
    Trajectory *run =
        run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
    assert_true(run->is_complete);
    HandPaperSample *samples = calloc(INTERVALS + 1, sizeof *samples);
    assert_true(hand_paper_run(tolerance, INTERVALS, samples) > 0);
    const Apart apart = compare(run, samples);
    free(samples);
    trajectory_destroy(run);
    return apart;
}

static void a_program_made_by_hand_has_the_motion_and_forces_of_the_reference(void **state)
{
    (void)state;
    const Apart apart = compare_at(1e-12);
    // what the program's own tolerance leaves: at 1e-11 ten times as much
    assert_true(apart.omega < 1e-10);
    assert_true(apart.eccentricity < 1e-8); // a sum of links of 0.3 m, 20,000 plays
    // an error of omega within a half-period of the contact, some 1e-4 s
    assert_true(apart.alpha < 1e-8);
    assert_true(apart.force < 1e-8);
}

static void one_at_a_looser_tolerance_is_seen_to_be_off(void **state)
{
    (void)state;
    const Apart apart = compare_at(1e-6);
    assert_true(apart.omega > 1e-6);
    assert_true(apart.force > 1e-5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_program_made_by_hand_has_the_motion_and_forces_of_the_reference),
        cmocka_unit_test(one_at_a_looser_tolerance_is_seen_to_be_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
