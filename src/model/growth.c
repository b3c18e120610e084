// Measures how long the motion stays near its neighbours.
//
// f runs start beside the motion, along directions w_1 ... w_f that are orthonormal in
//     |w|^2 = sum over the measure's rates (w_rate / scale)^2
// and span every change of the speeds that joints and driver allow. With D_i(t) what the i-th is
// away, over its size r_i, the start sum c_i w_i is to first order sum c_i D_i(t) away; the largest
// of that in rate b over all |c| = 1 is the largest singular value of (D_1b ... D_fb). So
//     growth(t) = max over rates sigma_max(D_1b(t) ... D_fb(t)) / scale_b
// is that of the fastest of all perturbations. It does not depend on the directions that were run.
#include "model/growth.h"

#include "base/call.h"

#include <assert.h>
#include <stdlib.h>

// of the time: a step that ends short of it by rounding has reached it
static const double SAME_TIME = 1e-12;

enum { BEAT_EVERY = 64 }; // steps and samples: each beat asks the clock

// Samples up to which all runs go before the growth there is looked at, and by how much more for
// the next time: a run that goes too far is work in vain, and so is to wait for one another.
enum { BLOCK_FIRST = 32, BLOCK_MOST = 512 };

enum { ROOM = 1 << 22 }; // vectors that all runs may keep of a block: 100 MB

// A solver taken from sample to sample, without anything recorded on the way.
typedef struct Walk {
    void *state; // of the solver
    bool has_step;
    size_t beats; // that were due or not
    double reached_s;
    size_t sample; // the first of the samples that it has not come to
    bool is_away;  // so far that the growth is above the most, at the last sample it came to
    Err failure;   // why it did not come to the sample
    Vec3 *apart;   // how far it is from the motion, by sample of the block and rate, over its size;
                   // owned
    bool is_under_way; // in the block
    bool is_through;   // with the block
} Walk;

// The perturbed runs, side by side, and the samples that they go through next.
struct GrowthRuns {
    GrowthWork work;
    size_t count;
    Walk *walks; // owned, like the scenarios, to which solvers keep a pointer
    Scenario *scenarios;
    size_t sample_count; // to go through
    size_t block;        // samples, at most so many of them
    size_t block_most;
    size_t first;
    size_t end;
    bool is_going;
    double *found; // growth, by sample; owned
    size_t looked; // samples that it is known of
    Err failure;   // why it is not known of the next one, where a run failed
};

typedef struct GrowthRuns Runs;

static void beat(const GrowthWork *work, Walk *walk, bool is_callers)
{
    if (++walk->beats % BEAT_EVERY == 0 && is_callers && work->pulse.beat != NULL) {
        work->pulse.beat(work->pulse.context);
    }
}

// Goes on to a time, not before the last one, and looks at the bodies there.
static bool walk_to(const GrowthWork *work, Walk *walk, double time_s, bool is_callers,
                    Sample *sample)
{
    const double near_s = time_s - SAME_TIME * time_s;
    // a first step comes before the first sample, though it may have no length
    while (!walk->has_step || walk->reached_s < near_s) {
        if (call_is_cancelled()) {
            return err_set(&walk->failure, ERR_SOLVER, "%s", CALL_CANCELLED);
        }
        if (!solver_stride(work->solver, walk->state, time_s, &walk->reached_s, &walk->failure)) {
            return false;
        }
        walk->has_step = true;
        beat(work, walk, is_callers);
    }
    beat(work, walk, is_callers);
    solver_glance(work->solver, walk->state, fmin(time_s, walk->reached_s), sample);
    return true;
}

// How far a run is from the motion at a sample, by rate, over the size of its perturbation; whether
// that alone is too far.
static bool find_apart(const GrowthWork *work, double size, const Sample *sample, size_t k,
                       Vec3 *apart)
{
    const DistanceMeasure *measure = work->measure;
    const DistanceMotion beside = distance_motion_at(work->beside, k);
    const DistanceMotion motion = distance_motion_of(sample);
    bool is_away = false;
    for (size_t i = 0; i < measure->count; i++) {
        const DistanceRate *rate = &measure->rates[i];
        const Vec3 difference = vec3_sub(distance_value(measure->linkage, rate, motion),
                                         distance_value(measure->linkage, rate, beside));
        apart[i] = vec3_scale(1.0 / (size * rate->scale), difference);
        is_away = is_away || !(vec3_length(apart[i]) <= work->most);
    }
    return is_away;
}

