// Are the right runs made, each once, and is what they say put together rightly?
#include "measure/runner.h"
#include "measure/task.h"
#include "run/registry.h"

#include "close.h"
#include "kept.h"
#include "load_case.h"
#include "mechanism.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LADDER_STEP_COUNT = 3, REPEATS = 5 };

static const double LADDER_STEPS[LADDER_STEP_COUNT] = {1e-4, 5e-5, 2.5e-5};

// Two schemes of ODE and the reference, nothing run.
static Ladder *make_unrun_ladder(void)
{
    static const Scheme SCHEMES[3] = {
        {.name = "direct/plain", .backend = BACKEND_ODE},
        {.name = "quick/plain", .backend = BACKEND_ODE, .solver = ODE_QUICK},
        {.name = "reference", .backend = BACKEND_REFERENCE}};
    return ladder_create(SCHEMES, 3, LADDER_STEPS, LADDER_STEP_COUNT, REPEATS);
}

// All runs, with errors of order one and times that grow; the truth is the reference.
static void fill(Ladder *ladder)
{
    ladder->truth = (LadderTruth){.is_known = true, .uncertainty = 1e-6, .horizon_s = 0.06};
    strcpy(ladder->truth.backend, "reference");
    for (size_t i = 0; i < ladder_run_total(ladder); i++) {
        LadderRun run = ladder_run(ladder, i);
        const LadderPoint *point = &ladder->points[run.point];
        const double step_s = point->step_s > 0.0 ? point->step_s : 1e-4;
        run.is_complete = true;
        run.error = (TrajectoryError){.is_known = true, .max = 10.0 * step_s};
        run.error.max_in_horizon = 0.5 * run.error.max;
        run.steps = 100;
        run.wall_s = (1.0 + (double)point->scheme) * 1e-6 / step_s + 1e-5 * (double)run.round;
        assert_true(ladder_add(ladder, &run));
    }
}

static void every_run_stands_once_and_rounds_are_taken_in_turn(void **state)
{
    (void)state;
    Ladder *ladder = make_unrun_ladder();
    assert_int_equal(ladder->point_count, 7);
    assert_int_equal(ladder_run_total(ladder), 7 * (1 + REPEATS));
    assert_int_equal(ladder_run(ladder, 6).kind, LADDER_ERROR);
    assert_int_equal(ladder_run(ladder, 7).kind, LADDER_TIMING);
    assert_int_equal(ladder_run(ladder, 7).round, 0);
    // all points of a round come before the next round
    assert_int_equal(ladder_run(ladder, 13).round, 0);
    assert_int_equal(ladder_run(ladder, 14).round, 1);
    assert_int_equal(ladder_run(ladder, 14).point, 0);
    assert_int_equal(ladder_find(ladder, "quick/plain", 5e-5), 4);
    assert_int_equal(ladder_find(ladder, "reference", 0.0), 6);
    assert_int_equal(ladder_find(ladder, "quick/plain", 5.1e-5), 7);
    ladder_destroy(ladder);
    ladder_destroy(NULL);
}

static void the_pace_of_every_scheme_is_known_early(void **state)
{
    (void)state;
    Ladder *ladder = make_unrun_ladder();
    // two schemes with three steps each, and the reference, which has none
    static const size_t ORDER[] = {0, 3, 1, 4, 6, 2, 5};
    for (size_t i = 0; i < 7; i++) {
        assert_int_equal(ladder_run(ladder, i).point, ORDER[i]);
    }
    LadderRun run = {.point = 0, .is_complete = true, .wall_s = 1.0};
    assert_true(ladder_add(ladder, &run));
    assert_false(ladder_has_pace(ladder));
    run = (LadderRun){.point = 3, .is_complete = true, .wall_s = 10.0};
    assert_true(ladder_add(ladder, &run));
    assert_true(ladder_has_pace(ladder));
    // each scheme by its own pace: 1, 2, 4 s and 10, 20, 40 s
    assert_near(ladder_time_left(ladder, 1), (77.0 - 11.0) + REPEATS * 77.0, 1e-9);
    ladder->truth.wall_s = 3.0;
    assert_near(ladder_time_of_steps(ladder, 2, 1), 3.0 + 33.0 + REPEATS * 33.0, 1e-9);
    assert_near(ladder_time_of_steps(ladder, 0, 1), 3.0, 1e-9);
    ladder_destroy(ladder);
}

