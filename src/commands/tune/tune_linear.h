// What a contact with constant spring and damper delivers, as Gazebo and MuJoCo have it.
#pragma once

#include "commands/tune/tune.h"
#include "commands/tune/tune_runs.h"
#include "kernel/force_law.h"

// The damper, N s/m, beside a spring, N/m, that gives an effective mass, kg, the restitution asked
// for in a free impact.
double tune_linear_damping(double stiffness, double mass, double restitution);

// The scenario with the contact made linear, kp and kd by the textbook map or the row itself: plain
// stepping, direct solver.
Scenario tune_linear_scenario(const Scenario *scenario, const TuneLinear *linear);

// Why there can be no constants of a case, known before the search, as a sentence without a full
// stop; NULL where there can be. The second: none for MuJoCo.
const char *tune_linear_lacks_case(const Scenario *scenario);
const char *tune_linear_lacks_range(const Scenario *scenario);

// Why there are none after a search, likewise.
const char *tune_linear_lacks(const Scenario *scenario, const Tune *tune);

// Looks up the deepest contact in the truth, runs constants taken from it at several depths and
// steps against the truth, and chooses among them. Does nothing where no joint has play.
bool tune_linear_run(const TuneSearch *search, Err *err);

// The stops or the backlash of one pivot or slider as limits of a joint of Gazebo and MuJoCo.

// The same where MuJoCo alone could not have it.
const char *tune_limit_lacks_range(const Scenario *scenario, size_t joint);

// Append the joint: of SDF with the constants as stop, of MJCF with solref and solimp of the limit.
void tune_limit_sdf(const TuneReport *report, ErpCfm row, Text *text);
void tune_limit_mjcf(const TuneReport *report, const double solref[2], double impedance,
                     Text *text);
