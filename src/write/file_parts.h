// The files that are being written, each beside its target until it is whole.
#pragma once

#include "base/err.h"

#include <stdbool.h>
#include <stddef.h>

// The name of the part of this process: <target>.part-<process>. False where it is too long.
bool file_parts_name(const char *target, char *part, size_t size);

// Makes and locks the part, and takes away those that processes which are no more have left of the
// same target. It is as open to others as the target is, where there is one. Its descriptor; -1,
// with errno set.
int file_parts_make(const char *target, const char *part);
