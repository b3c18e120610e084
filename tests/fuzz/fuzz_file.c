#define _GNU_SOURCE // memfd_create
#include "fuzz_file.h"

#include "fuzz_check.h"

#include <sys/mman.h>
#include <unistd.h>

void fuzz_file_fill(FuzzFile *file, const void *data, size_t size)
{
    if (file->file == 0) {
        file->file = memfd_create("input", MFD_CLOEXEC);
        snprintf(file->path, sizeof file->path, "/proc/self/fd/%d", file->file);
    }
    fuzz_check(ftruncate(file->file, 0) == 0 && pwrite(file->file, data, size, 0) == (ssize_t)size,
               "a file in memory takes its bytes");
}