// Of all perturbations none grows less than one that is run.
void growth_walk(size_t index, bool is_callers, void *context)
{
    Runs *runs = context;
    const GrowthWork *work = &runs->work;
    Walk *walk = &runs->walks[index];
    const size_t rates = work->measure->count;
    const double size = work->size * work->basis->stretch[index];
    Sample sample = sample_create(&work->scenario->linkage);
    for (size_t k = runs->first; k < runs->end && !walk->is_away; k++) {
        if (!walk_to(work, walk, work->beside->times[k], is_callers, &sample)) {
            break;
        }
        walk->is_away = find_apart(work, size, &sample, k, walk->apart + (k - runs->first) * rates);
        walk->sample = k + 1;
    }
    sample_free(&sample);
}

static bool open_runs(Runs *runs)
{
    const GrowthWork *work = &runs->work;
    runs->scenarios = calloc(work->basis->count + 1, sizeof *runs->scenarios);
    runs->walks = calloc(work->basis->count + 1, sizeof *runs->walks);
    runs->found = calloc(runs->sample_count + 1, sizeof *runs->found);
    assert(runs->scenarios != NULL && runs->walks != NULL && runs->found != NULL);
    for (size_t i = 0; i < work->basis->count; i++) {
        Walk *walk = &runs->walks[i];
        runs->scenarios[i] = scenario_copy(work->scenario);
        perturb_along(&runs->scenarios[i], work->basis->changes[i],
                      work->size * work->basis->stretch[i]);
        if (!work->solver->open(&runs->scenarios[i], &walk->state, &runs->failure)) {
            return false;
        }
        runs->count++;
    }
    const size_t rates = work->measure->count;
    const size_t room = ROOM / (runs->count * rates + 1);
    runs->block_most = room < 1 ? 1 : (room < BLOCK_MOST ? room : BLOCK_MOST);
    for (size_t i = 0; i < runs->count; i++) {
        Vec3 *apart = calloc(runs->block_most * rates + 1, sizeof *apart);
        assert(apart != NULL);
        runs->walks[i].apart = apart;
    }
    return true;
}

static void close_runs(Runs *runs, Growth *growth)
{
    const Solver *solver = runs->work.solver;
    for (size_t i = 0; i < runs->count; i++) {
        const SolverModel model = solver->model(runs->walks[i].state);
        growth->steps += model.steps;
        growth->evaluations += model.evaluations;
        solver->close(runs->walks[i].state);
        free(runs->walks[i].apart);
    }
    // beyond those that were opened is the one that could not be
    for (size_t i = 0; i <= runs->count; i++) {
        scenario_free(&runs->scenarios[i]);
    }
    free(runs->walks);
    free(runs->scenarios);
    free(runs->found);
    free(runs);
}

// The products of the rows of (D_1b ... D_fb), of one rate: a symmetric matrix of 3 by 3.
typedef struct Gram {
    double xx, xy, yy, xz, yz, zz;
} Gram;

static void add_difference(Vec3 apart, Gram *gram)
{
    gram->xx += apart.x * apart.x;
    gram->xy += apart.x * apart.y;
    gram->yy += apart.y * apart.y;
    gram->xz += apart.x * apart.z;
    gram->yz += apart.y * apart.z;
    gram->zz += apart.z * apart.z;
}

// The largest eigenvalue of a symmetric matrix of 3 by 3 in closed form (Smith, Comm. ACM 4 (1961)
// 168).
static double largest_of_three(Gram g)
{
    const double mean = (g.xx + g.yy + g.zz) / 3.0;
    const double x = g.xx - mean;
    const double y = g.yy - mean;
    const double z = g.zz - mean;
    const double size =
        sqrt((x * x + y * y + z * z + 2.0 * (g.xy * g.xy + g.xz * g.xz + g.yz * g.yz)) / 6.0);
    if (!(size > 0.0)) {
        return mean + size;
    }
    const double determinant = x * (y * z - g.yz * g.yz) - g.xy * (g.xy * z - g.yz * g.xz) +
                               g.xz * (g.xy * g.yz - y * g.xz);
    const double cosine = fmax(-1.0, fmin(1.0, 0.5 * determinant / (size * size * size)));
    return mean + 2.0 * size * cos(acos(cosine) / 3.0);
}

// The largest singular value, by the largest eigenvalue of the products.
static double largest_singular(Gram gram)
{
    if (gram.zz != 0.0) {
        return sqrt(largest_of_three(gram));
    }
    const double mean = 0.5 * (gram.xx + gram.yy);
    return sqrt(mean + hypot(0.5 * (gram.xx - gram.yy), gram.xy));
}

