// What of a step lies after the instant at which the reported time begins: contacts under way there
// are cut, so that only what follows counts.
#pragma once

#include "model/solver.h"

typedef struct ReportCut {
    const Linkage *linkage;
    const Solver *solver; // is asked for forces within its last step; NULL: they are the step's
    const void *state;    // of the solver
    double from_s;        // where the reported time begins; 0: nothing is cut
    bool is_over;         // every step from now on is reported as a whole
    Sample sample;        // room
    double *recorded_s;   // by joint: up to where its impulses have been recorded; owned, as all
    bool *is_cut;         // by joint: whether the last record's impulse is from both sides
    double *after;        // N s, by joint: what of that impulse lies after
    double *before;       // N s, likewise before, as far as looks tell
    JointPeak *tops;      // by joint, of the time after, in that record
} ReportCut;

// Without a solver to ask, what a step did is spread evenly over it.
ReportCut report_cut_start(const Linkage *linkage, const Solver *solver, const void *state,
                           double from_s);
void report_cut_finish(ReportCut *cut);

// Looks into a step whose record is new. Returns whether the reported time begins within what the
// record tells of some joint.
bool report_cut_take(ReportCut *cut, const StepRecord *step);

// Whether what is recorded of a joint so far reaches beyond the start of the reported time.
static inline bool report_cut_has(const ReportCut *cut, size_t joint)
{
    return cut->is_over || cut->recorded_s[joint] > cut->from_s;
}
