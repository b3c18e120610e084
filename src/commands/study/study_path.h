// Where the stores of a study are, by their usual names.
#pragma once

#include "base/err.h"
#include "commands/study/design.h"
#include "write/file.h"

// The usual store of a study file or of a part of it, in the working folder: <stem>.sqlite, and
// <stem>.2-of-3.sqlite for the second of three. Fails with ERR_FILE where the path is too long.
bool study_path_store(const char *study, Shard shard, char path[FILE_PATH_SIZE], Err *err);

// The store that a word of the command line means: the word, or the usual one of a study file.
bool study_path_find(const char *word, char path[FILE_PATH_SIZE], Err *err);

// Whether the word names a study file, by its ending, and not a store.
bool study_path_is_study(const char *word);

// The parts of a study that stand in the working folder under their usual names, how many parts it
// was divided into; 0 where there is none. Fails with ERR_FILE where there are parts of several
// such divisions.
bool study_path_count_shards(const char *study, uint64_t *shards, Err *err);