// The growth at one sample of the block; false where a run does not come there.
static bool find_at(Runs *runs, size_t k, double *found)
{
    const size_t rates = runs->work.measure->count;
    for (size_t i = 0; i < runs->count; i++) {
        const Walk *walk = &runs->walks[i];
        if (walk->sample <= k && walk->is_away) {
            *found = INFINITY;
            return true;
        }
        if (walk->sample <= k) {
            runs->failure = walk->failure;
            return false;
        }
    }
    *found = 0.0;
    for (size_t rate = 0; rate < rates; rate++) {
        Gram gram = {.xx = 0.0};
        for (size_t i = 0; i < runs->count; i++) {
            add_difference(runs->walks[i].apart[(k - runs->first) * rates + rate], &gram);
        }
        const double apart = largest_singular(gram);
        // a number that is not finite is no small one
        *found = !(apart <= *found) ? apart : *found;
    }
    return true;
}

// Looks at the samples of the block. Returns whether the runs are to go on.
static bool look_at_block(Runs *runs)
{
    for (size_t k = runs->first; k < runs->end; k++) {
        if (!find_at(runs, k, &runs->found[k])) {
            return false;
        }
        runs->looked = k + 1;
        if (!(runs->found[k] <= runs->work.most)) {
            return false;
        }
    }
    return true;
}

// Sets out for the next samples, if there are any.
static void start_block(Runs *runs)
{
    const size_t block = runs->block < runs->block_most ? runs->block : runs->block_most;
    const size_t left = runs->sample_count - runs->end;
    runs->first = runs->end;
    runs->end += block < left ? block : left;
    runs->block = 2 * block;
    runs->is_going = runs->is_going && runs->first < runs->end;
    for (size_t i = 0; i < runs->count; i++) {
        runs->walks[i].is_under_way = runs->walks[i].is_through = false;
    }
}

GrowthRuns *growth_begin(const GrowthWork *work)
{
    GrowthRuns *runs = calloc(1, sizeof *runs);
    assert(runs != NULL);
    *runs = (GrowthRuns){.work = *work, .block = BLOCK_FIRST};
    const Trajectory *beside = work->beside;
    runs->sample_count = beside->sample_count;
    while (runs->sample_count > 0 && !(beside->times[runs->sample_count - 1] <= work->until_s)) {
        runs->sample_count--;
    }
    runs->is_going = open_runs(runs);
    if (runs->is_going && runs->count == 0) {
        // nothing can be changed: nothing grows
        runs->looked = runs->sample_count;
        runs->is_going = false;
    }
    start_block(runs);
    return runs;
}

SideBySideNext growth_next(size_t *index, void *context)
{
    const GrowthRuns *runs = context;
    if (!runs->is_going) {
        return SIDE_BY_SIDE_NONE;
    }
    for (size_t i = 0; i < runs->count; i++) {
        if (!runs->walks[i].is_under_way) {
            runs->walks[i].is_under_way = true;
            *index = i;
            return SIDE_BY_SIDE_PIECE;
        }
    }
    return SIDE_BY_SIDE_LATER;
}

void growth_walked(size_t index, void *context)
{
    GrowthRuns *runs = context;
    runs->walks[index].is_through = true;
    for (size_t i = 0; i < runs->count; i++) {
        if (!runs->walks[i].is_through) {
            return;
        }
    }
    runs->is_going = look_at_block(runs);
    start_block(runs);
}

Growth growth_end(GrowthRuns *runs, double until_s)
{
    Growth growth = {.largest = 1.0};
    const Trajectory *beside = runs->work.beside;
    for (size_t k = 0; k < runs->sample_count && beside->times[k] <= until_s; k++) {
        growth.is_failed = k == runs->looked;
        growth.is_limited = growth.is_failed || !(runs->found[k] <= runs->work.most);
        if (growth.is_limited) {
            break;
        }
        growth.largest = fmax(growth.largest, runs->found[k]);
        growth.until_s = beside->times[k];
    }
    growth.failure = runs->failure;
    close_runs(runs, &growth);
    return growth;
}

Growth growth_find(const GrowthWork *work)
{
    GrowthRuns *runs = growth_begin(work);
    const SideBySideTasks tasks = {
        .most = work->basis->count,
        .next = growth_next,
        .work = growth_walk,
        .end = growth_walked,
        .context = runs,
    };
    side_by_side_tasks(&tasks, work->threads);
    return growth_end(runs, work->until_s);
}
