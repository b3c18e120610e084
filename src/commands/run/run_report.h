// Everything there is to tell about the runs of one case: plain pointers, nothing owned.
#pragma once

#include "analytic/stackup.h"
#include "analytic/summary.h"
#include "measure/ensemble.h"
#include "measure/error.h"
#include "measure/spike_match.h"
#include "measure/truth.h"

#include <string.h>

// The contacts of one run beside the reference's, by joint.
typedef struct RunMatches {
    SpikeMatch joints[LINKAGE_JOINT_MAX];
} RunMatches;

typedef struct RunReport {
    const Scenario *scenario;
    size_t run_count;
    Trajectory *const *runs;        // one a backend, in the order in which they ran
    const TrajectoryError *errors;  // one a run; not known for the run that is the truth
    const AnalyticSummary *summary; // NULL where the closed form had no part in it
    const char *no_summary;         // why there is none though it was asked for, or NULL
    const Stackup *stackup;         // NULL where the closed form had no part in it
    const char *no_stackup;         // why there is none though it was asked for, or NULL
    const Truth *truth;             // NULL where no reference was asked for
    const RunMatches *matches;      // one a run; NULL without a reference
    const Ensemble *ensembles;      // one a run, some empty; NULL where the motion is predictable
} RunReport;

// Whether there is a certified solution.
static inline bool run_report_has_truth(const RunReport *report)
{
    return report->truth != NULL && report->truth->trajectory->is_complete;
}

// Whether an error is against the certified solution, so that uncertainty and horizon belong to it.
static inline bool run_report_is_certified(const RunReport *report, const TrajectoryError *error)
{
    return error->is_known && run_report_has_truth(report) && report->truth->message[0] == '\0' &&
           strcmp(error->against, report->truth->trajectory->backend) == 0;
}

static inline bool run_report_is_limited_by_reference(const RunReport *report,
                                                      const TrajectoryError *error)
{
    return run_report_is_certified(report, error) &&
           error->omega_max_in_horizon < ERROR_CLEAR_OF_TRUTH * report->truth->uncertainty;
}

// Whether errors against the reference contain more than a solver's own: it knows contact by its
// elastic law alone.
static inline bool run_report_mixes_models(const RunReport *report)
{
    return run_report_has_truth(report) && report->scenario->contact.model == CONTACT_POISSON &&
           scenario_has_clearance(report->scenario);
}

// Whether the error of a run is that of ideal joints against joints with play.
static inline bool run_report_includes_play(const RunReport *report, size_t run)
{
    const char *ideal = OPTIONS_BACKENDS[BACKEND_ANALYTIC];
    return scenario_has_clearance(report->scenario) &&
           (strcmp(report->errors[run].against, ideal) == 0 ||
            strcmp(report->runs[run]->backend, ideal) == 0);
}
