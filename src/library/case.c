// Opens cases, sets their keys, and tells what they have.
//
// A case is its text and what was set since, as on a command line; what it says is read anew
// whenever that changes, and takes the place of what it said once it is whole.
#include "library/library.h"

#include "base/room.h"
#include "base/zeroed.h"
#include "casefile/input.h"
#include "casefile/schema.h"
#include "commands/run/case_run.h"
#include "version.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char NO_CASE[] = "there is no case: NULL was given for it";
static const char IN_USE[] = "the case is in use by a call that has not returned";
static const char NO_KEY[] = "there is no key: NULL was given for it";
static const char NO_TARGET[] = "there is nowhere to write to: NULL was given for it";

// KEY=VALUE takes no more room than that on a command line.
enum { NUMBER_SIZE = 96 };

const char *jp_case_version(void)
{
    return JOINTPLAY_VERSION;
}

bool case_take(JpCase *of)
{
    if (atomic_flag_test_and_set(&of->is_busy)) {
        return false;
    }
    of->reader.is_touched = of->run_reader.is_touched = false;
    return true;
}

// What a call that broke off took is gone: a reader that it touched may point there.
static void mend(CaseReader *reader)
{
    if (reader->is_touched) {
        reader->repeat = NULL;
    }
}

void case_give_back(JpCase *of, JpCaseStatus status)
{
    if (status == JP_CASE_ERROR_MEMORY || status == JP_CASE_ERROR_INTERNAL) {
        mend(&of->reader);
        mend(&of->run_reader);
    }
    atomic_flag_clear(&of->is_busy);
    if (atomic_exchange(&of->is_freed, false)) {
        case_destroy(of);
    }
}

static void free_settings(JpSetting *settings, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        free((char *)settings[i].key);
        free((char *)settings[i].text);
        free((char *)settings[i].unit);
        free((double *)settings[i].numbers);
    }
    free(settings);
}

// What was found out of a case as it was.
static void forget(JpCase *of)
{
    free_settings(of->settings, of->setting_count);
    free_settings(of->asked, of->asked_count);
    free(of->notes);
    of->settings = of->asked = NULL;
    of->setting_count = of->asked_count = of->asked_room = 0;
    of->notes = NULL;
}

static void free_list(char **list, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        free(list[i]);
    }
    free(list);
}

void case_destroy(JpCase *of)
{
    if (of == NULL) {
        return;
    }
    forget(of);
    scenario_destroy(of->scenario);
    casefile_repeat_close(of->reader.repeat);
    casefile_repeat_close(of->run_reader.repeat);
    free_list(of->set, of->set_count);
    free(of->text);
    free(of->name);
    free(of);
}

void jp_case_free(JpCase *of)
{
    if (of == NULL) {
        return;
    }
    if (!case_take(of)) {
        // who uses it frees it
        atomic_store(&of->is_freed, true);
        return;
    }
    case_destroy(of);
}

// Reads a case with settings, and with others next time.
static bool read_with(const JpCase *of, CaseReader *reader, const char *const *set, size_t count,
                      Scenario *scenario, Err *err)
{
    reader->is_touched = true;
    if (reader->repeat == NULL) {
        reader->repeat = casefile_repeat_open(of->name, of->text, of->size, true);
    }
    return casefile_repeat(reader->repeat, set, count, scenario, err);
}

bool case_scenario(JpCase *of, const char *const *further, size_t count, Scenario *scenario,
                   Err *err)
{
    const char **set = zeroed(of->set_count + count, sizeof *set);
    for (size_t i = 0; i < of->set_count; i++) {
        set[i] = of->set[i];
    }
    for (size_t i = 0; i < count; i++) {
        set[of->set_count + i] = further[i];
    }
    const bool is_read = read_with(of, &of->run_reader, set, of->set_count + count, scenario, err);
    free(set);
    return is_read;
}

// A case of a text, which it takes, and of settings, which it takes as well.
static bool make_case(const char *name, char *text, size_t size, char **set, size_t set_count,
                      JpCase **made, Err *err)
{
    JpCase *of = zeroed(1, sizeof *of);
    atomic_flag_clear(&of->is_busy);
    of->name = strdup(name);
    of->text = text;
    of->size = size;
    of->set = set;
    of->set_count = set_count;
    of->scenario = zeroed(1, sizeof *of->scenario);
    const bool is_read =
        read_with(of, &of->reader, (const char *const *)set, set_count, of->scenario, err);
    if (is_read) {
        *made = of;
    } else {
        case_destroy(of);
    }
    return is_read;
}

// Opening.

