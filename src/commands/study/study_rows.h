// The rows of a study's store, for other programs: a row a run, by rising number of run.
#pragma once

#include "commands/study/store.h"

// As a table whose first line names the columns: the run, its settings, what became of it, its
// results, the hash of its trajectory in 16 hexadecimal digits, its wall time. What is not known or
// not finite is an empty cell. The path may be "-" for standard output. Memory does not grow with
// the number of runs. Fails with ERR_FILE.
bool study_rows_write_csv(Store *store, const char *path, Err *err);

// The same as lines of JSON, an object a run. What is not known or not finite is null.
bool study_rows_write_jsonl(Store *store, const char *path, Err *err);
