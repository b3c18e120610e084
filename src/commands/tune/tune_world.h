// A setting as a short C program against libjointplay: a world of ODE as its user would make it.
#pragma once

#include "base/text.h"
#include "model/linkage.h"
#include "model/scenario.h"

#include <math.h>

// What programs that are written have in common.

typedef struct TuneCode {
    const Scenario *scenario; // with the setting applied
    const char *words;        // what the setting is, in one line
    const char *command;      // the command line that does the same, as a shell takes it
    double error;             // 1, measured
    double target;            // 1; INFINITY where none was asked for
    double step_first_s;      // of the setting: a program may need a shorter step
    double error_first;       // 1, of the program with that step; NAN where it has none
} TuneCode;

// Of ODE's joints per step: what they stay open by costs the least there (docs/library.md).
static const double TUNE_WORLD_ERP = 1.5;

// How many steps of a program lie between two lines of its table, which are about a sample apart.
double tune_world_every(const Scenario *scenario);

// How many steps a program takes: what is left of the last one is rounding.
static inline size_t tune_world_steps(const Scenario *scenario)
{
    return (size_t)ceil(scenario_duration(scenario) / scenario->run.step - 1e-6);
}

// Why the library cannot do a case with its setting, as a sentence that ends without a full stop;
// NULL where it can.
const char *tune_world_lacks(const Scenario *scenario);

// Appends the program, of a case that the library can do. It prints a table of where the bodies are
// and how fast they turn, at steps that are about a sample apart. Fails with ERR_CASE where a law
// does not fit its joint.
bool tune_world_write(const TuneCode *code, Text *text, Err *err);

// The bodies, joints and forces of a case as lines of a C program against libjointplay.

// Whether a joint is one of ODE's in the program.
bool tune_world_is_ideal(const Linkage *linkage, int joint);

// What drives and pushes the bodies of a case as lines of a C program against libjointplay.

// Whether a spring at a joint moves anything: not where a drive says how the joint turns.
bool tune_world_has_effect(const Linkage *linkage, const TorsionSpring *spring);

// The angle, rad, at which a hinge of ODE's, which counts from where it starts, is at 0.
double tune_world_angle_at_start(const Linkage *linkage, int joint);

// Whether anything pushes where a step evaluates forces: springs, bushings, a torque over time.
bool tune_world_pushes(const Linkage *linkage);