typedef struct Opening {
    const char *path; // or a name, of a text
    const char *text; // NULL: it is read
    size_t size;
    const JpCase *like; // NULL: there is none
    JpCase *made;
} Opening;

static bool work_open(void *context, Err *err)
{
    Opening *opening = context;
    char *text = NULL;
    size_t size = 0;
    return input_read("case", opening->path, &text, &size, err) &&
           make_case(opening->path, text, size, NULL, 0, &opening->made, err);
}

static bool work_parse(void *context, Err *err)
{
    Opening *opening = context;
    char *text = zeroed(opening->size + 1, 1);
    memcpy(text, opening->text, opening->size);
    return make_case(opening->path, text, opening->size, NULL, 0, &opening->made, err);
}

static bool work_copy(void *context, Err *err)
{
    Opening *opening = context;
    const JpCase *like = opening->like;
    char *text = zeroed(like->size + 1, 1);
    char **set = zeroed(like->set_count + 1, sizeof *set);
    memcpy(text, like->text, like->size);
    for (size_t i = 0; i < like->set_count; i++) {
        set[i] = strdup(like->set[i]);
    }
    return make_case(like->name, text, like->size, set, like->set_count, &opening->made, err);
}

static JpCase *open_by(LibraryWork *work, Opening *opening, JpCaseError *error)
{
    LibraryCall call = {.work = work, .context = opening, .name = opening->path};
    return library_call(&call, error) == JP_CASE_OK ? opening->made : NULL;
}

JpCase *jp_case_open(const char *path, JpCaseError *error)
{
    if (path == NULL) {
        library_refuse(error, "there is no path: NULL was given for it");
        return NULL;
    }
    Opening opening = {.path = path};
    return open_by(work_open, &opening, error);
}

JpCase *jp_case_parse(const char *text, size_t size, const char *name, JpCaseError *error)
{
    if (text == NULL) {
        library_refuse(error, "there is no text: NULL was given for it");
        return NULL;
    }
    Opening opening = {.path = name != NULL ? name : "a text", .text = text, .size = size};
    return open_by(work_parse, &opening, error);
}

JpCase *jp_case_copy(const JpCase *of, JpCaseError *error)
{
    // what is only read is marked as in use all the same
    JpCase *like = (JpCase *)of;
    if (of == NULL || !case_take(like)) {
        library_refuse(error, of == NULL ? NO_CASE : IN_USE);
        return NULL;
    }
    Opening opening = {.path = of->name, .like = of};
    JpCase *made = open_by(work_copy, &opening, error);
    case_give_back(like, JP_CASE_OK);
    return made;
}

// Settings.

typedef struct Setting {
    JpCase *of;
    const char *const *keys;
    const char *const *values; // NULL where there is one: what was set is taken back
    size_t count;
} Setting;

// Whether KEY=VALUE is of a key.
static bool is_of_key(const char *set, const char *key)
{
    const size_t length = strlen(key);
    return strncmp(set, key, length) == 0 && set[length] == '=';
}

// The settings as they are to be: those of other keys, and behind them the new ones.
static char **list_settings(const Setting *setting, size_t *count)
{
    const JpCase *of = setting->of;
    char **set = zeroed(of->set_count + setting->count + 1, sizeof *set);
    *count = 0;
    for (size_t i = 0; i < of->set_count; i++) {
        bool is_kept = true;
        for (size_t k = 0; k < setting->count; k++) {
            is_kept = is_kept && !is_of_key(of->set[i], setting->keys[k]);
        }
        if (is_kept) {
            set[(*count)++] = strdup(of->set[i]);
        }
    }
    for (size_t k = 0; k < setting->count; k++) {
        if (setting->values[k] != NULL) {
            const size_t size = strlen(setting->keys[k]) + strlen(setting->values[k]) + sizeof "=";
            char *text = zeroed(size, 1);
            snprintf(text, size, "%s=%s", setting->keys[k], setting->values[k]);
            set[(*count)++] = text;
        }
    }
    return set;
}

static bool check_keys(const Setting *setting, Err *err)
{
    for (size_t i = 0; i < setting->count; i++) {
        const char *key = setting->keys[i];
        if (key == NULL || key[0] == '\0' || strchr(key, '=') != NULL) {
            return err_set(err, ERR_USAGE, "%s is no key", key == NULL ? "NULL" : key);
        }
    }
    return true;
}

