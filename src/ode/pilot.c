// What would a run of this step find?
#include "ode/pilot.h"

#include "model/perturb.h"

#include <stdlib.h>

// twins pass the limit in jumps, at impacts, and which of them does is an accident of the trial:
// this many times further out the accident cannot cut the time short
static const double MARGIN = 2.0;

typedef struct Pilot {
    const Solver *solver;
    SolverPulse pulse;
    void *state;
    double reached_s;
} Pilot;

static bool open_pilot(Pilots *pilots, const Scenario *scenario, Pilot *pilot)
{
    *pilot = (Pilot){.solver = pilots->solver, .pulse = pilots->pulse};
    pilots->failure = (Err){ERR_NONE, ""};
    return pilot->solver->open(scenario, &pilot->state, &pilots->failure);
}

static void close_pilot(Pilots *pilots, Pilot *pilot)
{
    const SolverModel model = pilot->solver->model(pilot->state);
    pilots->steps += model.steps;
    pilots->evaluations += model.evaluations;
    pilot->solver->close(pilot->state);
}

// Goes on to a time and looks at the bodies there.
static bool sample_pilot(Pilot *pilot, double time_s, Sample *sample, Err *err)
{
    const double rounding_s = 1e-12 * time_s;
    do {
        if (pilot->reached_s > 0.0 && pilot->reached_s >= time_s - rounding_s) {
            break;
        }
        if (!pilot->solver->step(pilot->state, time_s, err)) {
            return false;
        }
        pilot->reached_s = pilot->solver->record(pilot->state).end_s;
    } while (pilot->reached_s < time_s - rounding_s);
    if (pilot->pulse.beat != NULL) {
        pilot->pulse.beat(pilot->pulse.context);
    }
    pilot->solver->observe(pilot->state, fmin(time_s, pilot->reached_s), sample);
    return true;
}

Trajectory *pilot_run(Pilots *pilots, const Scenario *scenario, const Scenario *grid,
                      double until_s)
{
    Pilot pilot;
    if (!open_pilot(pilots, scenario, &pilot)) {
        return NULL;
    }
    Trajectory *trajectory = trajectory_create(grid, pilot.solver->name);
    const size_t most = trajectory->sample_count;
    size_t count = 0;
    bool is_going = true;
    Sample sample;
    while (is_going && count < most && scenario_sample_time(grid, count) <= until_s) {
        is_going =
            sample_pilot(&pilot, scenario_sample_time(grid, count), &sample, &pilots->failure);
        if (is_going) {
            trajectory_store(trajectory, count++, &sample);
        }
    }
    close_pilot(pilots, &pilot);
    if (!is_going || count == 0) {
        trajectory_destroy(trajectory);
        return NULL;
    }
    trajectory->sample_count = count;
    trajectory->step_s = scenario->run.step;
    return trajectory;
}

// The time at which a twin has come too far from the trajectory, or `until_s`.
static double twin_horizon(Pilots *pilots, const Scenario *twin, const Scenario *grid,
                           const Trajectory *beside, const DistanceScale *scales, double until_s)
{
    Pilot pilot;
    double reached_s = 0.0;
    if (!open_pilot(pilots, twin, &pilot)) {
        return 0.0;
    }
    Trajectory *place = trajectory_create(grid, pilot.solver->name);
    Sample sample;
    size_t k = 0;
    for (; k < beside->sample_count && beside->times[k] <= until_s; k++) {
        if (!sample_pilot(&pilot, beside->times[k], &sample, &pilots->failure)) {
            break;
        }
        trajectory_store(place, k, &sample);
        if (!(distance_at(place, beside, k, scales) <= MARGIN * DISTANCE_GROWTH * DISTANCE_TWIN)) {
            break;
        }
        reached_s = beside->times[k];
    }
    const bool is_whole = k == beside->sample_count || beside->times[k] > until_s;
    trajectory_destroy(place);
    close_pilot(pilots, &pilot);
    return is_whole ? until_s : reached_s;
}

double pilot_horizon(Pilots *pilots, const Scenario *scenario, const Scenario *grid,
                     const DistanceScale *scales, double until_s)
{
    Trajectory *beside = pilot_run(pilots, scenario, grid, until_s);
    if (beside == NULL) {
        return 0.0;
    }
    for (unsigned member = 1; member <= DISTANCE_TWINS; member++) {
        Scenario twin = *scenario;
        perturb_start(&twin, scales, DISTANCE_TWIN, member);
        until_s = twin_horizon(pilots, &twin, grid, beside, scales, until_s);
    }
    trajectory_destroy(beside);
    return until_s;
}
