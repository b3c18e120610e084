// Reads the options of a check, and lists its cases and the files they are checked against.
//
// The baseline of cases/paper/impact-k66.yaml is DIR/impact-k66.json, and names the case by its
// path from DIR, so that both can move together.
#include "commands/check/check_list.h"
#include "base/shipped.h"
#include "base/text.h"
#include "casefile/casefile.h"
#include "cli/warnings.h"
#include "commands/check/baseline.h"
#include "commands/check/check_measure.h"
#include "run/settle.h"
#include "write/file.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// A path from a folder to a file, both absolute and without links.
static void relative_path(const char *folder, const char *file, char target[FILE_PATH_SIZE])
{
    size_t shared = 0; // length of what both have, up to and without a slash
    size_t i = 0;
    for (; folder[i] != '\0' && folder[i] == file[i]; i++) {
        shared = folder[i] == '/' ? i : shared;
    }
    if (folder[i] == '\0' && file[i] == '/') {
        shared = i;
    }
    Text text;
    text_init(&text);
    for (const char *c = folder + shared; *c != '\0'; c++) {
        text_append(&text, "%s", *c == '/' && c[1] != '\0' ? "../" : "");
    }
    text_append(&text, "%s", file + shared + (file[shared] == '/' ? 1 : 0));
    text_copy(target, FILE_PATH_SIZE, text.data);
    text_finish(&text);
}

// The path without links and dots; false where nothing is there.
static bool check_list_resolve(const char *path, char target[FILE_PATH_SIZE])
{
    char *whole = realpath(path, NULL);
    text_copy(target, FILE_PATH_SIZE, whole != NULL ? whole : path);
    free(whole);
    return whole != NULL;
}

static void show_path(const char *whole, char target[FILE_PATH_SIZE])
{
    char here[FILE_PATH_SIZE];
    if (getcwd(here, sizeof here) == NULL) {
        text_copy(target, FILE_PATH_SIZE, whole);
        return;
    }
    relative_path(here, whole, target);
    // a path with ../ is harder to read than the whole one
    if (strncmp(target, "../", 3) == 0) {
        text_copy(target, FILE_PATH_SIZE, whole);
    }
}

static void read_baseline(CheckItem *item, const CheckOptions *options)
{
    Err *err = options->is_blessing ? &item->baseline_err : &item->err;
    item->is_there = access(item->baseline_path, F_OK) == 0;
    if (!item->is_there && item->is_shipped && !options->is_shipped) {
        err_set(err, ERR_FILE,
                "there is no baseline %s of your own for %s, which came with the program; "
                "--shipped compares it with the program's",
                item->baseline_path, item->path);
    }
    baseline_json_read(item->baseline_path, &item->baseline, err);
}

// Whether a case is judged by its own limits alone: because that was asked for, or because it has
// no baseline.
static bool is_by_limits(CheckItem *item, const CheckOptions *options)
{
    const size_t limits = item->scenario->expectation_count + item->scenario->outcome_count;
    if (options->is_expect_only && limits == 0) {
        err_set(&item->err, ERR_CASE, "%s sets no limits: it has no expect:", item->path);
    }
    const bool is_there = access(item->baseline_path, F_OK) == 0;
    return options->is_expect_only || (!options->is_blessing && !is_there && limits > 0);
}

// A case file that expects to be refused, and was, is no error.
static void note_refusal(CheckItem *item, const CheckOptions *options)
{
    item->is_refused = !options->is_blessing && !item->has_baseline && item->err.kind == ERR_CASE &&
                       casefile_expects_refusal(item->path, item->title, &item->refusal);
    if (item->is_refused) {
        item->refused = item->err;
        item->err = (Err){ERR_NONE, ""};
    }
}