static bool work_set(void *context, Err *err)
{
    const Setting *setting = context;
    JpCase *of = setting->of;
    if (!check_keys(setting, err)) {
        return false;
    }
    size_t count;
    char **set = list_settings(setting, &count);
    Scenario *scenario = zeroed(1, sizeof *scenario);
    if (!read_with(of, &of->reader, (const char *const *)set, count, scenario, err)) {
        scenario_destroy(scenario);
        free_list(set, count);
        return false;
    }
    // from here on nothing can fail
    forget(of);
    scenario_destroy(of->scenario);
    free_list(of->set, of->set_count);
    of->scenario = scenario;
    of->set = set;
    of->set_count = count;
    return true;
}

// Makes a call with a case that no other call may have.
static JpCaseStatus call_with(JpCase *of, LibraryWork *work, void *context, JpCaseError *error)
{
    if (of == NULL || !case_take(of)) {
        return library_refuse(error, of == NULL ? NO_CASE : IN_USE);
    }
    LibraryCall call = {.work = work, .context = context, .name = of->name};
    const JpCaseStatus status = library_call(&call, error);
    case_give_back(of, status);
    return status;
}

JpCaseStatus jp_case_set_all(JpCase *of, const char *const *keys, const char *const *values,
                             size_t count, JpCaseError *error)
{
    if (count > 0 && (keys == NULL || values == NULL)) {
        return library_refuse(error, NO_KEY);
    }
    Setting setting = {of, keys, values, count};
    return call_with(of, work_set, &setting, error);
}

JpCaseStatus jp_case_set(JpCase *of, const char *key, const char *value, JpCaseError *error)
{
    return key == NULL ? library_refuse(error, NO_KEY)
                       : jp_case_set_all(of, &key, &value, 1, error);
}

// What there is of them.

static void append_number(Text *text, double number)
{
    if (isfinite(number)) {
        text_append_number(text, number);
    } else {
        text_append(text, "%g", number);
    }
}

// A number with its unit, a list of them, or one with its tolerance.
static void append_value(const CasefileSetting *setting, Text *text)
{
    const char *blank = setting->unit[0] != '\0' ? " " : "";
    const bool is_list = setting->number_count > 1 && setting->kind != CASEFILE_TOLERATED;
    if (setting->kind == CASEFILE_WORDS) {
        text_append(text, "[%s]", setting->text);
    } else if (setting->number_count == 0 || setting->kind == CASEFILE_WORD) {
        text_append(text, "%s", setting->text);
    }
    if (setting->number_count == 0 || setting->kind == CASEFILE_WORD) {
        return;
    }
    text_append(text, "%s", is_list ? "[" : "");
    for (size_t i = 0; i < (is_list ? setting->number_count : 1); i++) {
        text_append(text, "%s", i > 0 ? ", " : "");
        append_number(text, setting->numbers[i]);
        text_append(text, "%s%s", blank, setting->unit);
    }
    text_append(text, "%s", is_list ? "]" : "");
    if (setting->kind == CASEFILE_TOLERATED) {
        text_append(text, " +");
        append_number(text, setting->numbers[2]);
        text_append(text, "/");
        append_number(text, setting->numbers[1]);
        text_append(text, "%s%s", blank, setting->unit);
    }
}

// What a key means; of a part of a sinusoid what the whole does.
static const char *doc_of(const char *key)
{
    const SchemaRow *row = schema_of_key(key);
    if (row == NULL && strchr(key, '.') != NULL) {
        char *whole = strndup(key, (size_t)(strrchr(key, '.') - key));
        row = schema_of_key(whole);
        free(whole);
    }
    return row != NULL ? row->doc : "";
}

static JpSetting describe(const CasefileSetting *setting, const char *doc)
{
    Text text;
    text_init(&text);
    append_value(setting, &text);
    const bool is_word = setting->kind == CASEFILE_WORD;
    return (JpSetting){
        .key = strdup(setting->key),
        .text = text.data,
        .unit = strdup(setting->unit),
        .count = is_word ? 0 : setting->number_count,
        .numbers = zeroed_copy(setting->numbers, setting->number_count, sizeof(double)),
        .is_used = setting->applies,
        .doc = doc,
    };
}

// In a call of its own, which takes no memory behind its end: where it breaks off, there is no
// list.
static bool work_list(void *context, Err *err)
{
    (void)err;
    JpCase *of = context;
    if (of->settings != NULL) {
        return true;
    }
    const size_t count = casefile_setting_count(of->scenario);
    JpSetting *settings = zeroed(count + 1, sizeof *settings);
    CasefileSetting *setting = zeroed(1, sizeof *setting);
    CasefileWalk walk = casefile_walk(of->scenario);
    size_t number = 0;
    while (number < count && casefile_next(&walk, setting)) {
        settings[number++] = describe(setting, SCHEMA_ROWS[walk.row].doc);
    }
    free(setting);
    of->settings = settings;
    of->setting_count = number;
    return true;
}

