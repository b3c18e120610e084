// The contacts within the step: Chipmunk is asked for accelerations, and moves nothing itself.
#include "drivers/chipmunk/chipmunk_driver.h"
#include "drivers/common/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Differences of trials are no better than the solver: so many as leave this share of the
// accelerations, found at the start. How many these are depends on the masses: 30 to 240.
enum { ITERATIONS_TRIAL = 30, ITERATIONS_TRIAL_MOST = 1000 };
static const double SOLVED = 1e-12;
static const double SOLVED_LEAST = 1e-6; // above which a case is refused

// rad and m, by which coordinates are apart where it is tried; and m/s^2 and rad/s^2, with what
enum { TRIED_PLACES = 4 };
static const double TRIED_APART = 0.4;
static const double TRIED_ACCELERATION = 100.0;
static const double TRIED_TURNING = 1e4;

typedef struct Trials {
    ChipmunkRun *run;
    Tree tree;
    double step_s; // of a trial
    DriverMotion *before;
    DriverMotion *after;
    DriverAction *actions;
} Trials;

// Puts a body where the trial has it, in the frame that Chipmunk has of it.
static void place(const ChipmunkRun *run, size_t i, const DriverMotion *motion)
{
    const Vec2 arm = vec2_rotate(motion->angle, run->centres[i]);
    const Vec2 going = vec2_scale(motion->omega, vec2_perp(arm));
    if (run->of->has_drive && run->of->driven_body == (int)i) {
        cpBodySetAngle(run->bodies[i], motion->angle); // about its pivot, which stays
        return;
    }
    cpBodySetPosition(run->bodies[i], chipmunk_vect(vec2_sub(motion->position, arm)));
    cpBodySetAngle(run->bodies[i], motion->angle);
    cpBodySetVelocity(run->bodies[i], chipmunk_vect(vec2_sub(motion->velocity, going)));
    cpBodySetAngularVelocity(run->bodies[i], motion->omega);
}

static void accelerate(void *engine, const double *q, const double *v, const DriverAction *actions,
                       double *a)
{
    Trials *trials = engine;
    ChipmunkRun *run = trials->run;
    trial_place(&trials->tree, q, v, actions, trials->before, trials->actions);
    for (size_t i = 0; i < run->of->body_count; i++) {
        place(run, i, &trials->before[i]);
    }
    chipmunk_push(run, trials->actions);
    cpSpaceStep(run->space, trials->step_s);
    chipmunk_read(run, trials->after);
    trial_read(&trials->tree, trials->before, trials->after, trials->step_s, a);
}

// The accelerations under actions that move every body, asked for after others: the solver begins
// with what it found last.
static void accelerate_anew(Trials *trials, const double *q, const double *v, DriverAction *actions,
                            double *a)
{
    const DriverCase *of = trials->run->of;
    memset(actions, 0, of->body_count * sizeof *actions);
    accelerate(trials, q, v, actions, a);
    for (size_t i = 0; i < of->body_count; i++) {
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        const double size = sign * TRIED_ACCELERATION * of->bodies[i].mass;
        actions[i] = (DriverAction){{size, size}, -sign * TRIED_TURNING * of->bodies[i].inertia};
    }
    accelerate(trials, q, v, actions, a);
}

// Whether half as many iterations find the same accelerations but for a share of them; leaves the
// solver with as many as there were.
static bool is_solved(Trials *trials, const double *q, const double *v, double share)
{
    ChipmunkRun *run = trials->run;
    const size_t count = trials->tree.coordinates;
    double *a[2] = {driver_room(count, sizeof **a), driver_room(count, sizeof **a)};
    DriverAction *actions = driver_room(run->of->body_count, sizeof *actions);
    double change = 0.0;
    double size = 0.0;
    for (int half = 1; half >= 0; half--) {
        cpSpaceSetIterations(run->space, run->iterations / (half + 1));
        accelerate_anew(trials, q, v, actions, a[half]);
    }
    for (size_t i = 0; i < count; i++) {
        change = fmax(change, fabs(a[0][i] - a[1][i]));
        size = fmax(size, fabs(a[0][i]));
    }
    free(actions);
    free(a[1]);
    free(a[0]);
    return change <= share * size;
}

// Doubles the iterations until accelerations change no more, at the start and where each coordinate
// is elsewhere: how many are needed depends on how the bodies stand.
static void choose_iterations(Trials *trials)
{
    ChipmunkRun *run = trials->run;
    const size_t count = trials->tree.coordinates;
    double *q = driver_room(count, sizeof *q);
    double *v = driver_room(count, sizeof *v);
    tree_start(&trials->tree, v);
    run->iterations *= 2;
    for (int place = 0; place < TRIED_PLACES; place++) {
        for (size_t i = 0; i < count; i++) {
            q[i] = TRIED_APART * place * (i % 2 == 0 ? 1.0 : -1.0);
        }
        while (!is_solved(trials, q, v, SOLVED) && run->iterations < ITERATIONS_TRIAL_MOST) {
            run->iterations *= 2;
        }
        if (!is_solved(trials, q, v, SOLVED_LEAST)) {
            driver_refuse("contacts within the step of bodies whose masses differ so much that %d "
                          "iterations do not solve them",
                          run->iterations);
        }
    }
    run->iterations /= 2; // which were enough
    cpSpaceSetIterations(run->space, run->iterations);
    free(v);
    free(q);
}

void chipmunk_run_kernel(ChipmunkRun *run)
{
    const size_t bodies = run->of->body_count;
    Trials trials = {.run = run,
                     .tree = run->tree,
                     .step_s = trial_step(run->of),
                     .before = driver_room(bodies, sizeof *trials.before),
                     .after = driver_room(bodies, sizeof *trials.after),
                     .actions = driver_room(bodies, sizeof *trials.actions)};
    chipmunk_let_move(run, chipmunk_stay);
    choose_iterations(&trials);
    chipmunk_tell_settings(run);
    trial_run(&trials.tree, &(TrialEngine){accelerate, NULL, &trials}, &run->run);
}
