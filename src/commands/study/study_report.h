// What `jointplay study` did, for its writers. All of it belongs to others.
#pragma once

#include "commands/study/sweep.h"

typedef struct StudyReport {
    const Spec *spec;
    const char *store; // path
    Shard shard;
    size_t jobs;
    SweepState state;      // at the end of the sweep
    StoreCount count;      // of the store
    double children_cpu_s; // processor time of the processes that made runs and truths
    double own_cpu_s;      // of the one that started them and kept what they made
} StudyReport;

// The share of the jobs' time that was spent inside the processes of runs and truths, 0 to 1; NAN
// where nothing was made.
static inline double study_report_inside(const StudyReport *report)
{
    const double offered_s = (double)report->jobs * report->state.wall_s;
    return report->state.made > 0 && offered_s > 0.0 ? report->state.inside_s / offered_s : NAN;
}