size_t jp_case_setting_count(JpCase *of)
{
    return call_with(of, work_list, of, NULL) == JP_CASE_OK ? of->setting_count : 0;
}

JpCaseStatus jp_case_setting_at(JpCase *of, size_t index, JpSetting *setting, JpCaseError *error)
{
    if (setting == NULL) {
        return library_refuse(error, NO_TARGET);
    }
    const JpCaseStatus status = call_with(of, work_list, of, error);
    if (status != JP_CASE_OK) {
        return status;
    }
    if (index >= of->setting_count) {
        return library_refuse(error, "there are not so many settings");
    }
    *setting = of->settings[index];
    return JP_CASE_OK;
}

typedef struct Sought {
    JpCase *of;
    const char *key;
    JpSetting found;
} Sought;

static bool fail_unknown_key(const JpCase *of, const char *key, Err *err)
{
    static const char EXPECT[] = "expect";
    const size_t length = sizeof EXPECT - 1;
    if (strncmp(key, EXPECT, length) == 0 && (key[length] == '.' || key[length] == '\0')) {
        return err_set(err, ERR_USAGE,
                       "%s is no setting: what is expected is judged by the command check, and no "
                       "run depends on it",
                       key);
    }
    const size_t room = casefile_setting_count(of->scenario);
    char **keys = zeroed(room, sizeof *keys);
    CasefileSetting *setting = zeroed(1, sizeof *setting);
    CasefileWalk walk = casefile_walk(of->scenario);
    size_t count = 0;
    while (count < room && casefile_next(&walk, setting)) {
        keys[count++] = strdup(setting->key);
    }
    const char *nearest = text_nearest(key, (const char **)keys, count);
    err_set(err, ERR_USAGE, "the case has no key '%s'%s%s%s", key,
            nearest != NULL ? "; did you mean '" : "", nearest != NULL ? nearest : "",
            nearest != NULL ? "'?" : "");
    free(setting);
    free_list(keys, count);
    return false;
}

// Among those that were found before.
static const JpSetting *find_known(const JpCase *of, const char *key)
{
    const JpSetting *lists[] = {of->settings, of->asked};
    const size_t counts[] = {of->setting_count, of->asked_count};
    for (size_t list = 0; list < 2; list++) {
        for (size_t i = 0; i < counts[list]; i++) {
            if (strcmp(lists[list][i].key, key) == 0) {
                return &lists[list][i];
            }
        }
    }
    return NULL;
}

// A signal or a part of a sinusoid, which is no setting of the scenario; its text is for
// text_finish.
static bool case_signal(const JpCase *of, const char *key, CasefileSignal *signal)
{
    return casefile_signal(of->text, of->size, (const char *const *)of->set, of->set_count, key,
                           signal);
}

static bool find_signal(const JpCase *of, const char *key, JpSetting *found)
{
    CasefileSignal signal;
    if (!case_signal(of, key, &signal)) {
        return false;
    }
    *found = (JpSetting){
        .key = strdup(key),
        .text = signal.text.data,
        .unit = strdup(signal.unit),
        .count = signal.number_count,
        .numbers = zeroed_copy(&signal.number, signal.number_count, sizeof(double)),
        .is_used = true,
        .doc = doc_of(key),
    };
    return true;
}

static bool work_find(void *context, Err *err)
{
    Sought *sought = context;
    JpCase *of = sought->of;
    const JpSetting *known = find_known(of, sought->key);
    if (known != NULL) {
        sought->found = *known;
        return true;
    }
    CasefileSetting *setting = zeroed(1, sizeof *setting);
    const bool is_setting = casefile_find(of->scenario, sought->key, setting);
    if (is_setting) {
        sought->found = describe(setting, doc_of(sought->key));
    }
    free(setting);
    if (!is_setting && !find_signal(of, sought->key, &sought->found)) {
        return fail_unknown_key(of, sought->key, err);
    }
    // nothing takes memory behind this
    of->asked = room_grow(of->asked, &of->asked_room, of->asked_count + 1, sizeof *of->asked);
    of->asked[of->asked_count++] = sought->found;
    return true;
}

JpCaseStatus jp_case_setting(JpCase *of, const char *key, JpSetting *setting, JpCaseError *error)
{
    if (key == NULL || setting == NULL) {
        return library_refuse(error, key == NULL ? NO_KEY : NO_TARGET);
    }
    Sought sought = {.of = of, .key = key};
    const JpCaseStatus status = call_with(of, work_find, &sought, error);
    if (status == JP_CASE_OK) {
        *setting = sought.found;
    }
    return status;
}

// A number in SI.