static void a_run_is_taken_once(void **state)
{
    (void)state;
    Ladder *ladder = make_unrun_ladder();
    LadderRun run = {.kind = LADDER_ERROR, .point = 1, .is_complete = true, .wall_s = 2.0};
    assert_int_equal(ladder_next(ladder, 0), 0);
    assert_near(ladder_time_left(ladder, 1), 0.0, 0.0);
    assert_true(ladder_add(ladder, &run));
    assert_false(ladder_add(ladder, &run));
    // the error run of point 1 comes third, after those of the coarsest steps
    assert_int_equal(ladder_next(ladder, 2), 3);
    assert_int_equal(ladder_run_done(ladder), 1);
    // points 0, 1, 2 of either scheme take 1, 2, 4 s: six error runs but one, then five rounds of
    // those; that of the reference is not known
    assert_near(ladder_time_left(ladder, 1), (14.0 - 2.0) + REPEATS * 14.0, 1e-9);
    // error runs are made side by side
    assert_near(ladder_time_left(ladder, 2), 0.5 * (14.0 - 2.0) + REPEATS * 14.0, 1e-9);
    run = (LadderRun){.kind = LADDER_TIMING, .point = 1, .round = 2, .is_complete = true};
    assert_true(ladder_add(ladder, &run));
    assert_false(ladder_add(ladder, &run));
    run.round = REPEATS;
    assert_false(ladder_add(ladder, &run));
    run.point = 7;
    assert_false(ladder_add(ladder, &run));
    ladder_destroy(ladder);
}

static void a_failed_point_is_not_timed(void **state)
{
    (void)state;
    Ladder *ladder = make_unrun_ladder();
    LadderRun run = {.kind = LADDER_ERROR, .point = 0, .message = "left the plane"};
    assert_true(ladder_add(ladder, &run));
    assert_int_equal(ladder_run_done(ladder), 1 + REPEATS);
    assert_int_equal(ladder_finest(ladder, 0), 7);
    ladder_conclude(ladder);
    assert_true(ladder->points[0].is_failed);
    assert_string_equal(ladder->points[0].reason, "left the plane");
    assert_string_equal(ladder->points[1].reason, "not run");
    assert_true(isnan(ladder->points[0].error) && isnan(ladder->points[0].wall_median_s));
    ladder_destroy(ladder);
}

static void errors_times_frontier_and_orders_are_put_together(void **state)
{
    (void)state;
    Ladder *ladder = make_unrun_ladder();
    fill(ladder);
    assert_int_equal(ladder_next(ladder, 0), ladder_run_total(ladder));
    ladder_conclude(ladder);
    const LadderPoint *point = &ladder->points[0];
    assert_near(point->error, 1e-3, 1e-15);
    assert_near(point->wall_median_s, 1e-2 + 2e-5, 1e-12);
    assert_near(point->wall_min_s, 1e-2, 1e-12);
    assert_near(point->wall_max_s, 1e-2 + 4e-5, 1e-12);
    assert_false(point->is_limited_by_truth);
    assert_true(ladder->points[0].is_on_frontier && ladder->points[2].is_on_frontier);
    // the slower solver with the same error is not, and the reference is beside it
    assert_false(ladder->points[3].is_on_frontier || ladder->points[6].is_on_frontier);
    assert_near(ladder->points[6].error, 1e-6, 0.0);
    assert_true(ladder->points[6].is_limited_by_truth);
    assert_near(ladder->orders[0].order, 1.0, 1e-9);
    assert_int_equal(ladder->cheapest[0], 0);
    // the error of 1e-3 does not meet 1e-3 with the truth's own 1e-6 on top
    assert_int_equal(ladder->cheapest[1], 1);
    assert_int_equal(ladder->cheapest[2], ladder->point_count);
    assert_int_equal(ladder_finest(ladder, 0), 2);
    ladder_destroy(ladder);
}

static void the_horizon_and_the_uncertainty_limit_what_is_said(void **state)
{
    (void)state;
    Ladder *ladder = make_unrun_ladder();
    fill(ladder);
    ladder->truth.is_limited = true;
    ladder->truth.uncertainty = 2e-5;
    ladder_conclude(ladder);
    assert_near(ladder->points[0].error, 5e-4, 1e-15);
    assert_false(ladder->points[0].is_limited_by_truth);
    assert_true(ladder->points[2].is_limited_by_truth);
    assert_false(ladder->orders[0].is_known);
    ladder_destroy(ladder);
}

