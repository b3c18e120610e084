// Which case does a seed stand for? Prints it as YAML.
//
// random_case KIND SEED > case.yaml
// The same kind and seed give the same case on every machine.
#include "random_case.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const CaseKind *const KINDS[] = {
    &CASE_FOUR_BAR,     &CASE_BODIES,   &CASE_PENDULA,    &CASE_FOUR_BARS, &CASE_LOCK,
    &CASE_CHANGE_POINT, &CASE_TOUCHING, &CASE_SEPARATING, &CASE_SPRUNG,    &CASE_SLIDERS,
    &CASE_BALLS,        &CASE_LIMITS,   &CASE_HOLES,      &CASE_ROTORS,    &CASE_RACKS,
    &CASE_GEARS,        &CASE_CAMS,     &CASE_SLOTS,      &CASE_RUN_UPS,   &CASE_SPACE,
    &CASE_SPACE_DRIVEN, &CASE_GROWING,  &CASE_SERVOS};

enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

static int usage(void)
{
    fprintf(stderr, "usage: random_case KIND SEED\nkinds:\n");
    for (size_t i = 0; i < KIND_COUNT; i++) {
        fprintf(stderr, "  %-12s %s\n", KINDS[i]->name, KINDS[i]->summary);
    }
    return 2;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        return usage();
    }
    char *end = NULL;
    errno = 0;
    const unsigned long long seed = strtoull(argv[2], &end, 10);
    if (errno != 0 || end == argv[2] || *end != '\0') {
        return usage();
    }
    for (size_t i = 0; i < KIND_COUNT; i++) {
        if (strcmp(argv[1], KINDS[i]->name) == 0) {
            KINDS[i]->write(seed, stdout);
            return 0;
        }
    }
    return usage();
}
