// What the files are worth in which a setting is handed on: each has an error of its own, which is
// measured before it is written.
#pragma once

#include "commands/tune/tune.h"

typedef struct TuneFile {
    bool is_there;       // whether there is anything to write
    const char *option;  // that names it
    const char *measure; // where its error was found, for people
    double error;        // 1: NAN where it has none
    const char *reason;  // why it has none
    bool meets;          // the error and the truth's uncertainty are within the target, if any
    double step_s;
    size_t steps;
    double processor_s; // of the run that found the error
} TuneFile;

TuneFile tune_file(const TuneReport *report, TuneFileKind kind);

// Whether a file is to be written: one in a folder only where it is within the target. Where not,
// appends the reason.
bool tune_file_is_wanted(const TuneReport *report, TuneFileKind kind, Text *reason);

// Appends a line for each file that is asked for: its step, error and cost, and by how much it
// misses the target.
void tune_files_write(const TuneReport *report, Text *text);

// Fails with ERR_DIFFERS where a file that is asked for by its name misses the target: which one,
// and by how much.
bool tune_files_check(const TuneReport *report, Err *err);
