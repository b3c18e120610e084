// Where the program, or the library that this code is part of, has its files.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// The folder above the program's own, or the one from which a library is found in lib, lib/ARCH or
// a folder of a build: the one with share/jointplay. Without a slash at its end. False where it is
// not known, or does not fit.
bool prefix_find(char *prefix, size_t size);
