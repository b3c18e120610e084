// Input as a file, for readers that take a path: one in memory, used again for every input.
#pragma once

#include <stddef.h>

enum { FUZZ_FILE_PATH_SIZE = 64 };

typedef struct FuzzFile {
    int file; // 0 before the first use
    char path[FUZZ_FILE_PATH_SIZE];
} FuzzFile;

// Makes the file hold these bytes and nothing else.
void fuzz_file_fill(FuzzFile *file, const void *data, size_t size);
