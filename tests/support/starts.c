#include "starts.h"

#include "base/sorted.h"
#include "kept.h"
#include "model/growth.h"
#include "model/kinematics.h"
#include "run/registry.h"
#include "run/run.h"

#include <assert.h>

static const RunWatch NOBODY = {NULL, NULL};

static Trajectory *run(const Scenario *scenario, BackendKind backend)
{
    Trajectory *trajectory = run_scenario(scenario, registry_solver(backend), NOBODY);
    assert(trajectory->is_complete);
    return trajectory;
}

// Of a normal distribution with the same quartiles: the values of a chaotic motion come in groups,
// so that those next to the median say little of it.
static Median median_of(double *values, size_t count)
{
    const double deviations_apart = 1.349; // the quartiles
    const double of_median = 1.253;        // over that of a mean
    sorted_make(values, count);
    const double quartiles = values[(3 * count) / 4] - values[count / 4];
    return (Median){sorted_median(values, count),
                    of_median * quartiles / deviations_apart / sqrt((double)count)};
}

static Scenario start_of(const Scenario *scenario, const PerturbUnit *units, Starts starts,
                         size_t number)
{
    assert(starts.count <= STARTS_MAX);
    Scenario beside = kept_copy(scenario);
    perturb_start(&beside, units, starts.size, starts.seed * STARTS_MAX + (unsigned)number);
    return beside;
}

void starts_units(const Scenario *scenario, PerturbUnit units[KINEMATICS_BODY_MAX])
{
    Trajectory *own = run(scenario, BACKEND_REFERENCE);
    perturb_units(own, units);
    trajectory_destroy(own);
}

static double horizon_of(const Scenario *scenario)
{
    PerturbUnit units[KINEMATICS_BODY_MAX];
    PerturbBasis basis;
    Trajectory *own = run(scenario, BACKEND_REFERENCE);
    perturb_units(own, units);
    DistanceMeasure measure = distance_measure(own);
    perturb_basis(scenario, &measure, units, &basis);
    const Growth growth = growth_find(&(GrowthWork){
        .solver = registry_solver(BACKEND_REFERENCE),
        .scenario = scenario,
        .beside = own,
        .measure = &measure,
        .basis = &basis,
        .size = DISTANCE_PERTURBATION,
        .most = DISTANCE_GROWTH,
        .until_s = INFINITY,
    });
    assert(!growth.is_failed);
    distance_finish(&measure);
    trajectory_destroy(own);
    return growth.until_s;
}

Median starts_horizon(const Scenario *scenario, const PerturbUnit *units, Starts starts)
{
    double horizons[STARTS_MAX];
    for (size_t i = 0; i < starts.count; i++) {
        const Scenario beside = start_of(scenario, units, starts, i);
        horizons[i] = horizon_of(&beside);
    }
    return median_of(horizons, starts.count);
}

void starts_impact(const Scenario *scenario, const PerturbUnit *units, Starts starts, size_t joint,
                   Median *force, Median *impulse)
{
    double forces[STARTS_MAX];
    double impulses[STARTS_MAX];
    for (size_t i = 0; i < starts.count; i++) {
        const Scenario beside = start_of(scenario, units, starts, i);
        Trajectory *trajectory = run(&beside, BACKEND_ODE);
        forces[i] = trajectory->joints[joint].force_max.value;
        impulses[i] = trajectory->joints[joint].impulse;
        trajectory_destroy(trajectory);
    }
    *force = median_of(forces, starts.count);
    *impulse = median_of(impulses, starts.count);
}