static bool read_case(CheckItem *item, const CheckOptions *options)
{
    item->scenario = calloc(1, sizeof *item->scenario);
    assert(item->scenario != NULL);
    if (strcmp(item->path, "-") == 0) {
        err_set(&item->err, ERR_USAGE,
                "check takes case files and not standard input: a baseline belongs to a file");
    }
    if (item->err.kind != ERR_NONE ||
        !casefile_load(item->path, options->common.overrides, options->common.override_count,
                       item->scenario, &item->err) ||
        !common_options_take_drivers(&options->common, item->scenario, &item->err)) {
        scenario_destroy(item->scenario);
        item->scenario = NULL;
        note_refusal(item, options);
        return false;
    }
    warnings_say(item->scenario, &options->common);
    baseline_begin(&item->now, item->scenario);
    item->now.plan = item->baseline.plan;
    return true;
}

// Whether the case limits a number of its settled motion, and whether its growth.
typedef struct SettledLimits {
    bool are_any;
    bool are_of_growth;
} SettledLimits;

static SettledLimits settled_limits(const Scenario *scenario)
{
    SettledLimits limits = {false, false};
    for (size_t i = 0; i < scenario->expectation_count; i++) {
        const Expectation *expectation = &scenario->expectations[i];
        limits.are_any = limits.are_any || expect_value_is_settled(expectation);
        limits.are_of_growth = limits.are_of_growth || expectation->number == NUMBER_SETTLED_GROWTH;
    }
    return limits;
}

// Starts the case where the numbers of its baseline did, if there are such; its settled motion, of
// which it limits numbers, is found anew.
static bool start_as_baseline(CheckItem *item, bool limits_motion)
{
    Scenario *scenario = item->scenario;
    Scenario as_written = limits_motion ? scenario_copy(scenario) : (Scenario){.point_count = 0};
    const bool is_started = baseline_start_scenario(&item->baseline, &item->now, scenario);
    if (is_started && limits_motion) {
        const SettledStart own = scenario->settled;
        settle_scenario(&as_written, (RunWatch){.progress = NULL});
        scenario->settled = as_written.settled;
        scenario->settled.revolutions = own.revolutions;
        as_written.settled = own;
    }
    scenario_free(&as_written);
    return is_started;
}

// Finds where the case starts, and what it limits of its settled motion.
static void settle_item(CheckItem *item, const CheckOptions *options)
{
    const SettledLimits limits = settled_limits(item->scenario);
    if (options->is_blessing || !start_as_baseline(item, limits.are_any)) {
        settle_scenario(item->scenario, (RunWatch){.progress = NULL});
    }
    if (limits.are_of_growth) {
        settle_growth(item->scenario, (RunWatch){.progress = NULL});
    }
}

// A case that was named: its baseline must be its own.
static void add_named(CheckItem *item, const CheckOptions *options)
{
    const char *path = item->path;
    char whole[FILE_PATH_SIZE];
    char folder[FILE_PATH_SIZE];
    char name[FILE_PATH_SIZE];
    if (!read_case(item, options)) {
        return;
    }
    check_list_resolve(path, whole);
    check_list_resolve(options->folder, folder);
    relative_path(folder, whole, item->relative);
    file_stem(scenario_path(item->scenario), name, sizeof name);
    const int length = snprintf(item->baseline_path, sizeof item->baseline_path, "%s/%s.json",
                                options->folder, name);
    if (length < 0 || length >= FILE_PATH_SIZE) {
        err_set(&item->err, ERR_FILE, "the path of the baseline of %s is too long", path);
        return;
    }
    if (is_by_limits(item, options)) {
        settle_item(item, options);
        return;
    }
    item->has_baseline = true;
    read_baseline(item, options);
    settle_item(item, options);
    const char *other = item->baseline.case_path;
    if (item->baseline.count > 0 && strcmp(other, item->relative) != 0) {
        err_set(&item->err, ERR_FILE,
                "the baseline %s is of another case: of %s, seen from there, and "
                "not of %s",
                item->baseline_path, other, item->relative);
    }
    item->now.plan = item->baseline.plan;
}

