// Reading a case file as a whole, and refusing what cannot be one.
#pragma once

#include "base/err.h"

#include <stddef.h>

enum { INPUT_SIZE_MAX = 1 << 20 }; // bytes; a case has some thousand

// Reads the file into *text (owned by the caller, ends in a zero). Fails with ERR_FILE where it is
// missing or unreadable, and with ERR_CASE where it is a directory or larger than INPUT_SIZE_MAX;
// the outputs are then untouched.
bool input_read(const char *path, char **text, size_t *size, Err *err);

// Whether it is text: not empty, valid UTF-8, no control characters. Fails with ERR_CASE and the
// offset of the first byte that is not.
bool input_check(const char *name, const char *text, size_t size, Err *err);
