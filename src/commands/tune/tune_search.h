// Makes the runs of a search, each in a process of its own.
#pragma once

#include "commands/tune/tune.h"
#include "measure/task.h"

// What the search may use, and who is told of it.
typedef struct TuneSearch {
    Tune *tune;
    const Scenario *scenario;
    size_t jobs;                                    // runs at a time; timing runs go one by one
    double time_limit_s;                            // of one run
    void (*wait)(const char *doing, void *context); // a few times a second
    void *context;
} TuneSearch;

// The run of a scheme at a step or tolerance.
Task tune_search_task(const TuneSearch *search, LadderKind kind, const Truth *truth, size_t scheme,
                      double value);

// Makes the truth and searches: always the cheapest setting that is left, until what is left costs
// more than the best that meets the target. Then the plain rows on their own, the finest steps
// within the limit, the timing runs, and the linear contact. At a step that is held each scheme is
// run once, and only where none of them meets the target the longest step that does is searched.
// Fails with ERR_SOLVER where there is no truth, with ERR_USAGE where the target is too close to
// its uncertainty.
bool tune_search_execute(const TuneSearch *search, Err *err);