static bool takes_number(const SchemaRow *row)
{
    switch (row->type) {
    case SCHEMA_QUANTITY:
    case SCHEMA_DIAMETER:
    case SCHEMA_TOLERATED:
    case SCHEMA_INTEGER:
    case SCHEMA_STIFFNESS:
    case SCHEMA_SPAN:
    case SCHEMA_GRAVITY:
    case SCHEMA_START:
    case SCHEMA_COORDINATE:
    case SCHEMA_DAMPER:
    case SCHEMA_HEADING:
    case SCHEMA_RADIAL_CLEARANCE:
    case SCHEMA_ALONG:
    case SCHEMA_PAIR:
    case SCHEMA_TORQUE:
    case SCHEMA_SPEED:
    case SCHEMA_LOAD:
    case SCHEMA_LOAD_PERIOD:
        return true;
    default:
        return false;
    }
}

// The unit of a key's number: that of the setting where the case has it, for it may be that of an
// angle or have an exponent. Fails where the key takes no number.
static bool find_unit(const JpCase *of, const char *key, char unit[CASEFILE_UNIT_SIZE], Err *err)
{
    const SchemaRow *row = schema_of_key(key);
    const bool is_signal = row == NULL || row->type == SCHEMA_SIGNAL;
    CasefileSignal signal = {.number_count = 0};
    if (is_signal && !case_signal(of, key, &signal)) {
        return fail_unknown_key(of, key, err);
    }
    text_finish(&signal.text);
    if (is_signal ? signal.number_count == 0 : !takes_number(row)) {
        return err_set(err, ERR_USAGE, "%s takes no single number; set it by a text", key);
    }
    CasefileSetting *setting = zeroed(1, sizeof *setting);
    const bool has_number = !is_signal && casefile_find(of->scenario, key, setting) &&
                            setting->number_count > 0 && setting->kind != CASEFILE_WORD;
    text_copy(unit, CASEFILE_UNIT_SIZE,
              is_signal    ? signal.unit
              : has_number ? setting->unit
                           : schema_unit(row));
    free(setting);
    return true;
}

typedef struct NumberSetting {
    JpCase *of;
    const char *key;
    double value;
} NumberSetting;

static bool work_set_number(void *context, Err *err)
{
    const NumberSetting *number = context;
    JpCase *of = number->of;
    char unit[CASEFILE_UNIT_SIZE];
    char text[NUMBER_SIZE];
    if (!isfinite(number->value)) {
        return err_set(err, ERR_USAGE, "%s: %g is no finite number", number->key, number->value);
    }
    if (!find_unit(of, number->key, unit, err)) {
        return false;
    }
    const char *blank = unit[0] != '\0' ? " " : "";
    snprintf(text, sizeof text, "%.17g%s%s", number->value, blank, unit);
    const char *value = text;
    Setting setting = {of, &number->key, &value, 1};
    return work_set(&setting, err);
}

JpCaseStatus jp_case_set_number(JpCase *of, const char *key, double value, JpCaseError *error)
{
    if (key == NULL) {
        return library_refuse(error, NO_KEY);
    }
    NumberSetting number = {of, key, value};
    return call_with(of, work_set_number, &number, error);
}

// Whether it can be run.

typedef struct Checking {
    JpCase *of;
    const char *backends;
} Checking;

// In a call of its own, as the list of settings.
static bool work_notes(void *context, Err *err)
{
    (void)err;
    JpCase *of = context;
    if (of->notes == NULL) {
        Text notes;
        text_init(&notes);
        casefile_unused(of->scenario, true, &notes);
        of->notes = notes.data;
    }
    return true;
}

static bool work_check(void *context, Err *err)
{
    const Checking *checking = context;
    JpCase *of = checking->of;
    CaseRun *run = zeroed(1, sizeof *run);
    Text backends;
    text_init(&backends);
    text_append(&backends, "run.backends=[%s]", checking->backends);
    const char *further[] = {backends.data};
    const size_t count = checking->backends != NULL ? 1 : 0;
    const bool is_right =
        case_scenario(of, further, count, &run->scenario, err) && case_run_check(run, err);
    text_finish(&backends);
    case_run_finish(run);
    free(run);
    return is_right;
}

JpCaseStatus jp_case_check(JpCase *of, const char *backends, const char **notes, JpCaseError *error)
{
    Checking checking = {of, backends};
    JpCaseStatus status = call_with(of, work_notes, of, error);
    status = status == JP_CASE_OK ? call_with(of, work_check, &checking, error) : status;
    if (notes != NULL && status == JP_CASE_OK) {
        *notes = of->notes;
    }
    return status;
}
