// What is a short run of a study besides its steps?
//
// 60 steps each of three cases, as a study makes them: the case with another speed of the drive, by
// casefile_load_text, which reads it anew, or by casefile_repeat, which has read it; then the run.
// us of processor time, medians of rounds in which the ways take turns, and their ratio to the run
// itself and to each other.
#include "base/clock.h"
#include "base/sorted.h"
#include "casefile/casefile.h"
#include "casefile/input.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 21, RUNS = 40, SETTINGS = 5, PATH_SIZE = 1024, SPEED_SIZE = 64 };

typedef struct ShortRun {
    const char *name;
    const char *path;
    const char *settings[SETTINGS]; // the speed comes last
} ShortRun;

static const ShortRun SHORT_RUNS[] = {
    {"ideal, plain",
     "paper/ideal-nominal.yaml",
     {"run.revolutions=1", "run.samples=60", "run.step=1 ms", "ode.stepping=plain", NULL}},
    {"textbook",
     "paper/impact-k66.yaml",
     {"run.revolutions=0.1", "run.samples=60", "run.step=100 us", "ode.map=textbook", NULL}},
    {"impulse",
     "paper/impact-k66.yaml",
     {"run.revolutions=0.1", "run.samples=60", "run.step=100 us", "ode.map=impulse", NULL}},
};

typedef struct Bench {
    const char *text;
    size_t size;
    CasefileRepeat *repeat; // NULL: the case is read anew
    bool has_run;
} Bench;

static void make(const Bench *bench, const ShortRun *of, int number)
{
    char speed[SPEED_SIZE];
    const char *settings[SETTINGS];
    Scenario scenario;
    Err err = {0};
    snprintf(speed, sizeof speed, "drive.speed=%.17g rpm", 990.0 + 0.1 * number);
    memcpy(settings, of->settings, sizeof settings);
    settings[SETTINGS - 1] = speed;
    if (!(bench->repeat != NULL
              ? casefile_repeat(bench->repeat, settings, SETTINGS, &scenario, &err)
              : casefile_load_text("case.yaml", bench->text, bench->size, settings, SETTINGS,
                                   &scenario, &err))) {
        fprintf(stderr, "%s\n", err.text);
        exit(1);
    }
    if (bench->has_run) {
        trajectory_destroy(
            run_scenario(&scenario, registry_solver(BACKEND_ODE), (RunWatch){.progress = NULL}));
    }
    scenario_free(&scenario);
}

static double measure(const Bench *bench, const ShortRun *of)
{
    const double started_s = clock_processor_s();
    for (int i = 0; i < RUNS; i++) {
        make(bench, of, i);
    }
    return (clock_processor_s() - started_s) / RUNS;
}

static void print_row(const ShortRun *of)
{
    char path[PATH_SIZE];
    Bench anew = {.has_run = false};
    char *text;
    Err err = {0};
    snprintf(path, sizeof path, "%s/%s", getenv("JOINTPLAY_CASES"), of->path);
    if (!input_read("case", path, &text, &anew.size, &err)) {
        fprintf(stderr, "%s\n", err.text);
        exit(1);
    }
    anew.text = text;
    Bench repeated = anew;
    repeated.repeat = casefile_repeat_open("case.yaml", text, anew.size, false);
    Bench whole = repeated;
    whole.has_run = true;
    const Bench *const ways[] = {&anew, &repeated, &whole};
    double times[3][ROUNDS];
    double medians[3];
    for (int round = 0; round < ROUNDS; round++) {
        for (int way = 0; way < 3; way++) {
            times[way][round] = measure(ways[way], of);
        }
    }
    for (int way = 0; way < 3; way++) {
        sorted_make(times[way], ROUNDS);
        medians[way] = sorted_median(times[way], ROUNDS);
    }
    const double run_s = medians[2] - medians[1];
    printf("%-14s %10.1f %14.1f %14.1f %12.2f %12.2f %12.2f\n", of->name, 1e6 * run_s,
           1e6 * medians[0], 1e6 * medians[1], medians[0] / run_s, medians[1] / run_s,
           (medians[0] + run_s) / medians[2]);
    casefile_repeat_close(repeated.repeat);
    free(text);
}

int main(void)
{
    printf("%-14s %10s %14s %14s %12s %12s %12s\n", "60 steps", "run, us", "read anew, us",
           "repeated, us", "anew/run", "repeated/run", "anew/repeated");
    for (size_t i = 0; i < sizeof SHORT_RUNS / sizeof *SHORT_RUNS; i++) {
        print_row(&SHORT_RUNS[i]);
    }
    return 0;
}
