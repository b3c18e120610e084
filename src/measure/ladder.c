// Which runs does a ladder consist of, and which are still to be made?
//
// Run number n: the error runs of the P points, step by step, then in each round the timing runs of
// all points, so that whatever slows the machine down for a while slows all of them. How long the
// runs still to be made take goes by the finest of their scheme that was made: as 1 / step.
#include "measure/ladder.h"

#include "base/text.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

LadderTruth ladder_truth_of(const Truth *truth, double wall_s)
{
    LadderTruth known = {
        .is_known = true,
        .uncertainty = truth->uncertainty,
        .horizon_s = truth->horizon_s,
        .growth = truth->growth,
        .is_limited = truth->is_limited,
        .wall_s = wall_s,
    };
    text_copy(known.message, sizeof known.message, truth->message);
    text_copy(known.backend, sizeof known.backend, truth->trajectory->backend);
    return known;
}

// Numbers the error runs: the coarsest steps of all schemes, what has no step, then the next steps.
static void put_in_order(Ladder *ladder)
{
    size_t count = 0;
    for (size_t row = 0; count < ladder->point_count; row++) {
        size_t place = 0; // among the steps of its scheme
        for (size_t i = 0; i < ladder->point_count; i++) {
            const LadderPoint *point = &ladder->points[i];
            place = point->is_first ? 0 : place + 1;
            if ((point->step_s > 0.0 ? place : 1) == row) {
                ladder->error_order[count++] = i;
            }
        }
    }
}

Ladder *ladder_create(const Scheme *schemes, size_t scheme_count, const double *steps,
                      size_t step_count, size_t repeats)
{
    assert(scheme_count <= SCHEME_MAX && step_count <= LADDER_STEP_MAX);
    assert(repeats <= LADDER_REPEAT_MAX);
    Ladder *ladder = calloc(1, sizeof *ladder);
    assert(ladder != NULL);
    ladder->points = calloc(scheme_count * step_count + 1, sizeof *ladder->points);
    ladder->error_order = calloc(scheme_count * step_count + 1, sizeof *ladder->error_order);
    assert(ladder->points != NULL && ladder->error_order != NULL);
    ladder->scheme_count = scheme_count;
    ladder->step_count = step_count;
    ladder->repeats = repeats;
    memcpy(ladder->schemes, schemes, scheme_count * sizeof *schemes);
    memcpy(ladder->steps, steps, step_count * sizeof *steps);
    for (size_t i = 0; i < scheme_count; i++) {
        const bool has_step = scheme_has_step(&schemes[i]);
        for (size_t k = 0; k < (has_step ? step_count : 1); k++) {
            LadderPoint *point = &ladder->points[ladder->point_count++];
            *point = (LadderPoint){
                .scheme = i,
                .name = ladder->schemes[i].name,
                .is_first = k == 0,
                .step_s = has_step ? steps[k] : 0.0,
            };
        }
    }
    put_in_order(ladder);
    return ladder;
}

void ladder_destroy(Ladder *ladder)
{
    if (ladder != NULL) {
        free(ladder->points);
        free(ladder->error_order);
        free(ladder);
    }
}

size_t ladder_find(const Ladder *ladder, const char *scheme, double step_s)
{
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->step_s == step_s && strcmp(point->name, scheme) == 0) {
            return i;
        }
    }
    return ladder->point_count;
}

bool ladder_add(Ladder *ladder, const LadderRun *run)
{
    if (run->point >= ladder->point_count) {
        return false;
    }
    LadderPoint *point = &ladder->points[run->point];
    if (run->kind == LADDER_ERROR) {
        if (point->is_measured) {
            return false;
        }
        point->is_measured = true;
        point->run = *run;
        point->run.error.against = NULL;
        return true;
    }
    if (run->round >= ladder->repeats || point->is_timed[run->round]) {
        return false;
    }
    point->is_timed[run->round] = true;
    point->wall_s[run->round] = run->is_complete ? run->wall_s : NAN;
    if (!run->is_complete && point->timing_message[0] == '\0') {
        snprintf(point->timing_message, sizeof point->timing_message, "%s", run->message);
    }
    return true;
}

