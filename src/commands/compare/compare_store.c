// Where does a comparison keep what it has finished?
#include "commands/compare/compare_store.h"

#include "base/hash.h"
#include "cli/output.h"
#include "cli/written.h"
#include "commands/compare/ladder_json.h"
#include "write/build_print.h"
#include "write/file.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ENTRY_LINE = 2 }; // of the first entry: the key stands before it

static void find_machine(char machine[COMPARE_MACHINE_SIZE])
{
    char line[512];
    snprintf(machine, COMPARE_MACHINE_SIZE, "an unknown processor");
    FILE *stream = fopen("/proc/cpuinfo", "r");
    while (stream != NULL && fgets(line, sizeof line, stream) != NULL) {
        const char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && colon != NULL) {
            line[strcspn(line, "\n")] = '\0';
            snprintf(machine, COMPARE_MACHINE_SIZE, "%.*s", COMPARE_MACHINE_SIZE - 1,
                     colon + 1 + strspn(colon + 1, " \t"));
            break;
        }
    }
    if (stream != NULL) {
        fclose(stream);
    }
}

// The usual path: a name of its own for every key.
static bool find_path(const json_t *key, char path[FILE_PATH_SIZE], Err *err)
{
    const char *cache = getenv("XDG_CACHE_HOME");
    const char *home = getenv("HOME");
    const bool has_cache = cache != NULL && cache[0] == '/';
    if (!has_cache && (home == NULL || home[0] == '\0')) {
        return err_set(err, ERR_USAGE,
                       "there is no folder for the store; --store FILE names the file");
    }
    char folder[FILE_PATH_SIZE];
    int length = snprintf(folder, sizeof folder, "%s%s/jointplay", has_cache ? cache : home,
                          has_cache ? "" : "/.cache");
    if (length >= FILE_PATH_SIZE || !file_make_folder(folder, err)) {
        return err_set(err, ERR_FILE, "the path of the store is too long");
    }
    char *words = json_dumps(key, JSON_REAL_PRECISION(17) | JSON_COMPACT | JSON_SORT_KEYS);
    assert(words != NULL);
    length = snprintf(path, FILE_PATH_SIZE, "%s/compare-%016" PRIx64 ".jsonl", folder,
                      hash_bytes(HASH_START, words, strlen(words)));
    free(words);
    return length < FILE_PATH_SIZE || err_set(err, ERR_FILE, "the path of the store is too long");
}

static bool take_all(CompareStore *store, Ladder *ladder, bool is_quiet, Err *err)
{
    size_t others = 0;
    size_t index;
    json_t *line;
    json_array_foreach(store->journal.entries, index, line)
    {
        if (json_is_null(line)) {
            continue; // damaged
        }
        const LadderJsonTaken taken =
            ladder_json_take(ladder, store->linkage, line, store->machine);
        if (taken == LADDER_JSON_DAMAGED) {
            return err_set(err, ERR_FILE,
                           "line %zu of the store %s is damaged; --fresh starts it over",
                           index + ENTRY_LINE, store->journal.path);
        }
        const bool is_run =
            json_object_get(line, "error") != NULL || json_object_get(line, "timing") != NULL;
        store->taken += taken == LADDER_JSON_TAKEN && is_run ? 1 : 0;
        others += taken == LADDER_JSON_OTHER_MACHINE ? 1 : 0;
    }
    if (is_quiet) {
        return true;
    }
    written_damage(&store->journal, is_quiet);
    if (store->taken > 0) {
        output_say("took %zu of %zu runs from the store %s\n", store->taken,
                   ladder_run_total(ladder), store->journal.path);
    }
    if (others > 0) {
        output_say("left %zu timing runs of another machine there\n", others);
    }
    return true;
}

bool compare_store_open(CompareStore *store, const CompareOptions *options,
                        const Scenario *scenario, Ladder *ladder, Err *err)
{
    char build[BUILD_PRINT_SIZE];
    char path[FILE_PATH_SIZE];
    *store = (CompareStore){.linkage = &scenario->linkage, .ladder = ladder};
    build_print(build);
    find_machine(store->machine);
    json_t *key = ladder_json_key(ladder, scenario, build);
    const char *file = options->store != NULL ? options->store : path;
    const bool is_open =
        (options->store != NULL || find_path(key, path, err)) &&
        file_claim("--store", FILE_JOURNAL, file, err) &&
        journal_open(&store->journal, &JOURNAL_COMPARE, file, key, options->is_fresh, err);
    json_decref(key);
    return is_open && take_all(store, ladder, options->common.is_quiet, err);
}

bool compare_store_keep_truth(const LadderTruth *truth, void *context, Err *err)
{
    CompareStore *store = context;
    return journal_add(&store->journal, ladder_json_truth(truth), err);
}

bool compare_store_keep_run(const LadderRun *run, void *context, Err *err)
{
    CompareStore *store = context;
    // what died or hung is tried again when the comparison goes on
    return run->is_lost ||
           journal_add(&store->journal, ladder_json_run(store->ladder, run, store->machine), err);
}

bool compare_store_keep_ensemble(size_t scheme, const LadderEnsemble *ensemble, void *context,
                                 Err *err)
{
    CompareStore *store = context;
    return ensemble->ensemble.members == 0 ||
           journal_add(&store->journal,
                       ladder_json_ensemble(store->ladder, store->linkage, scheme, ensemble), err);
}

void compare_store_close(CompareStore *store)
{
    journal_close(&store->journal);
}
