// Writes the random cases of a seed as case files.
//
//     settled_random SEED DIR
//
// DIR exists; the files are DIR/cam-01.yaml to DIR/slider-crank-60.yaml. Names of settled_truth (A,
// B, C, G, D600) instead of SEED write that case alone.
#include "settled_case.h"

#include <stdlib.h>

enum { PATH_LENGTH = 4096 };

static bool write_file(const SettledCase *sizes, const char *folder)
{
    char path[PATH_LENGTH];
    const int length = snprintf(path, sizeof path, "%s/%s.yaml", folder, sizes->name);
    FILE *file = length < PATH_LENGTH ? fopen(path, "w") : NULL;
    if (file == NULL) {
        fprintf(stderr, "settled_random: %s cannot be written\n", path);
        return false;
    }
    settled_case_write(sizes, file);
    return fclose(file) == 0;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: settled_random SEED DIR\n");
        return 2;
    }
    SettledCase sizes;
    if (settled_case_named(argv[1], &sizes)) {
        return write_file(&sizes, argv[2]) ? 0 : 1;
    }
    const uint64_t seed = strtoull(argv[1], NULL, 10);
    bool is_written = true;
    for (int number = 1; number <= SETTLED_CASES && is_written; number++) {
        sizes = settled_case_draw(seed, number);
        is_written = write_file(&sizes, argv[2]);
    }
    return is_written ? 0 : 1;
}
