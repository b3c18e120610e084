// The short form of a slider-crank: does it close and turn, and which linkage is it?
#pragma once

#include "casefile/entries.h"

// Fails where the mechanism does not close at its start, or the crank cannot turn through the run.
bool slider_check(const Entries *entries, const Scenario *scenario, Err *err);

// Places joints and bodies; the drive and the joints' play are those of the scenario. Fails with
// ERR_SOLVER where it cannot be solved at its start.
bool slider_build(Scenario *scenario, Err *err);

// How far from its first joint the centre of mass of a body is, m: half of a link, 0 of the slider.
double slider_centre(const SliderCrank *mechanism, int body);
