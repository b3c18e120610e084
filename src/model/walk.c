// How is a solver taken to where it is wanted?
#include "model/walk.h"

// of the time: a step that ends short of it by rounding has reached it
static const double SAME_TIME = 1e-12;

enum { BEAT_EVERY = 64 }; // steps, between two samples

bool walk_open(Walk *walk, const Solver *solver, const Scenario *scenario, WalkPulse pulse,
               Err *err)
{
    *walk = (Walk){.solver = solver, .pulse = pulse};
    return solver->open(scenario, &walk->state, err);
}

static void beat(const Walk *walk)
{
    if (walk->pulse.beat != NULL) {
        walk->pulse.beat(walk->pulse.context);
    }
}

bool walk_to(Walk *walk, double time_s, Sample *sample, Err *err)
{
    const double near_s = time_s - SAME_TIME * time_s;
    size_t steps = 0;
    // a first step comes before the first sample, though it may have no length
    while (!walk->has_step || walk->reached_s < near_s) {
        if (!walk->solver->step(walk->state, time_s, err)) {
            return false;
        }
        walk->has_step = true;
        walk->reached_s = walk->solver->record(walk->state).end_s;
        if (++steps % BEAT_EVERY == 0) {
            beat(walk);
        }
    }
    beat(walk);
    walk->solver->observe(walk->state, fmin(time_s, walk->reached_s), sample);
    return true;
}

void walk_close(Walk *walk, size_t *steps, size_t *evaluations)
{
    const SolverModel model = walk->solver->model(walk->state);
    *steps += model.steps;
    *evaluations += model.evaluations;
    walk->solver->close(walk->state);
}
