// A setting as a short C program against libjointplay: a world of ODE as its user would make it.
#pragma once

#include "commands/tune/tune_code_text.h"

// Of ODE's joints per step: what they stay open by costs the least there (docs/library.md).
static const double TUNE_WORLD_ERP = 1.5;

// How many steps of a program lie between two lines of its table, which are about a sample apart.
double tune_world_every(const Scenario *scenario);

// Why the library cannot do a case with its setting, as a sentence that ends without a full stop;
// NULL where it can.
const char *tune_world_lacks(const Scenario *scenario);

// Appends the program, of a case that the library can do. It prints a table of where the bodies are
// and how fast they turn, at steps that are about a sample apart. Fails with ERR_CASE where a law
// does not fit its joint.
bool tune_world_write(const TuneCode *code, Text *text, Err *err);
