// Lists the runs of a ladder of steps, and concludes from them: order of convergence and frontier.
//
// Run number n: the error runs of the P points, step by step, then in each round the timing runs of
// all points, so that whatever slows the machine down for a while slows all of them. How long the
// runs still to be made take goes by the finest of their scheme that was made: as 1 / step.
#include "measure/ladder.h"
#include "base/sorted.h"
#include "base/text.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const double LADDER_TARGETS[LADDER_TARGET_COUNT] = {1e-2, 1e-3, 1e-4, 1e-5};

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
static void ladder_put_in_order(Ladder *ladder)
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
    ladder->is_whole = true;
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
    ladder_put_in_order(ladder);
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

// The frontier is that of ODE and of other engines: the solvers that the truth is made by stand
// beside them.
static bool is_ranked(const Ladder *ladder, const LadderPoint *point)
{
    const Scheme *scheme = &ladder->schemes[point->scheme];
    return scheme->backend == BACKEND_ODE || scheme->driver != NULL;
}

// two solvers that agree in all but rounding are equally accurate
static const double TIE = 0.01;

// Whether one error is as good as another, on the frontier and for every target.
static bool is_as_accurate(const Ladder *ladder, double error, double other)
{
    bool is_as_good = (1.0 - TIE) * error <= other;
    for (size_t i = 0; i < LADDER_TARGET_COUNT; i++) {
        const double most = LADDER_TARGETS[i] - ladder->truth.uncertainty;
        is_as_good = is_as_good && (error <= most || !(other <= most));
    }
    return is_as_good;
}

// Points that are left out.
//
// From a point with error e at step h the error of the same scheme at h' < h is taken to be at
// least
//     e (h' / h)^p / SLACK
// with p above any order of its stepping, and its time at least that of
//     work = N h / h' + E / 20 + S / 4,    N world steps, E evaluations, S samples
// at the rate of the point. A scheme ends where another point of its backend is more accurate and
// faster than every finer step of it could be.

// orders that no stepping exceeds, contacts coming and going, and by how much an error may be below
// the trend
static const double PLAIN_ORDER_MOST = 2.0;
static const double LADDER_ORDER_MOST = 6.0;
static const double LADDER_SLACK = 4.0;

// what a run does beside world steps, in those, as measured
static const double LADDER_WORK_OF_EVALUATION = 0.05;
static const double LADDER_WORK_OF_SAMPLE = 0.25;

// times of runs made side by side are uncertain by less
static const double SIDE_BY_SIDE_MARGIN = 2.0;

static bool is_same_backend(const Ladder *ladder, const LadderPoint *point,
                            const LadderPoint *other)
{
    return is_ranked(ladder, other) && strcmp(scheme_backend(&ladder->schemes[other->scheme]),
                                              scheme_backend(&ladder->schemes[point->scheme])) == 0;
}

// The time of an error run, s: of the processor, but where it comes from a store.
static double error_run_time(const LadderPoint *point)
{
    return point->run.processor_s > 0.0 ? point->run.processor_s : point->run.wall_s;
}

// The error of a point that was run, NAN where it has none that counts.
static double error_where_stable(const Ladder *ladder, const LadderPoint *point)
{
    const TrajectoryError *error = &point->run.error;
    const bool has_one = point->is_measured && point->run.is_complete && error->is_known &&
                         error_is_unstable(error, ladder->truth.is_limited) == NULL;
    return has_one ? error_of(ladder, point) : NAN;
}

// Whether some point is better than a finer one of a scheme could be, by one that was run.
static bool is_outdone(const Ladder *ladder, const LadderPoint *run, double finer_s)
{
    const Scheme *scheme = &ladder->schemes[run->scheme];
    const bool is_plain = scheme->backend == BACKEND_ODE && scheme->stepping == ODE_PLAIN;
    const double ratio = run->step_s / finer_s;
    const double error =
        error_where_stable(ladder, run) /
        (LADDER_SLACK * pow(ratio, is_plain ? PLAIN_ORDER_MOST : LADDER_ORDER_MOST));
    const double rest = LADDER_WORK_OF_EVALUATION * (double)run->run.evaluations +
                        LADDER_WORK_OF_SAMPLE * (double)ladder->samples;
    const double steps = (double)run->run.steps;
    const double time_s = error_run_time(run) * (ratio * steps + rest) / (steps + rest);
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *other = &ladder->points[i];
        if (other->scheme != run->scheme && is_same_backend(ladder, run, other) &&
            SIDE_BY_SIDE_MARGIN * error_run_time(other) < time_s &&
            is_as_accurate(ladder, error_where_stable(ladder, other), error)) {
            return true;
        }
    }
    return false;
}

