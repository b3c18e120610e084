// The marks of a run's contacts for a page: what a script needs between its samples.
#pragma once

#include "commands/report/report_pack.h"
#include "model/trajectory.h"

#include <jansson.h>

// How many marks all runs of a page have together at most, and values of each.
enum { REPORT_MARKS_MOST = 3600, REPORT_MARK_VALUES = 11 };

// Adds to the JSON of a signal where it stands in a pack, and what its codes mean.
void report_signal_place(json_t *object, const PackedSignal *signal);

// Returns the list of the joints with play that have marks,
//     [{"joint", "count", "signals": [{"what", "offset", "count", "low", "slope", "step"}]}]
// whose signals are, of each mark in the order of time: "sample", the number of the kept sample
// before it, and "share", how far it is from there to the next; "kind" (ContactMarkKind); "ex_m",
// "ey_m", "force_x_N", "force_y_N", "force", "gap", "alpha_a_rad_s2", "alpha_b_rad_s2". Of more
// than `most` marks those of the strongest contacts of each joint are kept. Kept samples are
// interval_s apart, the first of them at from_s.
json_t *report_marks_json(const Trajectory *run, double from_s, double interval_s, size_t most,
                          Pack *pack);
