// Stores the finished runs of a comparison, one a line, and takes them up again.
#include "base/hash.h"
#include "base/text.h"
#include "cli/output.h"
#include "cli/written.h"
#include "commands/compare/compare.h"
#include "write/file.h"
#include "write/json_value.h"
#include "write/measured_fields.h"
#include "write/settings_json.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A run as a line.
//
// A line is an object of one key, its kind, with the fields of that kind below.

enum { MACHINE_SIZE = 128 };

// A run, or an ensemble, with the point that it is of.
typedef struct Line {
    char scheme[SCHEME_NAME_SIZE];
    double step_s;
    LadderRun run;
    char machine[MACHINE_SIZE];
    Ensemble ensemble;
} Line;

// Which kinds of line a field stands in.
enum {
    ERROR = FIELD_OWN,
    TIMING = FIELD_OWN << 1,
    ENSEMBLE = FIELD_OWN << 2,
    RUN = ERROR | TIMING
};

#define TRUTH(member)      .offset = offsetof(LadderTruth, member)
#define LINE(member)       .offset = offsetof(Line, member)
#define TEXT(type, member) .size = sizeof(((type *)NULL)->member)

// clang-format off
static const Field TRUTH_FIELDS[] = {
    {"backend", FIELD_TEXT, FIELD_STORE, TRUTH(backend), TEXT(LadderTruth, backend)},
    {"uncertainty", FIELD_NUMBER, FIELD_STORE, TRUTH(uncertainty)},
    {"horizon_s", FIELD_NUMBER, FIELD_STORE, TRUTH(horizon_s)},
    {"growth", FIELD_NUMBER, FIELD_STORE, TRUTH(growth)},
    {"is_limited", FIELD_FLAG, FIELD_STORE, TRUTH(is_limited)},
    {"wall_s", FIELD_NUMBER, FIELD_STORE, TRUTH(wall_s)},
    {"message", FIELD_TEXT, FIELD_STORE, TRUTH(message), TEXT(LadderTruth, message)},
    {0},
};

static const Field LINE_FIELDS[] = {
    {"scheme", FIELD_TEXT, RUN | ENSEMBLE, LINE(scheme), TEXT(Line, scheme)},
    {"step_s", FIELD_STEP, RUN | ENSEMBLE, LINE(step_s)},
    {"is_complete", FIELD_FLAG, RUN, LINE(run.is_complete)},
    {"message", FIELD_TEXT, RUN, LINE(run.message), TEXT(Line, run.message)},
    {"wall_s", FIELD_NUMBER, RUN, LINE(run.wall_s)},
    {"steps", FIELD_COUNT, ERROR, LINE(run.steps)},
    {"evaluations", FIELD_COUNT, ERROR, LINE(run.evaluations)},
    {"hash", FIELD_HASH, ERROR, LINE(run.hash)},
    {NULL, FIELD_GROUP, ERROR, LINE(run.error), .of = ERROR_FIELDS},
    {"round", FIELD_COUNT, TIMING, LINE(run.round)},
    {"machine", FIELD_TEXT, TIMING, LINE(machine), TEXT(Line, machine)},
    {"members", FIELD_COUNT, ENSEMBLE, LINE(ensemble.members)},
    {"failed", FIELD_COUNT, ENSEMBLE, LINE(ensemble.failed)},
    {"message", FIELD_TEXT, ENSEMBLE, LINE(ensemble.message), TEXT(Line, ensemble.message)},
    {0},
};
// clang-format on

json_t *ladder_json_key(const Ladder *ladder, const Scenario *scenario, const char *build)
{
    json_t *steps = json_array();
    for (size_t i = 0; i < ladder->step_count; i++) {
        json_array_append_new(steps, json_value_real(ladder->steps[i]));
    }
    json_t *key = json_pack("{s:o, s:s, s:o, s:o}", "tool", settings_json_tool(), "build", build,
                            "settings", settings_json_all(scenario), "steps_s", steps);
    if (compare_engines_are_any(ladder)) {
        json_object_set_new(key, "engines", compare_engines_key(ladder));
    }
    return key;
}

json_t *ladder_json_truth(const LadderTruth *truth)
{
    return json_pack("{s:o}", "truth", fields_json(TRUTH_FIELDS, FIELD_STORE, truth));
}

json_t *ladder_json_run(const Ladder *ladder, const LadderRun *run, const char *machine)
{
    const LadderPoint *point = &ladder->points[run->point];
    Line line = {.step_s = point->step_s, .run = *run};
    text_copy(line.scheme, sizeof line.scheme, point->name);
    text_copy(line.machine, sizeof line.machine, machine);
    return run->kind == LADDER_ERROR
               ? json_pack("{s:o}", "error", fields_json(LINE_FIELDS, ERROR | FIELD_STORE, &line))
               : json_pack("{s:o}", "timing", fields_json(LINE_FIELDS, TIMING, &line));
}

