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
        runs->scenarios[i] = *work->scenario;
        perturb_along(&runs->scenarios[i], work->basis->changes[i], work->size);
        if (!walk_open(&runs->walks[i], work->solver, &runs->scenarios[i], work->pulse,
                       &growth->failure)) {
            return false;
        }
        runs->count++;
    }
    return true;
}

static void close_runs(Runs *runs, Growth *growth)
{
    for (size_t i = 0; i < runs->count; i++) {
        walk_close(&runs->walks[i], &growth->steps, &growth->evaluations);
    }
    free(runs->scenarios);
}

// The products of the rows of (D_1b ... D_fb), of one body: of two rows where D are velocities.
typedef struct Gram {
    double xx;
    double xy;
    double yy;
} Gram;

static void add_difference(const Motion *moved, const Motion *truth, bool is_velocity, Gram *gram)
{
    const Vec2 apart = is_velocity ? vec2_sub(moved->velocity, truth->velocity)
                                   : (Vec2){moved->omega - truth->omega, 0.0};
    gram->xx += apart.x * apart.x;
    gram->xy += apart.x * apart.y;
    gram->yy += apart.y * apart.y;
}

// The larger singular value, by the larger eigenvalue of the products.
static double largest_singular(Gram gram)
{
    const double mean = 0.5 * (gram.xx + gram.yy);
    return sqrt(mean + hypot(0.5 * (gram.xx - gram.yy), gram.xy));
}

// The growth at one sample; false where a run does not come there.
static bool find_at(const GrowthWork *work, Runs *runs, size_t k, double *found, Growth *growth)
{
    const Trajectory *beside = work->beside;
    const bool is_velocity = distance_is_by_velocity(beside);
    Gram grams[LINKAGE_BODY_MAX] = {{0.0, 0.0, 0.0}};
    for (size_t i = 0; i < runs->count; i++) {
        Sample sample;
        if (!walk_to(&runs->walks[i], beside->times[k], &sample, &growth->failure)) {
            return false;
        }
        for (size_t body = 0; body < beside->body_count; body++) {
            add_difference(&sample.bodies[body], trajectory_motion(beside, k, body), is_velocity,
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
    close_runs(&runs, &growth);
    return growth;
}
