// The spikes of a run's accelerations and forces, for other programs.
#pragma once

#include "commands/run/run_report.h"

#include <jansson.h>

// Puts count, threshold, resolution and the strongest spikes of one signal into the object of its
// body or joint, under keys that begin with `name`, such as "alpha"; null where they were not
// looked for. The units are those of the signal and of its impulse, as keys have them.
void spike_json_set(json_t *object, const char *name, const char *unit, const char *impulse_unit,
                    const Linkage *linkage, const SignalSpikes *spikes);

// What stands inside and outside of the paper's bands; null where they mean nothing.
json_t *spike_json_bands(const RunReport *report, const Trajectory *run);
