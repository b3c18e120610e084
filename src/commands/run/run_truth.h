// How far off the runs are: errors with the reference's own uncertainty, energy, matched contacts,
// and, where the motion cannot be predicted, distributions in place of errors.
#pragma once

#include "base/text.h"
#include "commands/run/run_report.h"
#include "write/style.h"

// The errors against the run that is taken as the truth, and what limits them; nothing where there
// is none.
void run_truth_errors(const RunReport *report, const Style *style, Text *text);

// Where the energy went, one row a backend.
void run_truth_energy(const RunReport *report, const Style *style, Text *text);

// The strongest contacts beside those of the reference; nothing where none were matched.
void run_truth_matches(const RunReport *report, const Style *style, Text *text);

// What many starts gave beyond the horizon; nothing where they were not run.
void run_truth_ensembles(const RunReport *report, const Style *style, Text *text);
