// Baselines as files: one metric a line, so that a change shows in a diff.
#pragma once

#include "commands/check/baseline.h"

// Reads a baseline; the caller finishes it. Fails with ERR_FILE where the file is missing, of
// another format, or damaged - no JSON, a key missing, unknown or doubled, a number that is none or
// not finite, a negative band, a sample that is not that of its median and mean - and says which.
// The baseline is then zeroed.
bool baseline_json_read(const char *path, Baseline *baseline, Err *err);

// Writes it, whole or not at all. ERR_FILE.
bool baseline_json_write(const char *path, const Baseline *baseline, Err *err);