static void unstable_and_unknown_errors_are_no_numbers(void **state)
{
    (void)state;
    Ladder *ladder = make_unrun_ladder();
    fill(ladder);
    ladder->points[0].run.error.max = 2.5;
    ladder->points[1].run.error.is_known = false;
    ladder->points[2].run.error.max = NAN;
    strcpy(ladder->points[3].timing_message, "took too long");
    ladder_conclude(ladder);
    assert_non_null(strstr(ladder->points[0].reason, "unstable"));
    assert_non_null(strstr(ladder->points[1].reason, "not finite"));
    assert_true(ladder->points[2].is_failed);
    assert_string_equal(ladder->points[3].reason, "took too long");
    assert_false(ladder->points[0].is_on_frontier);
    ladder_destroy(ladder);
}

static void a_point_without_a_sample_in_the_horizon_has_no_error(void **state)
{
    (void)state;
    Ladder *ladder = make_unrun_ladder();
    fill(ladder);
    ladder->truth.is_limited = true;
    ladder->points[0].run.error.max_in_horizon = NAN;
    ladder_conclude(ladder);
    const LadderPoint *point = &ladder->points[0];
    assert_false(point->is_failed || point->is_on_frontier || point->is_limited_by_truth);
    assert_string_equal(point->reason, "has no error: no sample lies within the horizon");
    assert_true(isnan(point->error) && point->wall_median_s > 0.0);
    assert_int_equal(ladder->cheapest[0], 1);
    ladder_destroy(ladder);
}

// What a runner tells, counted.
typedef struct Counts {
    size_t truths;
    size_t runs;
    size_t ensembles;
    size_t waits;
    size_t stop_after; // runs; 0: never
} Counts;

static bool count_truth(const LadderTruth *truth, void *context, Err *err)
{
    (void)err;
    ((Counts *)context)->truths += truth->is_known ? 1 : 0;
    return true;
}

static bool count_run(const LadderRun *run, void *context, Err *err)
{
    (void)run;
    Counts *counts = context;
    counts->runs++;
    return counts->runs != counts->stop_after || err_set(err, ERR_FILE, "the disk is full");
}

static bool count_ensemble(size_t scheme, const LadderEnsemble *ensemble, void *context, Err *err)
{
    (void)scheme;
    (void)err;
    ((Counts *)context)->ensembles += ensemble->is_known ? 1 : 0;
    return true;
}

static void count_wait(const char *doing, void *context)
{
    (void)doing;
    ((Counts *)context)->waits++;
}

static Runner make_runner(Ladder *ladder, const Scenario *scenario, Counts *counts)
{
    return (Runner){
        .ladder = ladder,
        .scenario = scenario,
        .jobs = 2,
        .time_limit_s = 120.0,
        .listener = {count_truth, count_run, count_ensemble, count_wait, .context = counts},
    };
}

// The ideal mechanism, few samples, direct/plain and the closed form.
static Ladder *make_real(Scenario *scenario)
{
    *scenario = mechanism_paper();
    scenario->run.samples = 90;
    static const Scheme SCHEMES[2] = {{.name = "direct/plain", .backend = BACKEND_ODE},
                                      {.name = "analytic", .backend = BACKEND_ANALYTIC}};
    return ladder_create(SCHEMES, 2, LADDER_STEPS, LADDER_STEP_COUNT, REPEATS);
}

