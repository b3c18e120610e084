// A run that nobody has computed: every body of a mechanism turns as a function says.
#pragma once

#include "model/trajectory.h"

#include <math.h>

// An angular velocity, rad/s, after so many revolutions of the crank.
typedef double MadeOmega(double revolutions);

// The caller destroys the trajectory.
static inline Trajectory *made_run(const Scenario *scenario, MadeOmega *omega)
{
    Trajectory *run = trajectory_create(scenario, "reference");
    run->is_complete = true;
    run->duration_s = scenario_duration(scenario);
    for (size_t k = 0; k < run->sample_count; k++) {
        run->times[k] = scenario_sample_time(scenario, k);
        run->crank_angles[k] = scenario->linkage.driver.speed * run->times[k];
        for (size_t i = 0; i < run->body_count; i++) {
            const double turns = run->times[k] / linkage_period(&scenario->linkage);
            run->motions[k * run->body_count + i].omega = omega(turns);
        }
    }
    return run;
}
