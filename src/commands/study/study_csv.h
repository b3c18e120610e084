// The rows of a study's store, for a spreadsheet or pandas.
#pragma once

#include "commands/study/store.h"

// Writes a heading and a line a run, by rising number of run: run, its settings, fate, reason, its
// results, hash (16 hexadecimal digits), wall_s. What is not known is an empty cell. The path may
// be "-" for standard output. Memory does not grow with the number of runs. Fails with ERR_FILE.
bool study_csv_write(Store *store, const char *path, Err *err);
