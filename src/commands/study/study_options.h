// What `jointplay study FILE` was asked for.
#pragma once

#include "base/err.h"
#include "cli/common_options.h"
#include "commands/study/design.h"
#include "write/file.h"

typedef struct StudyOptions {
    CommonOptions common; // its path that of the study file
    Shard shard;
    char store[FILE_PATH_SIZE]; // as given, or the usual one
    bool is_fresh;
    bool is_retrying;
    bool is_dry;
} StudyOptions;

extern const Arguments STUDY_ARGUMENTS;
StudyOptions study_options_default(void);

// Reads a part of a study, "2/3" being the second of three. ERR_USAGE.
bool study_options_read_shard(const char *text, Shard *shard, Err *err);