// Leaves out the finer steps of schemes that have ended.
static void leave_out(Ladder *ladder)
{
    if (ladder->is_whole || !ladder->truth.is_known || ladder->truth.is_limited) {
        return;
    }
    for (size_t scheme = 0; scheme < ladder->scheme_count; scheme++) {
        const size_t finest = ladder_finest(ladder, scheme);
        const LadderPoint *run = finest < ladder->point_count ? &ladder->points[finest] : NULL;
        bool is_over = run != NULL && run->step_s > 0.0 && is_ranked(ladder, run);
        for (size_t i = 0; i < ladder->point_count && is_over; i++) {
            const LadderPoint *point = &ladder->points[i];
            is_over =
                point->scheme != scheme || i <= finest || is_outdone(ladder, run, point->step_s);
        }
        for (size_t i = finest + 1; i < ladder->point_count && is_over; i++) {
            LadderPoint *point = &ladder->points[i];
            point->is_left_out =
                point->is_left_out || (point->scheme == scheme && !point->is_measured);
        }
    }
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
        point->is_left_out = false;
        point->run = *run;
        point->run.error.against = NULL;
        leave_out(ladder);
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

// Times that are known well enough.

// so many timing runs are enough where all are as long, within this share, or where no other point
// comes near
enum { FEW_RUNS = 3 };
static const double ALIKE = 0.05;

// by the least of so many runs each, times are uncertain by less than this on a busy machine
static const double TIME_MARGINS[FEW_RUNS] = {3.0, 1.5, 1.25};

// The least of the first timing runs of a point, s; NAN where not all of them are made.
static double least_time(const LadderPoint *point, size_t rounds)
{
    double least = INFINITY;
    for (size_t i = 0; i < rounds; i++) {
        least = point->is_timed[i] ? fmin(least, point->wall_s[i]) : NAN;
        if (isnan(least)) {
            return NAN;
        }
    }
    return least;
}

// Whether another point of the same backend is both as accurate and, by the first timing runs, so
// much faster that no time of this one could bring it to the frontier, nor make it the backend's
// cheapest.
static bool is_beaten(const Ladder *ladder, const LadderPoint *point)
{
    const double error = error_of(ladder, point);
    for (size_t i = 0; i < ladder->point_count && point->is_timed[0] && is_ranked(ladder, point);
         i++) {
        const LadderPoint *other = &ladder->points[i];
        if (other == point || !is_same_backend(ladder, point, other) ||
            !other->run.error.is_known || has_failed(other) ||
            !is_as_accurate(ladder, error_of(ladder, other), error)) {
            continue;
        }
        for (size_t k = 0; k < (ladder->is_whole ? 1 : FEW_RUNS); k++) {
            if (TIME_MARGINS[k] * least_time(other, k + 1) < least_time(point, k + 1)) {
                return true;
            }
        }
    }
    return false;
}

// Whether the first timing runs of a point were alike: their median is that of more.
static bool is_timed_alike(const LadderPoint *point)
{
    double most = 0.0;
    for (size_t i = 0; i < FEW_RUNS; i++) {
        most = fmax(most, point->wall_s[i]);
    }
    return most <= (1.0 + ALIKE) * least_time(point, FEW_RUNS);
}

// Whether another point of the backend takes about as long, by the first timing runs.
static bool is_contested(const Ladder *ladder, const LadderPoint *point)
{
    const double margin = TIME_MARGINS[FEW_RUNS - 1];
    const double time_s = least_time(point, FEW_RUNS);
    for (size_t i = 0; i < ladder->point_count && is_ranked(ladder, point); i++) {
        const LadderPoint *other = &ladder->points[i];
        const double other_s = least_time(other, FEW_RUNS);
        if (other != point && is_same_backend(ladder, point, other) && other_s <= margin * time_s &&
            time_s <= margin * other_s) {
            return true;
        }
    }
    return false;
}

// Whether the time of a point is known well enough by the timing runs before a round. Of a point
// that is beaten one is enough.
static bool is_timed_enough(const Ladder *ladder, const LadderPoint *point, size_t round)
{
    const bool is_clear = round >= FEW_RUNS && !ladder->is_whole &&
                          isfinite(least_time(point, FEW_RUNS)) &&
                          (is_timed_alike(point) || !is_contested(ladder, point));
    return is_clear || (round > 0 && is_beaten(ladder, point));
}

static bool is_done(const Ladder *ladder, size_t number)
{
    const LadderRun run = ladder_run(ladder, number);
    const LadderPoint *point = &ladder->points[run.point];
    if (point->is_left_out) {
        return true;
    }
    if (run.kind == LADDER_ERROR) {
        return point->is_measured;
    }
    return point->is_timed[run.round] || has_failed(point) ||
           is_timed_enough(ladder, point, run.round);
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

size_t ladder_run_made(const Ladder *ladder)
{
    size_t made = 0;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        made += point->is_measured ? 1 : 0;
        for (size_t round = 0; round < ladder->repeats; round++) {
            made += point->is_timed[round] ? 1 : 0;
        }
    }
    return made;
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
    if (point->is_left_out) {
        return 0.0;
    }
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
            const bool is_needed =
                !point->is_timed[round] && !is_timed_enough(ladder, point, round);
            timing_s += is_needed ? run_s : 0.0;
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

// The power of the step with which an error falls.
//
//     p_i = ln(e_i / e_i+1) / ln(h_i / h_i+1)                      from step i to the next
//     p = sum (x - <x>)(y - <y>) / sum (x - <x>)^2,  x = ln h, y = ln e     over the range

// orders of one and two must never be taken as one range; errors taken as a maximum over samples
// scatter by some 0.1
static const double ORDER_AGREEMENT = 0.25;
// a slower fall is none: a bias that a finer step does not take away
static const double FITTED_ORDER_LEAST = 0.25;
enum { POINTS_LEAST = 3 };

static bool is_above(double error, double floor)
{
    return isfinite(error) && error > floor && error > 0.0;
}

static double local_order(const double *steps, const double *errors, size_t index)
{
    return log(errors[index] / errors[index + 1]) / log(steps[index] / steps[index + 1]);
}

// The longest range that begins at a step; its spread. One point where nothing agrees.
static size_t ladder_extend(size_t count, const double *steps, const double *errors, double floor,
                            size_t first, double *spread)
{
    double low = INFINITY;
    double high = -INFINITY;
    size_t last = first;
    *spread = 0.0;
    while (last + 1 < count && is_above(errors[last], floor) && is_above(errors[last + 1], floor)) {
        const double order = local_order(steps, errors, last);
        low = fmin(low, order);
        high = fmax(high, order);
        if (!(high - low <= ORDER_AGREEMENT) || !(low >= FITTED_ORDER_LEAST)) {
            break;
        }
        *spread = high - low;
        last++;
    }
    return last;
}

static double slope(size_t first, size_t last, const double *steps, const double *errors)
{
    const double count = (double)(last - first + 1);
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (size_t i = first; i <= last; i++) {
        mean_x += log(steps[i]) / count;
        mean_y += log(errors[i]) / count;
    }
    double mixed = 0.0;
    double square = 0.0;
    for (size_t i = first; i <= last; i++) {
        const double x = log(steps[i]) - mean_x;
        mixed += x * (log(errors[i]) - mean_y);
        square += x * x;
    }
    return mixed / square;
}

Order order_fit(size_t count, const double *steps, const double *errors, double floor)
{
    Order best = {.is_known = false};
    for (size_t first = 0; first < count; first++) {
        double spread;
        const size_t last = ladder_extend(count, steps, errors, floor, first, &spread);
        const bool is_long = last - first + 1 >= POINTS_LEAST;
        if (is_long && (!best.is_known || last - first >= best.last - best.first)) {
            best = (Order){.is_known = true, .first = first, .last = last, .spread = spread};
        }
    }
    if (best.is_known) {
        best.order = slope(best.first, best.last, steps, errors);
        best.points = best.last - best.first + 1;
        best.from_s = steps[best.first];
        best.to_s = steps[best.last];
    }
    return best;
}

// The points that are worth their time.
//
// From the fastest point to the slowest, one belongs to the frontier (Pareto's) where its error is
// below 0.99 times the least so far. Some hundred points: the next one is looked for among all.

static bool ladder_is_point(double time, double error)
{
    return isfinite(time) && isfinite(error);
}

// Whether a point comes before another: faster, or as fast and more accurate, or first in the list.
static bool comes_before(const double *times, const double *errors, size_t a, size_t b)
{
    if (times[a] != times[b]) {
        return times[a] < times[b];
    }
    return errors[a] != errors[b] ? errors[a] < errors[b] : a < b;
}

// The first point behind another (behind none where that is `count`), or `count`.
static size_t ladder_next_point(size_t count, const double *times, const double *errors,
                                size_t last)
{
    size_t next = count;
    for (size_t i = 0; i < count; i++) {
        if (ladder_is_point(times[i], errors[i]) &&
            (last == count || comes_before(times, errors, last, i)) &&
            (next == count || comes_before(times, errors, i, next))) {
            next = i;
        }
    }
    return next;
}

void frontier_mark(size_t count, const double *times, const double *errors, bool *is_on_frontier)
{
    for (size_t i = 0; i < count; i++) {
        is_on_frontier[i] = false;
    }
    double least = INFINITY;
    for (size_t i = ladder_next_point(count, times, errors, count); i < count;
         i = ladder_next_point(count, times, errors, i)) {
        if (errors[i] < (1.0 - TIE) * least) {
            is_on_frontier[i] = true;
            least = errors[i];
        }
    }
}

size_t frontier_cheapest(size_t count, const double *times, const double *errors,
                         double uncertainty, double target)
{
    size_t best = count;
    for (size_t i = 0; i < count; i++) {
        if (!ladder_is_point(times[i], errors[i]) || !(errors[i] + uncertainty <= target)) {
            continue;
        }
        if (best == count || times[i] < times[best] ||
            (times[i] == times[best] && errors[i] < errors[best])) {
            best = i;
        }
    }
    return best;
}

// Speed against error.

static void ladder_explain(LadderPoint *point, const char *reason)
{
    snprintf(point->reason, sizeof point->reason, "%s", reason);
}

static void ladder_fail(LadderPoint *point, const char *reason)
{
    point->is_failed = true;
    ladder_explain(point, reason);
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

static void ladder_judge(const Ladder *ladder, LadderPoint *point)
{
    point->is_failed = false;
    point->reason[0] = '\0';
    point->error = NAN;
    const char *unstable = error_is_unstable(&point->run.error, ladder->truth.is_limited);
    if (point->is_left_out) {
        ladder_fail(point, "left out: no finer step of its scheme can come to the frontier");
    } else if (!point->is_measured) {
        ladder_fail(point, "not run");
    } else if (!point->run.is_complete) {
        ladder_fail(point, point->run.message);
    } else if (point->timing_message[0] != '\0') {
        ladder_fail(point, point->timing_message);
    } else if (!point->run.error.is_known) {
        ladder_fail(point, "has no error: its numbers are not finite");
    } else if ((ladder->truth.is_limited || is_truth(ladder, point)) &&
               !isfinite(error_of(ladder, point))) {
        ladder_explain(point, why_without_error(ladder, point));
    } else if (unstable != NULL) {
        ladder_fail(point, unstable);
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
        bool is_whole = true;
        for (size_t i = 0; i < ladder->point_count; i++) {
            const LadderPoint *point = &ladder->points[i];
            if (point->scheme == scheme && point->step_s > 0.0) {
                errors[count++] = point->error;
                is_whole = is_whole && !point->is_left_out;
            }
        }
        // the few coarse steps of one that was left out may fall alike by chance
        ladder->orders[scheme] = order_fit(is_whole ? count : 0, ladder->steps, errors,
                                           ERROR_CLEAR_OF_TRUTH * ladder->truth.uncertainty);
    }
}

static void rank_points(Ladder *ladder)
{
    const size_t count = ladder->point_count;
    double *times = calloc(count + 1, sizeof *times);
    double *errors = calloc(count + 1, sizeof *errors);
    bool *marks = calloc(count + 1, sizeof *marks);
    assert(times != NULL && errors != NULL && marks != NULL);
    for (size_t i = 0; i < count; i++) {
        const LadderPoint *point = &ladder->points[i];
        times[i] =
            is_ranked(ladder, point) && !is_beaten(ladder, point) ? point->wall_median_s : NAN;
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
        ladder_judge(ladder, &ladder->points[i]);
        time_point(ladder, &ladder->points[i]);
    }
    fit_orders(ladder);
    rank_points(ladder);
}
