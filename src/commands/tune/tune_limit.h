// The stops or the backlash of one pivot or slider as limits of a joint of Gazebo and MuJoCo.
#pragma once

#include "commands/tune/tune_report.h"

// Whether a case has that one joint with play and no other; its number.
bool tune_limit_alone(const Linkage *linkage, size_t *joint);

// Why no limit can be written, as a sentence without a full stop; NULL where one can be.
const char *tune_limit_lacks(const Scenario *scenario, size_t joint);

// The same where MuJoCo alone could not have it.
const char *tune_limit_lacks_range(const Scenario *scenario, size_t joint);

// The mass or inertia, kg or kg m^2, with which the linkage meets a push along that coordinate;
// NAN where the ideal joints are redundant.
double tune_limit_mass(const Scenario *scenario, const Motion *motions);

// Append the joint: of SDF with the constants as stop, of MJCF with solref and solimp of the limit.
void tune_limit_sdf(const TuneReport *report, ErpCfm row, Text *text);
void tune_limit_mjcf(const TuneReport *report, const double solref[2], double impedance,
                     Text *text);