static void a_runner_makes_what_is_missing(void **state)
{
    (void)state;
    Scenario scenario;
    Ladder *ladder = make_real(&scenario);
    Counts counts = {.stop_after = 6};
    const Runner runner = make_runner(ladder, &scenario, &counts);
    Err err = {0};
    assert_false(runner_execute(&runner, &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_int_equal(counts.runs, 6);
    assert_int_equal(ladder_run_made(ladder), 6);
    counts.stop_after = 0;
    err = (Err){0};
    assert_true(runner_execute(&runner, &err));
    // of points that others beat not every timing run is made
    assert_int_equal(counts.runs, ladder_run_made(ladder));
    assert_int_equal(ladder_run_done(ladder), ladder_run_total(ladder));
    assert_int_equal(counts.truths, 1);
    assert_int_equal(counts.ensembles, 0);
    assert_true(counts.waits > 0);
    ladder_conclude(ladder);
    // first order against the closed form
    assert_near(ladder->orders[0].order, 1.0, 0.1);
    assert_true(ladder->points[2].wall_median_s > 0.0);
    ladder_destroy(ladder);
}

static bool stops_after_three(void *context)
{
    return ((const Counts *)context)->runs >= 3;
}

static void a_runner_that_is_stopped_goes_on_later(void **state)
{
    (void)state;
    Scenario scenario;
    Ladder *ladder = make_real(&scenario);
    Counts counts = {0};
    Runner runner = make_runner(ladder, &scenario, &counts);
    runner.listener.should_stop = stops_after_three;
    Err err = {0};
    assert_false(runner_execute(&runner, &err));
    assert_string_equal(err.text, "stopped");
    assert_true(counts.runs < ladder_run_total(ladder));
    assert_int_equal(ladder_run_made(ladder), counts.runs);
    // the control: nobody stops it
    runner.listener.should_stop = NULL;
    err = (Err){0};
    assert_true(runner_execute(&runner, &err));
    assert_int_equal(ladder_run_done(ladder), ladder_run_total(ladder));
    // of points that others beat in error and by far in time all but one timing run are left out
    assert_true(counts.runs >= 2 * ladder->point_count);
    ladder_destroy(ladder);
}

// Of three points one is beaten in error and time, one in time alone.
static void a_point_that_is_beaten_is_timed_once(void **state)
{
    (void)state;
    Ladder *ladder = make_unrun_ladder();
    static const struct {
        size_t point;
        double error;
        double wall_s;
        size_t runs;
    } POINTS[] = {{0, 1e-3, 1.0, REPEATS - 1}, {1, 1e-4, 2.5, REPEATS - 1}, {3, 1e-2, 3.5, 0}};
    for (size_t i = 0; i < 3; i++) {
        LadderRun run = {.point = POINTS[i].point, .is_complete = true, .wall_s = POINTS[i].wall_s};
        run.error = (TrajectoryError){.is_known = true, .max = POINTS[i].error};
        assert_true(ladder_add(ladder, &run));
        run.kind = LADDER_TIMING;
        assert_true(ladder_add(ladder, &run));
    }
    size_t runs[8] = {0};
    for (size_t i = 2 * ladder->point_count; i < ladder_run_total(ladder); i++) {
        runs[ladder_run(ladder, i).point] += ladder_next(ladder, i) == i ? 1 : 0;
    }
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(runs[POINTS[i].point], POINTS[i].runs);
    }
    ladder_destroy(ladder);
}

// One scheme of ODE of order one, and another that at its coarsest step is as fast and nearer.
static void add_error_run(Ladder *ladder, size_t point, double error, double time_s)
{
    LadderRun run = {.point = point, .is_complete = true, .steps = 1000, .processor_s = time_s};
    run.error = (TrajectoryError){.is_known = true, .max = error};
    assert_true(ladder_add(ladder, &run));
}

static void steps_that_cannot_come_to_the_frontier_are_left_out(void **state)
{
    (void)state;
    // the finest is 4 times as fine: order two, and four times below that, leave .1 / 64 at best
    static const struct {
        double error; // of the other scheme
        bool is_whole;
        bool is_left_out;
    } CASES[] = {{1e-3, false, true}, {1e-3, true, false}, {2e-3, false, false}};
    for (size_t i = 0; i < 3; i++) {
        Ladder *ladder = make_unrun_ladder();
        ladder->is_whole = CASES[i].is_whole;
        ladder->truth = (LadderTruth){.is_known = true, .backend = "reference"};
        add_error_run(ladder, 0, 0.1, 1.0);
        add_error_run(ladder, 3, CASES[i].error, 0.9);
        assert_true(ladder->points[1].is_left_out == CASES[i].is_left_out);
        assert_true(ladder->points[2].is_left_out == CASES[i].is_left_out);
        // the other one goes on
        assert_false(ladder->points[4].is_left_out);
        ladder_conclude(ladder);
        assert_true((strncmp(ladder->points[2].reason, "left out", 8) == 0) ==
                    CASES[i].is_left_out);
        ladder_destroy(ladder);
    }
}

// Times of three runs: alike; uneven, with nothing near; uneven, with another point near.
static void times_that_are_clear_need_no_more_runs(void **state)
{
    (void)state;
    static const struct {
        double times[3];
        double other;
        size_t more;
    } CASES[] = {{{1.0, 1.01, 1.02}, 1.1, 0}, {{1.0, 1.3, 1.1}, 2.6, 0}, {{1.0, 1.3, 1.1}, 1.1, 2}};
    for (size_t i = 0; i < 3; i++) {
        Ladder *ladder = make_unrun_ladder();
        ladder->is_whole = false;
        ladder->truth = (LadderTruth){.is_known = true, .is_limited = true};
        add_error_run(ladder, 0, 1e-3, 1.0);
        add_error_run(ladder, 1, 1e-4, 1.0);
        for (size_t round = 0; round < 3; round++) {
            LadderRun run = {.kind = LADDER_TIMING, .round = round, .is_complete = true};
            run.wall_s = CASES[i].times[round];
            assert_true(ladder_add(ladder, &run));
            run.point = 1;
            run.wall_s = CASES[i].other;
            assert_true(ladder_add(ladder, &run));
        }
        size_t more = 0;
        for (size_t k = 0; k < ladder_run_total(ladder); k++) {
            const LadderRun run = ladder_run(ladder, k);
            more += run.kind == LADDER_TIMING && run.point == 0 && ladder_next(ladder, k) == k;
        }
        assert_int_equal(more, CASES[i].more);
        ladder_destroy(ladder);
    }
}

static void a_run_that_hangs_is_a_failed_run(void **state)
{
    (void)state;
    Scenario scenario;
    Ladder *ladder = make_real(&scenario);
    Counts counts = {0};
    scenario.run.revolutions = 100.0;
    Runner runner = make_runner(ladder, &scenario, &counts);
    ladder->truth = (LadderTruth){.is_known = true, .backend = "analytic"};
    for (size_t i = 0; i < ladder->point_count; i++) {
        LadderRun run = ladder_run(ladder, i);
        run.is_complete = true;
        ladder_add(ladder, &run);
    }
    runner.time_limit_s = 1e-6;
    Err err = {0};
    assert_true(runner_execute(&runner, &err));
    ladder_conclude(ladder);
    assert_true(ladder->points[0].is_failed);
    assert_non_null(strstr(ladder->points[0].reason, "took longer than its limit"));
    // one failed timing run is enough: the others of the point are not made
    assert_true(ladder->points[0].is_timed[0] && !ladder->points[0].is_timed[1]);
    ladder_destroy(ladder);
}

static void without_a_truth_there_is_no_comparison(void **state)
{
    (void)state;
    Scenario scenario;
    Ladder *ladder = make_real(&scenario);
    Counts counts = {0};
    scenario.run.revolutions = 100.0;
    Runner runner = make_runner(ladder, &scenario, &counts);
    runner.time_limit_s = 1e-6;
    Err err = {0};
    assert_false(runner_execute(&runner, &err));
    assert_int_equal(err.kind, ERR_SOLVER);
    assert_non_null(strstr(err.text, "there is no reference to compare with"));
    ladder_destroy(ladder);
}

// The longest time that one member of the ensemble of the finest step takes here, s, and not
// nothing.
static double time_of_member(const Scenario *scenario)
{
    Scenario member = kept_copy(scenario);
    member.run.step = LADDER_STEPS[LADDER_STEP_COUNT - 1];
    double longest_s = 1e-3;
    for (int i = 0; i < 9; i++) {
        Trajectory *trajectory = run_scenario(&member, registry_solver(BACKEND_ODE), (RunWatch){0});
        longest_s = fmax(longest_s, trajectory->wall_s);
        trajectory_destroy(trajectory);
    }
    return longest_s;
}

static void ensembles_are_made_beyond_a_horizon(void **state)
{
    (void)state;
    Scenario scenario;
    Ladder *ladder = make_real(&scenario);
    scenario.run.samples = 10;
    fill(ladder);
    ladder->truth.is_limited = true;
    Counts counts = {0};
    Runner runner = make_runner(ladder, &scenario, &counts);
    Err err = {0};
    assert_true(runner_execute(&runner, &err));
    assert_int_equal(counts.ensembles, 2);
    assert_int_equal(counts.runs, 0);
    assert_near(ladder->ensembles[0].step_s, LADDER_STEPS[LADDER_STEP_COUNT - 1], 0.0);
    assert_true(ladder->ensembles[0].ensemble.members > 0);
    // the limit is that of one run, not of all members
    runner.time_limit_s = 0.75 * ENSEMBLE_MEMBERS * time_of_member(&scenario);
    ladder->ensembles[0].is_known = false;
    assert_true(runner_execute(&runner, &err));
    assert_int_equal(ladder->ensembles[0].ensemble.failed, 0);
    // what is known is not made again, and what hangs has failed
    ladder->ensembles[0].is_known = false;
    runner.time_limit_s = 1e-6;
    assert_true(runner_execute(&runner, &err));
    assert_int_equal(counts.ensembles, 4);
    assert_int_equal(ladder->ensembles[0].ensemble.members, 0);
    assert_int_equal(ladder->ensembles[0].ensemble.failed, ENSEMBLE_MEMBERS);
    ladder_destroy(ladder);
}

static void a_task_does_in_this_process_what_it_does_in_a_child(void **state)
{
    (void)state;
    Scenario scenario;
    Ladder *ladder = make_real(&scenario);
    Task task = task_make(ladder, &scenario, ladder_run(ladder, 0), NULL);
    void *packed = calloc(1, truth_pack_size(&scenario));
    task_certify(&task, packed);
    Truth truth = truth_pack_read(&scenario, packed);
    assert_true(truth.trajectory->is_complete);
    assert_int_equal(truth.trajectory->sample_count, 91);
    // the closed form at a sample, against itself without the pipe
    Truth direct = truth_make(&task.scenario, (RunWatch){0});
    assert_memory_equal(truth.trajectory->motions, direct.trajectory->motions,
                        91 * direct.trajectory->body_count * sizeof(Motion));
    assert_near(truth.uncertainty, direct.uncertainty, 0.0);
    truth_finish(&direct);
    task = task_make(ladder, &scenario, ladder_run(ladder, 0), &truth);
    assert_near(task.scenario.run.step, LADDER_STEPS[0], 0.0);
    LadderRun run;
    task_measure(&task, &run);
    assert_true(run.is_complete && run.error.is_known);
    assert_true(run.error.max > 1e-4 && run.error.max < 1e-1);
    assert_true(run.steps > 600 && run.hash != 0 && run.wall_s > 0.0);
    Ensemble ensemble = {0};
    task_spread(&task, &ensemble);
    assert_int_equal(ensemble.members + ensemble.failed, ENSEMBLE_MEMBERS);
    // and with a step that is chosen
    task.scenario.run.step = 0.0;
    task.scenario.run.tolerance = 1e-3;
    task_spread(&task, &ensemble);
    assert_int_equal(ensemble.failed, 0);
    assert_int_equal(ensemble.members, ENSEMBLE_MEMBERS);
    truth_finish(&truth);
    free(packed);
    ladder_destroy(ladder);
}

// The arrays that come out are the reader's own, and what the run was not asked for is not there.
static void what_wore_the_pins_comes_through_the_pipe(void **state)
{
    (void)state;
    const char *const brief[] = {"run.revolutions=0.05"};
    Scenario scenario = load("cases/paper/impact-k66.yaml", brief, 1);
    Truth made = truth_make_uncertified(&scenario, (RunWatch){.progress = NULL});
    assert_non_null(made.trajectory->wear);
    void *packed = calloc(1, truth_pack_size(&scenario));
    truth_pack_write(&made, packed);
    Truth read = truth_pack_read(&scenario, packed);
    assert_ptr_not_equal(read.trajectory->wear, made.trajectory->wear);
    assert_memory_equal(read.trajectory->wear, made.trajectory->wear,
                        made.trajectory->joint_count * sizeof(JointWear));
    assert_null(read.trajectory->contacts);
    assert_null(read.trajectory->marked);
    truth_finish(&read);
    truth_finish(&made);
    free(packed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_run_stands_once_and_rounds_are_taken_in_turn),
        cmocka_unit_test(the_pace_of_every_scheme_is_known_early),
        cmocka_unit_test(a_run_is_taken_once),
        cmocka_unit_test(a_failed_point_is_not_timed),
        cmocka_unit_test(errors_times_frontier_and_orders_are_put_together),
        cmocka_unit_test(the_horizon_and_the_uncertainty_limit_what_is_said),
        cmocka_unit_test(unstable_and_unknown_errors_are_no_numbers),
        cmocka_unit_test(a_point_without_a_sample_in_the_horizon_has_no_error),
        cmocka_unit_test(a_runner_makes_what_is_missing),
        cmocka_unit_test(a_runner_that_is_stopped_goes_on_later),
        cmocka_unit_test(a_point_that_is_beaten_is_timed_once),
        cmocka_unit_test(steps_that_cannot_come_to_the_frontier_are_left_out),
        cmocka_unit_test(times_that_are_clear_need_no_more_runs),
        cmocka_unit_test(a_run_that_hangs_is_a_failed_run),
        cmocka_unit_test(without_a_truth_there_is_no_comparison),
        cmocka_unit_test(ensembles_are_made_beyond_a_horizon),
        cmocka_unit_test(a_task_does_in_this_process_what_it_does_in_a_child),
        cmocka_unit_test(what_wore_the_pins_comes_through_the_pipe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
