// Files that a test makes and takes away again.
#pragma once

#include "close.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

// A path that nothing else uses.
static inline void scratch_path(const char *name, char *path, size_t size)
{
    const char *folder = getenv("TMPDIR");
    snprintf(path, size, "%s/jointplay-%ld-%s", folder == NULL ? "/tmp" : folder, (long)getpid(),
             name);
}

static inline void read_whole(const char *path, char *target, size_t size)
{
    FILE *stream = fopen(path, "r");
    assert_non_null(stream);
    target[fread(target, 1, size - 1, stream)] = '\0';
    fclose(stream);
}
