// The runs of a study, as the command line asks for them.
#pragma once

#include "commands/study/study_options.h"

// Makes them and prints what came of it. Fails with ERR_FILE and ERR_CASE where a file is wrong,
// with ERR_SOLVER where every run failed.
bool study_run(void *options, Err *err);

// Prints what would be run, and runs nothing.
bool study_run_dry(const StudyOptions *options, const Spec *spec, const Layout *layout, Err *err);