// A baseline that was found: it names its case.
static void add_found(CheckItem *item, const char *file, const CheckOptions *options)
{
    item->has_baseline = true;
    snprintf(item->baseline_path, sizeof item->baseline_path, "%s/%s", options->folder, file);
    text_copy(item->path, sizeof item->path, item->baseline_path);
    if (!baseline_json_read(item->baseline_path, &item->baseline, &item->err)) {
        return;
    }
    char joined[2 * FILE_PATH_SIZE];
    char whole[FILE_PATH_SIZE];
    const char *case_path = item->baseline.case_path;
    snprintf(joined, sizeof joined, "%s%s%s", case_path[0] == '/' ? "" : options->folder,
             case_path[0] == '/' ? "" : "/", case_path);
    text_copy(item->relative, sizeof item->relative, case_path);
    if (!check_list_resolve(joined, whole)) {
        err_set(&item->err, ERR_FILE, "the case of the baseline %s is not there: %s",
                item->baseline_path, joined);
        return;
    }
    show_path(whole, item->path);
    if (read_case(item, options)) {
        settle_item(item, options);
    }
}

static int is_baseline(const struct dirent *entry)
{
    const size_t length = strlen(entry->d_name);
    return length > 5 && strcmp(entry->d_name + length - 5, ".json") == 0;
}

// Says where baselines were looked for. `what` says what was found there.
static bool refuse_folder(const CheckOptions *options, const char *what, Err *err)
{
    char here[FILE_PATH_SIZE] = "";
    const bool is_relative = options->folder[0] != '/' && getcwd(here, sizeof here) != NULL;
    return err_set(err, ERR_FILE,
                   "no baselines to compare with: %s%s%s %s; --baselines names another folder, "
                   "--bless CASE makes a baseline, --shipped checks the program's own cases",
                   is_relative ? here : "", is_relative ? "/" : "", options->folder, what);
}

static bool find_all(const CheckOptions *options, CheckItem **items, size_t *count, Err *err)
{
    struct dirent **entries;
    const int found = scandir(options->folder, &entries, is_baseline, alphasort);
    if (found < 0) {
        return refuse_folder(options, errno == ENOENT ? "is not there" : strerror(errno), err);
    }
    *items = calloc((size_t)found + 1, sizeof **items);
    assert(*items != NULL);
    *count = (size_t)found;
    for (int i = 0; i < found; i++) {
        add_found(&(*items)[i], entries[i]->d_name, options);
        free(entries[i]);
    }
    free(entries);
    return found > 0 || refuse_folder(options, "has no file that ends in .json", err);
}

static int is_case(const struct dirent *entry)
{
    const size_t length = strlen(entry->d_name);
    return length > 5 && strcmp(entry->d_name + length - 5, ".yaml") == 0;
}

// What is meant by the path of a case: with --shipped the program's own, whatever stands here.
static bool find_case(const CheckOptions *options, const char *given, char path[FILE_PATH_SIZE])
{
    return options->is_shipped ? shipped_find_own(given, path, FILE_PATH_SIZE)
                               : shipped_find(given, path, FILE_PATH_SIZE);
}

// Adds one case, in the item that will be its own.
static void add_path(const char *path, bool is_shipped, CheckItem **items, size_t *count)
{
    *items = realloc(*items, (*count + 1) * sizeof **items);
    assert(*items != NULL);
    CheckItem *item = &(*items)[(*count)++];
    *item = (CheckItem){.is_shipped = is_shipped};
    text_copy(item->path, sizeof item->path, path);
}

// Adds the cases of a folder; false where it is none.
static bool add_folder(const char *path, bool is_shipped, CheckItem **items, size_t *count,
                       Err *err)
{
    struct dirent **entries;
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISDIR(status.st_mode)) {
        return false;
    }
    const int found = scandir(path, &entries, is_case, alphasort);
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/') {
        length--;
    }
    for (int i = 0; i < found; i++) {
        char joined[2 * FILE_PATH_SIZE];
        snprintf(joined, sizeof joined, "%.*s/%s", (int)length, path, entries[i]->d_name);
        add_path(joined, is_shipped, items, count);
        free(entries[i]);
    }
    if (found >= 0) {
        free(entries);
    }
    if (found <= 0) {
        err_set(err, ERR_FILE, "there is no case in the folder %s: no file ends in .yaml", path);
    }
    return true;
}

