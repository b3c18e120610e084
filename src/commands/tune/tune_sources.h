// The program's own sources, as far as a run of ODE needs them, for code that is handed out.
#pragma once

#include "base/err.h"
#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

// Appends source files one behind another as one translation unit: those asked for, all headers
// they include, and the files that implement those headers, each once, with every include of our
// own taken out. What implements a header but is another stepping or collider than those asked for
// is left out. Fails with ERR_FILE where a file is not among those that the program carries.
bool tune_sources_write(const char *const *files, size_t file_count, Text *text, Err *err);
