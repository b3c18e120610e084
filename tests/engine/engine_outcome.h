// Runs cases on an engine in a test, and holds what came of it against a truth.
#pragma once

#include "engine/driver.h"

#include "close.h"
#include "load_case.h"

#include "measure/error.h"
#include "measure/ladder.h"
#include "run/registry.h"
#include "run/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const RunWatch NOBODY = {NULL, NULL};
static const double LIMIT_S = 60.0; // a run takes .1 s

static inline EngineDriver engine_named(const char *name)
{
    EngineDriver driver;
    Err err = {0};
    if (!engine_find(name, &driver, &err)) {
        fail_msg("%s", err.text);
    }
    return driver;
}

typedef struct Outcome {
    TrajectoryError error;
    EngineSaid said;
    double force_ratio; // of the largest force in the first joint with play, over the reference's
} Outcome;

static inline size_t joint_with_play(const Scenario *scenario)
{
    size_t joint = 0;
    while (joint + 1 < scenario->linkage.joint_count &&
           !linkage_has_play(&scenario->linkage.joints[joint])) {
        joint++;
    }
    return joint;
}

static inline Outcome hold_against(const Scenario *scenario, Trajectory *run, BackendKind truth)
{
    Outcome outcome = {.force_ratio = 0.0};
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    Trajectory *reference = run_scenario(scenario, registry_solver(truth), NOBODY);
    const size_t joint = joint_with_play(scenario);
    outcome.error = error_against(run, reference, INFINITY);
    outcome.force_ratio =
        run->joints[joint].force_max.value / reference->joints[joint].force_max.value;
    trajectory_destroy(reference);
    trajectory_destroy(run);
    return outcome;
}

static inline Outcome outcome_of(const char *engine, const char *way, const Scenario *scenario,
                                 BackendKind truth)
{
    const EngineDriver driver = engine_named(engine);
    EngineSaid said;
    Trajectory *run = engine_run(&driver, way, scenario, LIMIT_S, &said);
    Outcome outcome = hold_against(scenario, run, truth);
    outcome.said = said;
    return outcome;
}

// The paper's mechanism in the motion that the figures are of: from the pin in the middle of its
// hole, one impact and its followers, in a third of a revolution.
static inline Scenario impact(double step_s)
{
    static const char *const OVERRIDES[] = {"run.start=centred", "run.revolutions=0.3",
                                            "ode.stepping=staggered", "ode.map=impulse"};
    Scenario scenario = load("cases/paper/impact-k66.yaml", OVERRIDES, 4);
    scenario.run.step = step_s;
    return scenario;
}
