// Says how long work will take.
//
// A step of ODE costs the same all the way but for contacts, which are most frequent at the start:
// a first part of the run, timed, gives the whole within a factor of two.
#include "cli/long_work.h"

#include "cli/output.h"
#include "run/registry.h"
#include "run/run.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

static const double LEAST_STEPS = 2e6; // shorter runs of ODE are not timed
static const double TIMED_STEPS = 3e4; // some 50 ms of work
static const double LONG = 60.0;       // s: longer work is announced where progress is shown
static const double LONG_QUIET = 20.0; // s: likewise, where none is shown
static const RunWatch NOBODY = {NULL, NULL};

void long_work_time(double time_s, char words[LONG_WORK_TIME_SIZE])
{
    const size_t size = LONG_WORK_TIME_SIZE;
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

double long_work_limit(bool is_quiet)
{
    return is_quiet ? LONG_QUIET : LONG;
}

bool long_work_warn(const char *what, double time_s, bool is_quiet)
{
    if (!(time_s > long_work_limit(is_quiet))) {
        return false;
    }
    char words[LONG_WORK_TIME_SIZE];
    long_work_time(time_s, words);
    output_say("jointplay: warning: %s takes about %s\n", what, words);
    return true;
}

bool long_work_announce(const Scenario *scenario, bool is_quiet)
{
    if (!uses_ode(&scenario->run) || !(scenario->run.step > 0.0)) {
        return false;
    }
    const double steps = scenario_duration(scenario) / scenario->run.step;
    const double step_s = steps < LEAST_STEPS ? 0.0 : time_step(scenario, TIMED_STEPS / steps);
    char what[64];
    snprintf(what, sizeof what, "ode, with %.2g steps at some %.2g us,", steps, 1e6 * step_s);
    return long_work_warn(what, steps * step_s, is_quiet);
}
