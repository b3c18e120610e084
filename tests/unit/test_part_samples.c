// Is every sample of mechanisms side by side taken once, from the step of its mechanism that holds
// it?
#include "close.h"

#include "mechanism.h"

#include "run/run.h"

#include <stdlib.h>

// The reference, and where its last steps were.
typedef struct Watched {
    void *state; // of the reference
    StepRecord last;
} Watched;

static size_t part_looks; // at mechanisms by themselves
static size_t outside;    // of these, before or behind the last step of its own

static bool watched_open(const Scenario *scenario, void **state, Err *err)
{
    Watched *watched = calloc(1, sizeof *watched);
    assert_non_null(watched);
    *state = watched;
    return REFERENCE_SOLVER.open(scenario, &watched->state, err);
}

static bool watched_step(void *state, double stop_s, Err *err)
{
    Watched *watched = state;
    const bool is_stepped = REFERENCE_SOLVER.step(watched->state, stop_s, err);
    watched->last = REFERENCE_SOLVER.record(watched->state);
    return is_stepped;
}

static StepRecord watched_record(const void *state)
{
    return ((const Watched *)state)->last;
}

static void watched_observe(const void *state, double time_s, Sample *sample)
{
    REFERENCE_SOLVER.observe(((const Watched *)state)->state, time_s, sample);
}

static void watched_observe_part(const void *state, double time_s, Sample *sample)
{
    const Watched *watched = state;
    const double rounding_s = 1e-9 * (watched->last.end_s - watched->last.start_s);
    part_looks++;
    outside +=
        time_s < watched->last.start_s - rounding_s || time_s > watched->last.end_s + rounding_s
            ? 1
            : 0;
    REFERENCE_SOLVER.observe_part(watched->state, time_s, sample);
}

static SolverModel watched_model(const void *state)
{
    return REFERENCE_SOLVER.model(((const Watched *)state)->state);
}

static void watched_close(void *state)
{
    Watched *watched = state;
    REFERENCE_SOLVER.close(watched->state);
    free(watched);
}

static const Solver WATCHED = {
    .name = "watched",
    .open = watched_open,
    .step = watched_step,
    .record = watched_record,
    .observe = watched_observe,
    .observe_part = watched_observe_part,
    .model = watched_model,
    .close = watched_close,
};

// Two pins in holes of their own: one in flight at first; the other presses from time zero on, so
// that its first step has no length.
static Scenario make_two_pins(void)
{
    enum { COUNT = 2 };
    Scenario one = mechanism_pin(1.0, 1e-5);
    Scenario scenario = one;
    scenario.linkage = linkage_create((LinkageRoom){.bodies = COUNT, .joints = COUNT});
    for (int i = 0; i < COUNT; i++) {
        Body *body = &scenario.linkage.bodies[scenario.linkage.body_count++];
        Joint *joint = &scenario.linkage.joints[scenario.linkage.joint_count++];
        *body = one.linkage.bodies[0];
        *joint = one.linkage.joints[0];
        joint->body_b = i;
        body->start.position.x = i == 0 ? 9e-6 : 1e-5;
        body->start.velocity.x = 0.5;
    }
    linkage_free(&one.linkage);
    scenario.run.duration = 1e-3;
    scenario.gravity = scenario_downward(9.81);
    return scenario;
}

static void samples_stand_in_the_last_step_of_their_mechanism(void **state)
{
    (void)state;
    // steps in flight are down to 0.25 us: up to 25 samples in each, and less than one; the first
    // step of one holds samples where that of the other holds that at time zero alone
    const size_t counts[] = {2, 1000, 100000};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        Scenario scenario = make_two_pins();
        scenario.run.samples = counts[i];
        part_looks = 0;
        outside = 0;
        Trajectory *run = run_scenario(&scenario, &WATCHED, (RunWatch){NULL, NULL});
        assert_string_equal(run->message, "");
        assert_int_equal(part_looks, 2 * run->sample_count);
        assert_int_equal(outside, 0);
        trajectory_destroy(run);
        linkage_free(&scenario.linkage);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_stand_in_the_last_step_of_their_mechanism),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
