// Does any text bring the reader of baselines down, or pass it and then not be written back, or
// differ from itself?
#include "commands/check/baseline.h"
#include "commands/check/check_judge.h"
#include "commands/check/check_report.h"

#include "base/room.h"
#include "fuzz_check.h"
#include "fuzz_file.h"

#include <unistd.h>

static FuzzFile input;
static char output[64] = "/tmp/fuzz-baseline-XXXXXX"; // a folder, then a file in it

static void tidy(void)
{
    unlink(output);
    *strrchr(output, '/') = '\0';
    rmdir(output);
}

// A baseline is written beside its place and renamed, which a file in memory cannot be.
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    fuzz_check(mkdtemp(output) != NULL, "there is room for a folder");
    strcat(output, "/again.json");
    atexit(tidy);
    return 0;
}

// What a check would measure where nothing has moved.
static CheckMeasure *measure_of(const Baseline *baseline)
{
    static CheckMeasure measure; // its room is kept for the next
    measure.count = 0;
    measure.metrics =
        room_grow(measure.metrics, &measure.room, baseline->count, sizeof *measure.metrics);
    for (size_t i = 0; i < baseline->count; i++) {
        const BaselineMetric *metric = &baseline->metrics[i];
        CheckMetric *measured = &measure.metrics[measure.count++];
        *measured =
            (CheckMetric){.kind = metric->kind, .value = metric->value, .hash = metric->hash};
        memcpy(measured->name, metric->name, sizeof measured->name);
    }
    return &measure;
}

static void judge(const Baseline *baseline)
{
    const CheckEvidence evidence = {.run = measure_of(baseline), .now = baseline, .rate = 1e-3};
    CheckRow *rows = calloc(check_row_max(baseline, &evidence) + 1, sizeof *rows);
    fuzz_check(rows != NULL, "there is memory");
    const size_t count = check_judge(baseline, &evidence, rows);
    for (size_t i = 0; i < count; i++) {
        char words[CHECK_WORDS_SIZE];
        check_report_words(&rows[i], words);
        fuzz_check(!check_row_is_out(&rows[i]), "a baseline does not differ from itself");
    }
    free(rows);
}

static void write_back(const Baseline *baseline)
{
    Err err = {0};
    Baseline again;
    fuzz_check(baseline_json_write(output, baseline, &err), "a baseline can be written");
    fuzz_check(baseline_json_read(output, &again, &err), "and read from there");
    fuzz_check(again.count == baseline->count && again.setting_count == baseline->setting_count,
               "with all that was in it");
    baseline_finish(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Err err = {0};
    Baseline baseline;
    fuzz_file_fill(&input, data, size);
    if (baseline_json_read(input.path, &baseline, &err)) {
        judge(&baseline);
        write_back(&baseline);
        baseline_finish(&baseline);
    } else {
        fuzz_check_err(&err);
        fuzz_check(err.kind == ERR_FILE, "a bad baseline is an error of its file");
    }
    return 0;
}