json_t *ladder_json_ensemble(const Ladder *ladder, const Linkage *linkage, size_t scheme,
                             const LadderEnsemble *ensemble)
{
    Line line = {.step_s = ensemble->step_s, .ensemble = ensemble->ensemble};
    text_copy(line.scheme, sizeof line.scheme, ladder->schemes[scheme].name);
    json_t *object = fields_json(LINE_FIELDS, ENSEMBLE, &line);
    json_object_set_new(object, "joints", ensemble_joints_json(linkage, &ensemble->ensemble));
    return json_pack("{s:o}", "ensemble", object);
}

static LadderJsonTaken compare_store_take_truth(Ladder *ladder, const json_t *object)
{
    LadderTruth truth = {.is_known = true};
    if (!fields_json_read(TRUTH_FIELDS, FIELD_STORE, object, &truth)) {
        return LADDER_JSON_DAMAGED;
    }
    if (ladder->truth.is_known) {
        return LADDER_JSON_UNUSED;
    }
    // one that could not be certified is as uncertain as can be, and JSON knows no infinity
    truth.uncertainty = isnan(truth.uncertainty) ? INFINITY : truth.uncertainty;
    ladder->truth = truth;
    return LADDER_JSON_TAKEN;
}

static LadderJsonTaken compare_store_take_run(Ladder *ladder, const json_t *object, LadderKind kind,
                                              const char *machine)
{
    Line line = {.run.kind = kind};
    const unsigned where = kind == LADDER_ERROR ? ERROR | FIELD_STORE : TIMING;
    if (!fields_json_read(LINE_FIELDS, where, object, &line)) {
        return LADDER_JSON_DAMAGED;
    }
    if (kind == LADDER_TIMING && strcmp(line.machine, machine) != 0) {
        return LADDER_JSON_OTHER_MACHINE;
    }
    line.run.point = ladder_find(ladder, line.scheme, line.step_s);
    return ladder_add(ladder, &line.run) ? LADDER_JSON_TAKEN : LADDER_JSON_UNUSED;
}

static LadderJsonTaken compare_store_take_ensemble(Ladder *ladder, const Linkage *linkage,
                                                   const json_t *object)
{
    Line line = {0};
    if (!fields_json_read(LINE_FIELDS, ENSEMBLE, object, &line) ||
        !ensemble_joints_read(linkage, json_object_get(object, "joints"), &line.ensemble)) {
        return LADDER_JSON_DAMAGED;
    }
    const size_t point = ladder_find(ladder, line.scheme, line.step_s);
    if (point == ladder->point_count || ladder->ensembles[ladder->points[point].scheme].is_known) {
        return LADDER_JSON_UNUSED;
    }
    ladder->ensembles[ladder->points[point].scheme] =
        (LadderEnsemble){true, line.step_s, line.ensemble};
    return LADDER_JSON_TAKEN;
}

LadderJsonTaken ladder_json_take(Ladder *ladder, const Linkage *linkage, const json_t *line,
                                 const char *machine)
{
    const json_t *object;
    if ((object = json_object_get(line, "truth")) != NULL) {
        return compare_store_take_truth(ladder, object);
    }
    if ((object = json_object_get(line, "error")) != NULL) {
        return compare_store_take_run(ladder, object, LADDER_ERROR, machine);
    }
    if ((object = json_object_get(line, "timing")) != NULL) {
        return compare_store_take_run(ladder, object, LADDER_TIMING, machine);
    }
    object = json_object_get(line, "ensemble");
    return object != NULL ? compare_store_take_ensemble(ladder, linkage, object)
                          : LADDER_JSON_DAMAGED;
}

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
static bool compare_store_find_path(const json_t *key, char path[FILE_PATH_SIZE], Err *err)
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

static bool compare_store_take_all(CompareStore *store, Ladder *ladder, bool is_quiet, Err *err)
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
        output_say("took %zu runs from the store %s; %zu are left\n", store->taken,
                   store->journal.path, ladder_run_total(ladder) - ladder_run_done(ladder));
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
        (options->store != NULL || compare_store_find_path(key, path, err)) &&
        file_claim("--store", FILE_JOURNAL, file, err) &&
        journal_open(&store->journal, &JOURNAL_COMPARE, file, key, options->is_fresh, err);
    json_decref(key);
    return is_open && compare_store_take_all(store, ladder, options->common.is_quiet, err);
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
