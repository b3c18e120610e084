// How long will this take?
//
// A step of ODE costs the same all the way but for contacts, which are most frequent at the start:
// a first part of the run, timed, gives the whole within a factor of two.
#include "cli/long_work.h"

#include "run/registry.h"
#include "run/run.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

static const double LEAST_STEPS = 5e6; // below it no run of ODE takes a minute
static const double TIMED_STEPS = 3e4; // some 50 ms of work
static const double LONG = 60.0;       // s: who waits longer wants to know
static const RunWatch NOBODY = {NULL, NULL};

void long_work_words(double time_s, char *words, size_t size)
{
    if (time_s < 120.0) {
        snprintf(words, size, "%.0f s", time_s);
    } else if (time_s < 7200.0) {
        snprintf(words, size, "%.0f min", time_s / 60.0);
    } else if (time_s < 172800.0) {
        snprintf(words, size, "%.2g h", time_s / 3600.0);
    } else {
        snprintf(words, size, "%.3g days", time_s / 86400.0);
    }
}

static bool uses_ode(const RunOptions *run)
{
    for (size_t i = 0; i < run->backend_count; i++) {
        if (run->backends[i] == BACKEND_ODE) {
            return true;
        }
    }
    return false;
}

// What one step takes, s; 0 where the first part of the run fails.
static double time_step(const Scenario *scenario, double share)
{
    Scenario part = *scenario;
    part.run.revolutions *= share;
    part.run.duration *= share;
    Trajectory *run = run_scenario(&part, registry_solver(BACKEND_ODE), NOBODY);
    const double step_s =
        run->is_complete && run->steps > 0 ? run->wall_s / (double)run->steps : 0.0;
    trajectory_destroy(run);
    return step_s;
}

void long_work_announce(const Scenario *scenario)
{
    if (!uses_ode(&scenario->run) || !(scenario->run.step > 0.0)) {
        return;
    }
    const double steps = scenario_duration(scenario) / scenario->run.step;
    const double step_s = steps < LEAST_STEPS ? 0.0 : time_step(scenario, TIMED_STEPS / steps);
    if (steps * step_s > LONG) {
        char words[32];
        long_work_words(steps * step_s, words, sizeof words);
        fprintf(stderr, "jointplay: warning: ode takes about %s: %.2g steps at some %.2g us\n",
                words, steps, 1e6 * step_s);
    }
}
