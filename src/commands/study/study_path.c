// Where is the store of a study?
#include "commands/study/study_path.h"

#include <assert.h>
#include <dirent.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash == NULL ? path : slash + 1;
}

static int stem_length(const char *study)
{
    const char *base = base_name(study);
    const char *dot = strrchr(base, '.');
    return (int)(dot == NULL || dot == base ? strlen(base) : (size_t)(dot - base));
}

bool study_path_store(const char *study, Shard shard, char path[FILE_PATH_SIZE], Err *err)
{
    const int length =
        shard.count == 1
            ? snprintf(path, FILE_PATH_SIZE, "%.*s.sqlite", stem_length(study), base_name(study))
            : snprintf(path, FILE_PATH_SIZE, "%.*s.%" PRIu64 "-of-%" PRIu64 ".sqlite",
                       stem_length(study), base_name(study), shard.index + 1, shard.count);
    return length < FILE_PATH_SIZE ||
           err_set(err, ERR_FILE, "the path of the store of %s is too long", study);
}

bool study_path_is_study(const char *word)
{
    const char *dot = strrchr(base_name(word), '.');
    return dot != NULL && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0);
}

bool study_path_find(const char *word, char path[FILE_PATH_SIZE], Err *err)
{
    if (study_path_is_study(word)) {
        return study_path_store(word, (Shard){0, 1}, path, err);
    }
    return snprintf(path, FILE_PATH_SIZE, "%s", word) < FILE_PATH_SIZE ||
           err_set(err, ERR_FILE, "the path of the store is too long");
}

// The N of <stem>.I-of-N.sqlite; 0 where the name is another.
static uint64_t read_shards(const char *study, const char *name)
{
    const size_t stem = (size_t)stem_length(study);
    uint64_t index;
    uint64_t count;
    char made[FILE_PATH_SIZE];
    Err err = {0};
    if (strncmp(name, base_name(study), stem) != 0 ||
        sscanf(name + stem, ".%" SCNu64 "-of-%" SCNu64 ".sqlite", &index, &count) != 2) {
        return 0;
    }
    // it is the name only if it would be made just so
    const bool is_name = index >= 1 && index <= count && count > 1 && count <= DESIGN_SHARD_MAX &&
                         study_path_store(study, (Shard){index - 1, count}, made, &err) &&
                         strcmp(made, name) == 0;
    return is_name ? count : 0;
}

bool study_path_count_shards(const char *study, uint64_t *shards, Err *err)
{
    *shards = 0;
    DIR *folder = opendir(".");
    if (folder == NULL) {
        return true;
    }
    bool are_alike = true;
    for (const struct dirent *entry; are_alike && (entry = readdir(folder)) != NULL;) {
        const uint64_t count = read_shards(study, entry->d_name);
        are_alike =
            count == 0 || *shards == 0 || count == *shards ||
            err_set(err, ERR_FILE,
                    "there are stores of %" PRIu64 " and of %" PRIu64
                    " parts of %s here; take those of one away, or name the stores",
                    count < *shards ? count : *shards, count < *shards ? *shards : count, study);
        *shards = count > 0 ? count : *shards;
    }
    closedir(folder);
    return are_alike;
}
