// The scripts that hand the shards of a study to Slurm: a job array, and a job that merges its
// stores.
#pragma once

#include "base/err.h"
#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    SLURM_ARRAY_USUAL = 1000,     // tasks of an array where MaxArraySize is its default of 1001
    SLURM_SHARD_LEAST = 2,        // a study in one part has nothing to gather
    SLURM_SHARD_MAX = 10000,      // jobs that a controller keeps unless MaxJobCount is raised
    SLURM_CPU_MAX = 256,          // of a task: runs at a time
    SLURM_REQUEUE_USUAL = 10,     // see `requeues`
    SLURM_REQUEUE_MAX = 1000,     //
    SLURM_TIME_LEAST_MINUTES = 5, // below, the warning a minute before the end, which Slurm gives
                                  // up to a minute early, leaves too little time to work
};

typedef struct SlurmJob {
    const char *program; // absolute path, as are the next two
    const char *study;   // the study file
    char **drivers;      // NAME=PROGRAM, with the whole path of each
    size_t driver_count;
    const char *folder;    // where scripts, logs and stores go
    const char *stem;      // that their names begin with
    size_t shards;         // tasks of the array
    size_t cpus;           // of a task: runs at a time
    size_t requeues;       // after which a task that is killed or runs out of time is left as it is
    const char *time;      // limit of a job as Slurm writes it, or NULL: that of the partition
    const char *memory;    // of a job as Slurm writes it, or NULL: that of the partition
    const char *partition; // or NULL
    const char *account;   // or NULL
} SlurmJob;

// Whether Slurm would take time, memory, partition and account as they are written. Fails with
// ERR_USAGE, saying what would be allowed.
bool slurm_check(const SlurmJob *job, Err *err);

// The scripts, by the endings of their names: STEM.array.sh, STEM.gather.sh, STEM.submit.sh.
typedef enum SlurmScript {
    SLURM_ARRAY,
    SLURM_GATHER,
    SLURM_SUBMIT,
    SLURM_SCRIPT_COUNT,
} SlurmScript;

void slurm_write(const SlurmJob *job, SlurmScript script, Text *text);
