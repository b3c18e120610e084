// Files that the program writes, each with a message on standard error unless quiet.
#pragma once

#include "base/err.h"
#include "write/file.h"
#include "write/journal.h"

// Says that a file was written, unless it is a stream; always true.
bool written_say(const char *path, bool is_quiet);

// Says, unless quiet, which lines of a journal are damaged, if any.
void written_damage(const Journal *journal, bool is_quiet);

// Writes text to a file, whole or not at all. ERR_FILE.
bool written_text(FileKind kind, const char *path, const char *text, bool is_quiet, Err *err);
