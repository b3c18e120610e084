// What do the runs of a ladder say about speed against error?
#include "base/sorted.h"
#include "measure/frontier.h"
#include "measure/ladder.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const double LADDER_TARGETS[LADDER_TARGET_COUNT] = {1e-2, 1e-3, 1e-4, 1e-5};

static bool is_truth(const Ladder *ladder, const LadderPoint *point)
{
    return strcmp(point->name, ladder->truth.backend) == 0;
}

static double error_of(const Ladder *ladder, const LadderPoint *point)
{
    const LadderTruth *truth = &ladder->truth;
    // the truth against itself has no error but its uncertainty
    if (is_truth(ladder, point)) {
        return truth->uncertainty;
    }
    const TrajectoryError *error = &point->run.error;
    return error_of_run(error, truth->is_limited);
}

static void explain(LadderPoint *point, const char *reason)
{
    snprintf(point->reason, sizeof point->reason, "%s", reason);
}

static void fail(LadderPoint *point, const char *reason)
{
    point->is_failed = true;
    explain(point, reason);
}

// Why a run that is complete and finite has no error all the same.
static const char *why_without_error(const Ladder *ladder, const LadderPoint *point)
{
    const LadderTruth *truth = &ladder->truth;
    if (truth->message[0] != '\0') {
        return "has no error: the truth could not be certified";
    }
    if (is_truth(ladder, point)) {
        return "has no error: the truth's own uncertainty is not known";
    }
    return "has no error: no sample lies within the horizon";
}

static void judge(const Ladder *ladder, LadderPoint *point)
{
    point->is_failed = false;
    point->reason[0] = '\0';
    point->error = NAN;
    const char *unstable = error_is_unstable(&point->run.error, ladder->truth.is_limited);
    if (!point->is_measured) {
        fail(point, "not run");
    } else if (!point->run.is_complete) {
        fail(point, point->run.message);
    } else if (point->timing_message[0] != '\0') {
        fail(point, point->timing_message);
    } else if (!point->run.error.is_known) {
        fail(point, "has no error: its numbers are not finite");
    } else if ((ladder->truth.is_limited || is_truth(ladder, point)) &&
               !isfinite(error_of(ladder, point))) {
        explain(point, why_without_error(ladder, point));
    } else if (unstable != NULL) {
        fail(point, unstable);
    } else {
        point->error = error_of(ladder, point);
    }
    point->is_limited_by_truth =
        !point->is_failed && point->error < ERROR_CLEAR_OF_TRUTH * ladder->truth.uncertainty;
}

static void time_point(const Ladder *ladder, LadderPoint *point)
{
    double sorted[LADDER_REPEAT_MAX];
    size_t count = 0;
    for (size_t i = 0; i < ladder->repeats; i++) {
        if (point->is_timed[i] && isfinite(point->wall_s[i])) {
            sorted[count++] = point->wall_s[i];
        }
    }
    point->wall_median_s = point->wall_min_s = point->wall_max_s = NAN;
    if (count == 0 || point->is_failed) {
        return;
    }
    sorted_make(sorted, count);
    point->wall_median_s = sorted_median(sorted, count);
    point->wall_min_s = sorted[0];
    point->wall_max_s = sorted[count - 1];
}

static void fit_orders(Ladder *ladder)
{
    double errors[LADDER_STEP_MAX];
    for (size_t scheme = 0; scheme < ladder->scheme_count; scheme++) {
        size_t count = 0;
        for (size_t i = 0; i < ladder->point_count; i++) {
            if (ladder->points[i].scheme == scheme && ladder->points[i].step_s > 0.0) {
                errors[count++] = ladder->points[i].error;
            }
        }
        ladder->orders[scheme] = order_fit(count, ladder->steps, errors,
                                           ERROR_CLEAR_OF_TRUTH * ladder->truth.uncertainty);
    }
}

// The frontier and the cheapest points are ODE's: the other solvers stand beside them.
static void rank_points(Ladder *ladder)
{
    const size_t count = ladder->point_count;
    double *times = calloc(count + 1, sizeof *times);
    double *errors = calloc(count + 1, sizeof *errors);
    bool *marks = calloc(count + 1, sizeof *marks);
    assert(times != NULL && errors != NULL && marks != NULL);
    for (size_t i = 0; i < count; i++) {
        const LadderPoint *point = &ladder->points[i];
        const bool is_ode = ladder->schemes[point->scheme].backend == BACKEND_ODE;
        times[i] = is_ode ? point->wall_median_s : NAN;
        errors[i] = point->error;
    }
    frontier_mark(count, times, errors, marks);
    for (size_t i = 0; i < count; i++) {
        ladder->points[i].is_on_frontier = marks[i];
    }
    for (size_t i = 0; i < LADDER_TARGET_COUNT; i++) {
        ladder->cheapest[i] =
            frontier_cheapest(count, times, errors, ladder->truth.uncertainty, LADDER_TARGETS[i]);
    }
    free(times);
    free(errors);
    free(marks);
}

void ladder_conclude(Ladder *ladder)
{
    for (size_t i = 0; i < ladder->point_count; i++) {
        judge(ladder, &ladder->points[i]);
        time_point(ladder, &ladder->points[i]);
    }
    fit_orders(ladder);
    rank_points(ladder);
}
