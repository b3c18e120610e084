// Does any text bring the reader of studies down, or pass it and then stand for runs that are none?
//
// The study lies in a folder of its own beside the project's cases, which a corpus made from
// cases/studies names. Runs are told and never made.
#include "commands/study/design.h"

#include "fuzz_check.h"

#include <sys/stat.h>
#include <unistd.h>

enum { RUN_MAX = 3, PATH_SIZE = 4096 };

static char folder[PATH_SIZE - 64] = "/tmp/fuzz-study-XXXXXX";
static char study[PATH_SIZE];

static void link_cases(const char *name)
{
    char target[PATH_SIZE];
    char link[PATH_SIZE];
    snprintf(target, sizeof target, "%s/%s", FUZZ_CASES, name);
    snprintf(link, sizeof link, "%s/%s", folder, name);
    fuzz_check(symlink(target, link) == 0, "the cases can be linked to");
}

static void tidy(void)
{
    char path[PATH_SIZE];
    static const char *const NAMES[] = {"studies/study.yaml", "paper", "literature"};
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, NAMES[i]);
        unlink(path);
    }
    snprintf(path, sizeof path, "%s/studies", folder);
    rmdir(path);
    rmdir(folder);
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    fuzz_check(mkdtemp(folder) != NULL, "there is room for a folder");
    atexit(tidy);
    link_cases("paper");
    link_cases("literature");
    snprintf(study, sizeof study, "%s/studies", folder);
    fuzz_check(mkdir(study, 0777) == 0, "a folder can be made");
    snprintf(study, sizeof study, "%s/studies/study.yaml", folder);
    return 0;
}

// The first, the middle and the last run: each a scenario, or refused with a reason.
static void check_runs(const Spec *spec)
{
    const uint64_t count = design_run_count(spec);
    fuzz_check(count > 0, "a study has runs");
    for (uint64_t i = 0; i < RUN_MAX; i++) {
        Cell values[RECORD_SETTING_MAX];
        Scenario scenario;
        BackendKind backend;
        Err err = {0};
        design_values(spec, i * ((count - 1) / (RUN_MAX - 1)), values);
        if (design_scenario(spec, values, &scenario, &backend, &err)) {
            scenario_free(&scenario);
        } else {
            fuzz_check_err(&err);
        }
    }
    const uint64_t parts = count < RUN_MAX ? count : RUN_MAX;
    uint64_t total = 0;
    for (uint64_t i = 0; i < parts; i++) {
        total += design_shard_count(spec, (Shard){i, parts});
    }
    fuzz_check(total == count, "the shards are the study");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static Spec spec;
    Err err = {0};
    FILE *file = fopen(study, "wb");
    fuzz_check(file != NULL && fwrite(data, 1, size, file) == size && fclose(file) == 0,
               "the study can be written");
    if (spec_read(study, &spec, &err)) {
        check_runs(&spec);
        spec_finish(&spec);
    } else {
        fuzz_check_err(&err);
        fuzz_check(err.kind == ERR_CASE || err.kind == ERR_USAGE,
                   "a bad study is an error of its file");
    }
    return 0;
}