size_t ladder_run_total(const Ladder *ladder)
{
    return ladder->point_count * (1 + ladder->repeats);
}

LadderRun ladder_run(const Ladder *ladder, size_t number)
{
    const size_t pass = number / ladder->point_count;
    const size_t place = number % ladder->point_count;
    return (LadderRun){
        .kind = pass == 0 ? LADDER_ERROR : LADDER_TIMING,
        .point = pass == 0 ? ladder->error_order[place] : place,
        .round = pass == 0 ? 0 : pass - 1,
    };
}

static bool has_failed(const LadderPoint *point)
{
    return (point->is_measured && !point->run.is_complete) || point->timing_message[0] != '\0';
}

static bool is_done(const Ladder *ladder, size_t number)
{
    const LadderRun run = ladder_run(ladder, number);
    const LadderPoint *point = &ladder->points[run.point];
    return run.kind == LADDER_ERROR ? point->is_measured
                                    : point->is_timed[run.round] || has_failed(point);
}

size_t ladder_next(const Ladder *ladder, size_t from)
{
    const size_t total = ladder_run_total(ladder);
    while (from < total && is_done(ladder, from)) {
        from++;
    }
    return from;
}

size_t ladder_run_done(const Ladder *ladder)
{
    size_t done = 0;
    for (size_t i = 0; i < ladder_run_total(ladder); i++) {
        done += is_done(ladder, i) ? 1 : 0;
    }
    return done;
}

// Time per unit of 1 / step, over the error runs of all schemes that were made.
static double time_per_work(const Ladder *ladder)
{
    double wall_s = 0.0;
    double work = 0.0;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->is_measured && point->run.is_complete && point->step_s > 0.0) {
            wall_s += point->run.wall_s;
            work += 1.0 / point->step_s;
        }
    }
    return work > 0.0 ? wall_s / work : 0.0;
}

bool ladder_has_pace(const Ladder *ladder)
{
    bool is_any = false;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->step_s > 0.0 && point->is_first && !point->is_measured) {
            return false;
        }
        is_any |= point->step_s > 0.0 && point->is_measured && point->run.is_complete;
    }
    return is_any;
}

// The time of one run of a point, s: its own where that is known, else by the finest of its scheme,
// or by all.
static double time_of_point(const Ladder *ladder, size_t number, double rate)
{
    const LadderPoint *point = &ladder->points[number];
    if (point->is_measured) {
        return point->run.wall_s;
    }
    const size_t finest = ladder_finest(ladder, point->scheme);
    if (finest < ladder->point_count) {
        rate = ladder->points[finest].run.wall_s * ladder->points[finest].step_s;
    }
    return point->step_s > 0.0 ? rate / point->step_s : 0.0;
}

double ladder_time_left(const Ladder *ladder, size_t jobs)
{
    const double rate = time_per_work(ladder);
    double error_s = 0.0;
    double timing_s = 0.0;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        const double run_s = time_of_point(ladder, i, rate);
        error_s += point->is_measured ? 0.0 : run_s;
        for (size_t round = 0; round < ladder->repeats && !has_failed(point); round++) {
            timing_s += point->is_timed[round] ? 0.0 : run_s;
        }
    }
    return error_s / (double)jobs + timing_s;
}

double ladder_time_of_steps(const Ladder *ladder, size_t step_count, size_t jobs)
{
    const double rate = time_per_work(ladder);
    double once_s = 0.0;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const bool is_in =
            ladder->points[i].step_s == 0.0 ||
            (step_count > 0 && ladder->points[i].step_s >= ladder->steps[step_count - 1]);
        once_s += is_in ? time_of_point(ladder, i, rate) : 0.0;
    }
    return ladder->truth.wall_s + once_s * (1.0 / (double)jobs + (double)ladder->repeats);
}

size_t ladder_finest(const Ladder *ladder, size_t scheme)
{
    size_t finest = ladder->point_count;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->scheme == scheme && point->is_measured && !has_failed(point)) {
            finest = i;
        }
    }
    return finest;
}
