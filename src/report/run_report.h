// Everything there is to tell about the runs of one case: plain pointers, nothing owned.
#pragma once

#include "analytic/stackup.h"
#include "analytic/summary.h"
#include "compare/error.h"

#include <string.h>

typedef struct RunReport {
    const Scenario *scenario;
    size_t run_count;
    Trajectory *const *runs;        // one a backend, in the order in which they ran
    const TrajectoryError *errors;  // one a run; not known for the run that is the truth
    const AnalyticSummary *summary; // NULL where the closed form had no part in it
    const Stackup *stackup;         // likewise
} RunReport;

// Whether the run let the play of a joint happen: it is complete, the joint has play, and the
// solver is not the closed form, which takes every joint as ideal.
static inline bool run_report_feels_play(const Trajectory *run, const Joint *joint)
{
    return run->is_complete && joint->kind == JOINT_CLEARANCE &&
           strcmp(run->backend, OPTIONS_BACKENDS[BACKEND_ANALYTIC]) != 0;
}