static bool name_all(const CheckOptions *options, CheckItem **items, size_t *count, Err *err)
{
    for (size_t i = 0; i < options->path_count; i++) {
        char path[FILE_PATH_SIZE];
        const bool is_shipped = find_case(options, options->paths[i], path);
        if (!add_folder(path, is_shipped, items, count, err)) {
            add_path(path, is_shipped, items, count);
        }
        if (err->kind != ERR_NONE) {
            return false;
        }
    }
    for (size_t i = 0; i < *count; i++) {
        add_named(&(*items)[i], options);
        for (size_t k = 0; k < i && (*items)[i].baseline_path[0] != '\0'; k++) {
            if (strcmp((*items)[i].baseline_path, (*items)[k].baseline_path) == 0) {
                return err_set(err, ERR_USAGE, "%s and %s would both have the baseline %s",
                               (*items)[k].path, (*items)[i].path, (*items)[i].baseline_path);
            }
        }
    }
    return true;
}

// A new baseline may replace an old one alone.
static bool claim_baselines(const CheckItem *items, size_t count, Err *err)
{
    for (size_t i = 0; i < count; i++) {
        if (items[i].err.kind == ERR_NONE && items[i].has_baseline &&
            !file_claim("--bless", FILE_BASELINE, items[i].baseline_path, err)) {
            return false;
        }
    }
    return true;
}

bool check_list_make(const CheckOptions *options, CheckItem **items, size_t *count, Err *err)
{
    *items = NULL;
    *count = 0;
    bool is_made = options->path_count > 0 ? name_all(options, items, count, err)
                                           : find_all(options, items, count, err);
    is_made = is_made && (!options->is_blessing || claim_baselines(*items, *count, err));
    for (size_t i = 0; is_made && i < *count; i++) {
        // a usage error concerns all cases
        if ((*items)[i].err.kind == ERR_USAGE) {
            is_made = err_set_lines(err, ERR_USAGE, (*items)[i].err.text);
        }
    }
    if (!is_made) {
        check_list_destroy(*items, *count);
        *items = NULL;
        *count = 0;
    }
    return is_made;
}

void check_list_destroy(CheckItem *items, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        scenario_destroy(items[i].scenario);
        baseline_finish(&items[i].baseline);
        baseline_finish(&items[i].now);
    }
    free(items);
}

// The options.

static const char DEFAULT_FOLDER[] = "results/baseline";
static const double DEFAULT_TIME_LIMIT = 600.0; // s: some hundred times the longest usual start
enum { SHAKE_MAX = 1000000 };

#define AT(field) .offset = offsetof(CheckOptions, field)

// "1%" or "0.01".
static bool read_share(const char *text, void *target, Err *err)
{
    char *end;
    const double number = strtod(text, &end);
    const double unit = strcmp(end, "%") == 0 || strcmp(end, " %") == 0 ? 0.01 : 1.0;
    const bool is_whole = end != text && (*end == '\0' || unit < 1.0);
    ((CheckOptions *)target)->relative = unit * number;
    return (is_whole && number > 0.0 && unit * number <= 1.0) ||
           err_set(err, ERR_USAGE,
                   "--rel is %s; allowed: a share such as 1%% or 0.01, above 0 to 1", text);
}

static const OptionRow CHECK_OPTIONS[] = {
    {"baselines", "DIR", "Where the baselines are (default: results/baseline)", 1, OPTION_TEXT,
     AT(folder)},
    {"shipped", NULL, "Check the cases that came with the program against its own baselines", 1,
     OPTION_FLAG, AT(is_shipped)},
    {"bless", NULL, "Write new baselines from what is measured now, and list what moved", 1,
     OPTION_FLAG, AT(is_blessing)},
    {"rel", "SHARE",
     "Let every number move by this share of itself at least, such as 1%: bands of your own", 1,
     OPTION_READ, .read = read_share},
    {"quick", NULL, "One run per case: no ensembles, no orders", 1, OPTION_FLAG, AT(is_quick)},
    {"expect-only", NULL, "Judge cases by their own limits (expect:), not by baselines", 1,
     OPTION_FLAG, AT(is_expect_only)},
    COMMON_SET(1),
    COMMON_DRIVERS(1),
    {"shake", "SEED",
     "Change every input by rounding first, as another machine might: a way to test the bands", 1,
     OPTION_COUNT, AT(shake), .low = 1, .high = SHAKE_MAX},
    COMMON_JOBS(2, "Starts at a time (default: one per core)"),
    COMMON_TIME_LIMIT(2, "A start that takes longer has failed (default: 600 s)"),
    {"all", NULL, "Every number in the tables, not only the worst", 3, OPTION_FLAG, AT(is_all)},
    COMMON_JSON(3),
    COMMON_WIDE(3),
    {"junit", "FILE", "Write JUnit XML, one test per number", 3, OPTION_TEXT, AT(junit)},
    {"markdown", "FILE", "Write a comment for a change; '-' prints it instead of tables", 3,
     OPTION_TEXT, AT(markdown)},
    COMMON_QUIET(3),
};

