// One run of ODE held against the truth as it goes, for a step that is to be chosen.
#pragma once

#include "measure/truth.h"

// The part of a run in which a truth is sure enough, and what holds after it.
typedef struct TrialWindow {
    double until_s;     // the end of the run, the truth's horizon, or before it
    double uncertainty; // 1, of the truth up to there
    bool is_uncertain;  // it ends where the uncertainty grows too large
    double horizon_s;   // where it does, the truth's horizon or the end of the run
    double behind;      // 1: up to there, times the tolerance, what a run may be away
} TrialWindow;

// What a trial is held against, and when it is not worth running on.
typedef struct TrialRule {
    const Truth *truth;
    TrialWindow window; // in which errors count
    double tolerance;   // 1
    bool is_last;       // it is run to its end, though it misses the tolerance
    bool is_smooth;     // likewise, for its largest error says which step is next
} TrialRule;

typedef struct Trial {
    double step_s;
    Trajectory *run;   // owned; incomplete where it failed or was given up
    bool is_given_up;  // it missed the tolerance
    double held_error; // 1, largest while it held the tolerance
    double held_s;     // the last sample up to which it did; 0: not even the first
    double error;      // 1, at the sample after that; 0 where there is none
    double worst;      // 1, largest on the whole window, where the trial is run to its end
    bool holds;        // the tolerance on the whole window, and what is allowed behind it
} Trial;

// Runs the scenario, which has its step, and looks at every sample of it. The probe may be NULL.
Trial trial_make(const Scenario *scenario, const TrialRule *rule, RunWatch watch,
                 const RunProbe *probe);
void trial_finish(Trial *trial);

// The longest window from the start in which the uncertainty of the truth is at most `most`. It is
// empty, until_s being 0, where the truth is nowhere that sure. Another run of the reference is
// made only where the truth is not that sure up to its horizon.
TrialWindow trial_window(const Scenario *scenario, const Truth *truth, double most, RunWatch watch);
