// What `jointplay study` did, and what it prints with --json.
#pragma once

#include "commands/study/sweep.h"

#include <jansson.h>

// All of it belongs to others.
typedef struct StudyReport {
    const Spec *spec;
    const char *store; // path
    Shard shard;
    size_t jobs;
    SweepState state;      // at the end of the sweep
    StoreCount count;      // of the store
    double children_cpu_s; // processor time of the processes that made runs and truths
    double own_cpu_s;      // of the one that started them and kept what they made
    double inside_share;   // of the jobs' time that was spent inside the processes of runs and
                           // truths, 0 to 1; NAN where nothing was made
} StudyReport;

json_t *study_json_build(const StudyReport *report);
