// The rows of a study's store, for a program: a line of JSON a run.
#pragma once

#include "commands/study/store.h"

// The same columns as study_csv_write, each a name of the object. What is not known or not finite
// is null. The path may be "-" for standard output. Memory does not grow with the number of runs.
// Fails with ERR_FILE.
bool study_jsonl_write(Store *store, const char *path, Err *err);
