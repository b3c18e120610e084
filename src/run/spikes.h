// The spikes of a signal, from its trace.
#pragma once

#include "model/signal_spikes.h"
#include "run/trace.h"

// Finds the spikes whose prominence is at least the threshold, above 0, in the order of their
// peaks. Fills in all of each but crank angle and joint, which is -1. `spikes` receives an array
// that the caller frees, NULL where there are none. Returns how many. The trace must be closed.
size_t spikes_find(const Trace *trace, double threshold, SignalSpike **spikes);
