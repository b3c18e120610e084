// The history of every signal of a run, and the spikes in it.
#pragma once

#include "model/linkage.h"
#include "run/run.h"

// Finds the spikes of the run that it looks at.
extern const RunProbe TRACER_PROBE;

// Runs the scenario as run_scenario does and finds its spikes. Where the solver takes every joint
// as ideal, or each is, they are not looked for.
Trajectory *tracer_run(const Scenario *scenario, const Solver *solver, RunWatch watch);

// Which joints with play can make a spike of a body: those whose forces reach it through ideal
// joints, with no other play between. A driven body moves as it is told, and hands on nothing.

typedef struct Causes {
    size_t *set_of; // by body, that of the bodies that ideal joints connect it with; owned, as all
    size_t *firsts; // by set, and one more: where its joints begin in the list
    size_t *ends;   // each joint as 2 i or 2 i + 1
} Causes;

// How many joints can make a spike of a body, and one of them.
static inline size_t causes_count(const Causes *causes, size_t body)
{
    const size_t set = causes->set_of[body];
    return causes->firsts[set + 1] - causes->firsts[set];
}

static inline size_t causes_joint(const Causes *causes, size_t body, size_t index)
{
    return causes->ends[causes->firsts[causes->set_of[body]] + index] / 2;
}

Causes causes_find(const Linkage *linkage);
void causes_finish(Causes *causes);