// Which folder the baselines are in: nothing but a word of the user leads to the program's own, so
// that a check in the wrong folder does not pass for what was meant.
static bool choose_folder(CheckOptions *options, Err *err)
{
    if (!options->is_shipped) {
        options->folder = options->folder != NULL ? options->folder : DEFAULT_FOLDER;
        return true;
    }
    if (options->is_blessing || options->is_expect_only || options->folder != NULL) {
        return err_set(err, ERR_USAGE,
                       "--shipped compares with the program's own baselines: it does not go with "
                       "%s",
                       options->is_blessing      ? "--bless"
                       : options->is_expect_only ? "--expect-only"
                                                 : "--baselines");
    }
    options->folder = options->shipped;
    return shipped_find_own(DEFAULT_FOLDER, options->shipped, sizeof options->shipped) ||
           err_set(err, ERR_FILE,
                   "the program's own baselines are not there: it was copied without its "
                   "share/jointplay");
}

static bool check_together(void *target, Err *err)
{
    CheckOptions *options = target;
    if (!choose_folder(options, err)) {
        return false;
    }
    if (options->is_blessing && (options->is_quick || options->shake > 0)) {
        return err_set(err, ERR_USAGE,
                       "--bless measures in full and unshaken: it goes with "
                       "neither --quick nor --shake");
    }
    if (options->is_expect_only && (options->is_blessing || options->path_count == 0)) {
        return err_set(err, ERR_USAGE,
                       options->is_blessing ? "--expect-only ignores baselines, and --bless "
                                              "makes one: one of them, not both"
                                            : "--expect-only takes the cases to check");
    }
    if (options->relative > 0.0 && (options->is_blessing || options->is_expect_only)) {
        return err_set(err, ERR_USAGE,
                       "--rel widens the bands of a comparison: it goes with "
                       "neither --bless nor --expect-only");
    }
    if (options->is_blessing && options->common.override_count > 0) {
        return err_set(err, ERR_USAGE,
                       "--bless makes the baseline of a case as its file has it: it does not go "
                       "with --set");
    }
    const bool has_stream = (options->junit != NULL && file_is_stream(options->junit)) ||
                            (options->markdown != NULL && file_is_stream(options->markdown));
    if (options->common.is_json && has_stream) {
        return err_set(err, ERR_USAGE,
                       "--json prints its object alone: give --junit and --markdown files");
    }
    return true;
}

const Arguments CHECK_ARGUMENTS = {
    .program = "jointplay check",
    .usage = "[CASE...]",
    .doc = "Compares the numbers of cases with their baselines and with the limits that the cases "
           "set themselves (expect:). Numbers outside their band are named, and the exit status is "
           "1. Without a case, all cases that have a baseline are checked."
           "\vA baseline that is missing, damaged or of another case is an error; a case that "
           "sets limits needs none.",
    .argument = {.type = OPTION_LIST,
                 AT(paths),
                 .count_offset = offsetof(CheckOptions, path_count),
                 .high = CHECK_PATH_MAX,
                 .what = "cases"},
    OPTION_ROWS(CHECK_OPTIONS),
    .check = check_together,
};
#undef AT

void check_options_init(CheckOptions *options)
{
    *options = (CheckOptions){.common.jobs = common_options_count_jobs(),
                              .common.time_limit_s = DEFAULT_TIME_LIMIT};
}
