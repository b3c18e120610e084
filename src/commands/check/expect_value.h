// What a run says of the limits that its case sets.
#pragma once

#include "measure/error.h"
#include "model/trajectory.h"

// Whether a limit concerns a backend: the one that it names, or each that feels the play of the
// scenario; of an error none that is the truth itself.
bool expect_value_concerns(const Expectation *expectation, const Scenario *scenario,
                           BackendKind backend);

// Whether a limit is one of an error.
bool expect_value_is_error(const Expectation *expectation);

// The number of a complete run, SI; of an error from the error given, which is NULL where there is
// none. NAN where the run does not have it.
double expect_value_of(const Expectation *expectation, const Trajectory *run,
                       const TrajectoryError *error);

// By how much a number is outside its limit, SI: 0 within it, below 0 under its low end. At an open
// end, where a number outside may be off by nothing, the least number that is not 0.
double expect_value_off(const Expectation *expectation, double value);
