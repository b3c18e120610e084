// The truth, errors against it, energy, matched contacts and ensembles, as JSON.
#pragma once

#include "commands/run/run_report.h"

#include <jansson.h>

// New references. Each is null where there is nothing to tell: no reference, no error, no contacts
// matched, a motion that can be predicted.
json_t *run_truth_json_truth(const RunReport *report);
json_t *run_truth_json_error(const RunReport *report, size_t run);
json_t *run_truth_json_matches(const RunReport *report, size_t run);
json_t *run_truth_json_ensemble(const RunReport *report, size_t run);

json_t *run_truth_json_energy(const Energy *energy);
