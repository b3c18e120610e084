// How long does the motion stay near its neighbours?
//
// f runs start beside the motion, along directions w_1 ... w_f that are orthonormal in
//     |w|^2 = sum over bodies (w_omega / omega_b)^2 + (w_v / v_b)^2
// and span every change of the speeds that joints and driver allow. With D_i(t) what the i-th is
// away, over its size r, the start sum c_i w_i is to first order sum c_i D_i(t) away; the largest
// of that in body b over all |c| = 1 is the largest singular value of (D_1b ... D_fb). So
//     growth(t) = max over bodies sigma_max(D_1b(t) ... D_fb(t)) / scale_b
// is that of the fastest of all perturbations. It does not depend on the directions that were run.
#include "model/growth.h"

#include <assert.h>
#include <stdlib.h>

// of the time: a step that ends short of it by rounding has reached it
static const double SAME_TIME = 1e-12;

enum { BEAT_EVERY = 64 }; // steps, between two samples

// A solver taken from sample to sample, without anything recorded on the way.
typedef struct Walk {
    void *state; // of the solver
    bool has_step;
    double reached_s;
} Walk;

static void beat(const GrowthWork *work)
{
    if (work->pulse.beat != NULL) {
        work->pulse.beat(work->pulse.context);
    }
}

// Goes on to a time, not before the last one, and looks at the bodies there.
static bool walk_to(const GrowthWork *work, Walk *walk, double time_s, Sample *sample, Err *err)
{
    const double near_s = time_s - SAME_TIME * time_s;
    size_t steps = 0;
    // a first step comes before the first sample, though it may have no length
    while (!walk->has_step || walk->reached_s < near_s) {
        if (!work->solver->step(walk->state, time_s, err)) {
            return false;
        }
        walk->has_step = true;
        walk->reached_s = work->solver->record(walk->state).end_s;
        if (++steps % BEAT_EVERY == 0) {
            beat(work);
        }
    }
    beat(work);
    work->solver->observe(walk->state, fmin(time_s, walk->reached_s), sample);
    return true;
}

// The perturbed runs, side by side.
typedef struct Runs {
    size_t count;
    Walk walks[PERTURB_FREEDOM_MAX];
    Scenario *scenarios; // owned: solvers keep a pointer to theirs
} Runs;

static bool open_runs(const GrowthWork *work, Runs *runs, Growth *growth)
{
    runs->scenarios = calloc(work->basis->count + 1, sizeof *runs->scenarios);
    assert(runs->scenarios != NULL);
    for (size_t i = 0; i < work->basis->count; i++) {
        runs->scenarios[i] = scenario_copy(work->scenario);
        perturb_along(&runs->scenarios[i], work->basis->changes[i], work->size);
        if (!work->solver->open(&runs->scenarios[i], &runs->walks[i].state, &growth->failure)) {
            return false;
        }
        runs->count++;
    }
    return true;
}

static void close_runs(const Solver *solver, Runs *runs, Growth *growth)
{
    for (size_t i = 0; i < runs->count; i++) {
        const SolverModel model = solver->model(runs->walks[i].state);
        growth->steps += model.steps;
        growth->evaluations += model.evaluations;
        solver->close(runs->walks[i].state);
    }
    // beyond those that were opened is the one that could not be
    for (size_t i = 0; i <= runs->count; i++) {
        scenario_free(&runs->scenarios[i]);
    }
    free(runs->scenarios);
}

// The products of the rows of (D_1b ... D_fb), of one body: a symmetric matrix of 3 by 3.
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

// The growth at one sample; false where a run does not come there.
static bool find_at(const GrowthWork *work, Runs *runs, size_t k, double *found, Growth *growth)
{
    const Trajectory *beside = work->beside;
    const bool is_spatial = work->scenario->linkage.is_spatial;
    Gram grams[LINKAGE_BODY_MAX] = {{.xx = 0.0}};
    for (size_t i = 0; i < runs->count; i++) {
        Sample sample;
        if (!walk_to(work, &runs->walks[i], beside->times[k], &sample, &growth->failure)) {
            return false;
        }
        for (size_t body = 0; body < beside->body_count; body++) {
            const DistanceMeasure measure = distance_measure(beside, body);
            add_difference(vec3_sub(distance_sample_rate(&sample, is_spatial, body, measure),
                                    distance_rate(beside, k, body, measure)),
                           &grams[body]);
        }
    }
    *found = 0.0;
    for (size_t body = 0; body < beside->body_count; body++) {
        if (work->scales[body].omega > 0.0) {
            const double apart = largest_singular(grams[body]) / work->scales[body].omega;
            // a number that is not finite is no small one
            *found = !(apart <= *found) ? apart : *found;
        }
    }
    *found /= work->size;
    return true;
}

Growth growth_find(const GrowthWork *work)
{
    Growth growth = {.largest = 1.0};
    Runs runs = {.count = 0};
    growth.is_failed = !open_runs(work, &runs, &growth);
    const Trajectory *beside = work->beside;
    bool is_going = !growth.is_failed;
    for (size_t k = 0; is_going && k < beside->sample_count; k++) {
        double found;
        if (!(beside->times[k] <= work->until_s)) {
            break;
        }
        growth.is_failed = !find_at(work, &runs, k, &found, &growth);
        growth.is_limited = growth.is_failed || !(found <= work->most);
        is_going = !growth.is_limited;
        if (is_going) {
            growth.largest = fmax(growth.largest, found);
            growth.until_s = beside->times[k];
        }
    }
    close_runs(work->solver, &runs, &growth);
    return growth;
}
