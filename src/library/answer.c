// Holds what came of a run, and tells it: as JSON, and number by number.
//
// Numbers are the leaves of the JSON, so that there is one list of them.
#include "library/library.h"

#include "base/room.h"
#include "base/zeroed.h"
#include "commands/run/run_overview.h"
#include "write/json_value.h"
#include "write/settings_json.h"
#include "write/settled.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char NO_ANSWER[] = "there is no answer: NULL was given for it";
static const char NO_NAME[] = "there is no name: NULL was given for it";
static const char NOWHERE[] = "there is nowhere to write to: NULL was given for it";

static void free_columns(AnswerColumns *columns)
{
    for (size_t i = 0; i < columns->count; i++) {
        free(columns->columns[i].name);
        free(columns->columns[i].unit);
        free(columns->columns[i].numbers);
        free(columns->columns[i].words);
    }
    free(columns->columns);
}

static void free_leaves(AnswerLeaves *leaves)
{
    for (size_t i = 0; i < leaves->count; i++) {
        free(leaves->leaves[i].name);
    }
    free(leaves->leaves);
    free(leaves->sorted);
    free(leaves->numbers);
}

void answer_destroy(JpAnswer *of)
{
    if (of == NULL) {
        return;
    }
    for (size_t i = 0; of->tables != NULL && i < of->run->report.run_count; i++) {
        for (int k = 0; k < ANSWER_TABLE_COUNT; k++) {
            free_columns(&of->tables[i][k]);
        }
    }
    free(of->tables);
    free_leaves(&of->leaves);
    for (size_t i = 0; i < of->asked_count; i++) {
        free(of->asked[i]);
    }
    free(of->asked);
    for (int i = 0; i < ANSWER_FORM_COUNT; i++) {
        free(of->forms[i].data);
    }
    json_decref(of->json);
    free(of->json_text);
    if (of->mapping != NULL) {
        mapping_finish(of->mapping);
        free(of->mapping);
    }
    if (of->run != NULL) {
        case_run_finish(of->run);
        free(of->run);
    } else {
        scenario_destroy(of->scenario);
    }
    free(of);
}

void jp_answer_free(JpAnswer *of)
{
    answer_destroy(of);
}

static JpCaseStatus call_of(JpAnswer *of, LibraryWork *work, void *context, JpCaseError *error)
{
    if (of == NULL) {
        return library_refuse(error, NO_ANSWER);
    }
    return library_call(&(LibraryCall){.work = work, .context = context}, error);
}

// JSON and text.

static MappingReport mapping_report(const JpAnswer *of)
{
    return (MappingReport){of->scenario, of->mapping, NULL};
}

static json_t *build_json(const JpAnswer *of)
{
    if (of->kind == ANSWER_RUN) {
        return run_json_build(&of->run->report);
    }
    if (of->kind == ANSWER_MAP) {
        const MappingReport report = mapping_report(of);
        return mapping_json_build(&report);
    }
    json_t *object = json_object();
    settings_json_begin(object, of->scenario);
    return object;
}

const json_t *answer_values(JpAnswer *of)
{
    if (of->json == NULL) {
        of->json = build_json(of);
    }
    return of->json;
}

static bool work_json(void *context, Err *err)
{
    (void)err;
    JpAnswer *of = context;
    if (of->json_text == NULL) {
        Text text;
        text_init(&text);
        json_value_write(answer_values(of), JSON_VALUE_FLAGS, &text);
        of->json_text = text.data;
        of->json_length = text.length;
    }
    return true;
}

const char *jp_answer_json(JpAnswer *of, size_t *length, JpCaseError *error)
{
    if (call_of(of, work_json, of, error) != JP_CASE_OK) {
        return NULL;
    }
    if (length != NULL) {
        *length = of->json_length;
    }
    return of->json_text;
}

enum { SCREEN_WIDTH = 80 };

typedef enum Form { FORM_SCREEN, FORM_FULL, FORM_PICTURE } Form;

static const char *const FORMS[ANSWER_FORM_COUNT] = {"screen", "full", "picture"};

typedef struct Writing {
    JpAnswer *of;
    const char *form;
    const Text *written;
} Writing;

static void write_run(const RunReport *report, Form form, const Style *style, Text *text)
{
    switch (form) {
    case FORM_SCREEN:
        run_overview_screen(report, style, text);
        break;
    case FORM_FULL:
        run_text_write(report, style, text);
        break;
    case FORM_PICTURE:
        plot_run_write(report, text);
        break;
    }
}

static void write_mapping(const MappingReport *report, Form form, const Style *style, Text *text)
{
    switch (form) {
    case FORM_SCREEN:
        mapping_screen_write(report, style, text);
        break;
    case FORM_FULL:
        mapping_text_write(report, style, text);
        break;
    case FORM_PICTURE:
        mapping_plot_write(report, text);
        break;
    }
}

static bool work_text(void *context, Err *err)
{
    Writing *writing = context;
    JpAnswer *of = writing->of;
    int form = 0;
    while (form < ANSWER_FORM_COUNT && strcmp(FORMS[form], writing->form) != 0) {
        form++;
    }
    if (form == ANSWER_FORM_COUNT || (of->kind == ANSWER_SETTLED && form != FORM_SCREEN)) {
        return err_set(err, ERR_USAGE, "the answer has no form '%s'; allowed: screen%s",
                       writing->form, of->kind == ANSWER_SETTLED ? "" : ", full, picture");
    }
    if (of->forms[form].data == NULL) {
        const Style style = {.heading = "", .failure = "", .end = "", .width = SCREEN_WIDTH};
        const MappingReport report = mapping_report(of);
        Text text;
        text_init(&text);
        if (of->kind == ANSWER_RUN) {
            write_run(&of->run->report, (Form)form, &style, &text);
        } else if (of->kind == ANSWER_MAP) {
            write_mapping(&report, (Form)form, &style, &text);
        } else {
            settled_text(of->scenario, &text);
        }
        text_fold(&text, form == FORM_PICTURE ? 0 : SCREEN_WIDTH);
        of->forms[form] = text;
    }
    writing->written = &of->forms[form];
    return true;
}

const char *jp_answer_text(JpAnswer *of, const char *form, size_t *length, JpCaseError *error)
{
    Writing writing = {.of = of, .form = form};
    if (form == NULL) {
        library_refuse(error, NO_NAME);
        return NULL;
    }
    if (call_of(of, work_text, &writing, error) != JP_CASE_OK) {
        return NULL;
    }
    if (length != NULL) {
        *length = writing.written->length;
    }
    return writing.written->data;
}

// Leaves.

// A name below another.
static char *join(const char *above, const char *key)
{
    const size_t size = strlen(above) + strlen(key) + 2;
    char *name = zeroed(size, 1);
    snprintf(name, size, "%s%s%s", above, above[0] != '\0' ? "." : "", key);
    return name;
}

static void add_leaf(AnswerLeaves *leaves, const char *name, const json_t *value, size_t run)
{
    leaves->leaves =
        room_grow(leaves->leaves, &leaves->room, leaves->count + 1, sizeof *leaves->leaves);
    leaves->leaves[leaves->count++] = (AnswerLeaf){
        .name = strdup(name),
        .word = json_is_string(value) ? json_string_value(value) : NULL,
        .value = json_is_number(value)    ? json_number_value(value)
                 : json_is_boolean(value) ? (json_is_true(value) ? 1.0 : 0.0)
                                          : NAN,
        .run = run,
    };
}

// Null is a number that is not known where the key has a unit, and else a word; a name in front of
// what a run has is that of its backend.
static void add_leaves(AnswerLeaves *leaves, const char *name, const json_t *value, size_t run)
{
    if (json_is_object(value)) {
        const char *key;
        json_t *member;
        json_object_foreach((json_t *)value, key, member)
        {
            char *below = join(name, key);
            add_leaves(leaves, below, member, run);
            free(below);
        }
    } else if (json_is_array(value)) {
        for (size_t i = 0; i < json_array_size(value); i++) {
            char number[24];
            snprintf(number, sizeof number, "%zu", i);
            char *below = join(name, number);
            add_leaves(leaves, below, json_array_get(value, i), run);
            free(below);
        }
    } else {
        add_leaf(leaves, name, value, run);
    }
}

static int by_name(const void *a, const void *b, void *context)
{
    const AnswerLeaf *leaves = context;
    return strcmp(leaves[*(const size_t *)a].name, leaves[*(const size_t *)b].name);
}

// Sorts by merging, which needs no memory beside its own.
static void sort_leaves(AnswerLeaves *leaves)
{
    const size_t count = leaves->count;
    leaves->sorted = zeroed(count, sizeof *leaves->sorted);
    size_t *other = zeroed(count, sizeof *other);
    for (size_t i = 0; i < count; i++) {
        leaves->sorted[i] = i;
    }
    for (size_t width = 1; width < count; width *= 2) {
        for (size_t from = 0; from < count; from += 2 * width) {
            const size_t middle = from + width < count ? from + width : count;
            const size_t end = from + 2 * width < count ? from + 2 * width : count;
            size_t left = from;
            size_t right = middle;
            for (size_t i = from; i < end; i++) {
                const bool is_left =
                    left < middle &&
                    (right == end ||
                     by_name(&leaves->sorted[left], &leaves->sorted[right], leaves->leaves) <= 0);
                other[i] = is_left ? leaves->sorted[left++] : leaves->sorted[right++];
            }
        }
        memcpy(leaves->sorted, other, count * sizeof *other);
    }
    free(other);
}

// In a call of its own, which takes no memory behind its end: where it breaks off, there is no
// list.
static bool work_leaves(void *context, Err *err)
{
    (void)err;
    JpAnswer *of = context;
    if (of->leaves.is_listed) {
        return true;
    }
    AnswerLeaves leaves = {.is_listed = true};
    const char *key;
    json_t *member;
    json_object_foreach((json_t *)answer_values(of), key, member)
    {
        if (of->kind != ANSWER_RUN || strcmp(key, "runs") != 0) {
            add_leaves(&leaves, key, member, SIZE_MAX);
            continue;
        }
        for (size_t i = 0; i < json_array_size(member); i++) {
            add_leaves(&leaves, of->run->runs[i]->backend, json_array_get(member, i), i);
        }
    }
    sort_leaves(&leaves);
    leaves.numbers = zeroed(leaves.count, sizeof *leaves.numbers);
    for (size_t i = 0; i < leaves.count; i++) {
        const AnswerLeaf *leaf = &leaves.leaves[i];
        if (leaf->word == NULL && (!isnan(leaf->value) || listing_unit(leaf->name)[0] != '\0')) {
            leaves.numbers[leaves.number_count++] = i;
        }
    }
    of->leaves = leaves;
    return true;
}

static const AnswerLeaf *leaf_find(const AnswerLeaves *leaves, const char *name)
{
    size_t low = 0;
    size_t high = leaves->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        const AnswerLeaf *leaf = &leaves->leaves[leaves->sorted[middle]];
        const int order = strcmp(name, leaf->name);
        if (order == 0) {
            return leaf;
        }
        if (order < 0) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return NULL;
}

bool answer_find_run(const JpAnswer *of, const char **name, size_t *run)
{
    *run = 0;
    for (size_t i = 0; of->run != NULL && i < of->run->report.run_count; i++) {
        const char *backend = of->run->runs[i]->backend;
        const size_t length = strlen(backend);
        if (strncmp(*name, backend, length) == 0 && (*name)[length] == '.') {
            *name += length + 1;
            *run = i;
            return true;
        }
    }
    return of->run != NULL && of->run->report.run_count > 0;
}

typedef struct Asking {
    JpAnswer *of;
    const char *name;
    size_t index;
    const AnswerLeaf *found;
    JpNumber number;
    bool is_found; // without the leaves
} Asking;

// What a speed of a body of the certified reference may be off: the truth says it of the largest.
static double find_uncertainty(const JpAnswer *of, size_t number, const char *of_run)
{
    if (of->run == NULL || number == SIZE_MAX || of->run->report.truth == NULL) {
        return NAN;
    }
    const Truth *truth = of->run->report.truth;
    const Trajectory *run = of->run->runs[number];
    const Linkage *linkage = &of->scenario->linkage;
    double uncertainty = NAN;
    for (size_t i = 0; run == truth->trajectory && !truth->is_uncertified && run->is_complete &&
                       truth->message[0] == '\0' && i < linkage->body_count;
         i++) {
        char name[3 * LINKAGE_NAME_SIZE];
        snprintf(name, sizeof name, "%s.bodies.%s.omega_m", run->backend, linkage->bodies[i].name);
        const char *end = of_run + strlen(of_run) - strlen("_rad_s");
        if (strncmp(of_run, name, strlen(name)) == 0 && strcmp(end, "_rad_s") == 0) {
            uncertainty = truth->uncertainty * trajectory_omega_scale(run, i);
        }
    }
    return uncertainty;
}

// A number of the table, without the JSON: what it would say, to the last bit.

// The whole name of a number of a run, which the answer keeps.
static const char *kept_name(JpAnswer *of, size_t run, const char *name)
{
    const char *backend = of->run->runs[run]->backend;
    const size_t length = strlen(backend);
    for (size_t i = 0; i < of->asked_count; i++) {
        const char *asked = of->asked[i];
        if (strncmp(asked, backend, length) == 0 && asked[length] == '.' &&
            strcmp(asked + length + 1, name) == 0) {
            return asked;
        }
    }
    char *made = join(backend, name);
    // nothing takes memory behind this
    of->asked = room_grow(of->asked, &of->asked_room, of->asked_count + 1, sizeof *of->asked);
    of->asked[of->asked_count++] = made;
    return made;
}

// Which member of a linkage has a name; false where none has.
static bool find_member(const Linkage *linkage, NumberOwner owner, const char *name, size_t *member)
{
    *member = 0;
    if (NUMBER_OWNERS[owner].members == NUMBER_OF_WHOLE) {
        return true;
    }
    const size_t count = number_member_count(owner, linkage);
    while (*member < count && strcmp(number_member(owner, linkage, *member), name) != 0) {
        (*member)++;
    }
    return *member < count;
}

// Whether the JSON of a complete run has a number of a member.
static bool has_number(const Linkage *linkage, const ListingPlace *place, size_t member)
{
    const Number *number = &NUMBERS[place->id];
    switch (number->owner) {
    case NUMBER_OWNER_BODY:
        if (linkage_is_driven(linkage, (int)member)) {
            return false;
        }
        break;
    case NUMBER_OWNER_JOINT:
    case NUMBER_OWNER_RUN:
    case NUMBER_OWNER_ENERGY:
    case NUMBER_OWNER_COST:
        break;
    default:
        return false; // told by the JSON alone
    }
    return (number->traits & number_fields_lacked(linkage)) == 0 &&
           strcmp(number->keys[number_turn(number->owner, linkage, member)],
                  number->keys[place->turn]) == 0;
}

// False where the JSON has to say it.
static bool find_at_once(Asking *asking)
{
    const JpAnswer *of = asking->of;
    const char *name = asking->name;
    ListingPlace place;
    size_t run;
    size_t member;
    if (of->leaves.is_listed || !answer_find_run(of, &name, &run) || !listing_find(name, &place)) {
        return false;
    }
    const Linkage *linkage = &of->scenario->linkage;
    const NumberOwner owner = NUMBERS[place.id].owner;
    if (!of->run->runs[run]->is_complete || !find_member(linkage, owner, place.member, &member) ||
        !has_number(linkage, &place, member)) {
        return false;
    }
    const NumberSource source = run_report_source(&of->run->report, run);
    const double value = number_find(place.id, &source, member).value;
    asking->number = (JpNumber){
        .name = kept_name(asking->of, run, name),
        .value = isfinite(value) ? value : NAN,
        .unit = listing_unit(place.path),
        .doc = NUMBERS[place.id].meaning,
    };
    asking->number.uncertainty = find_uncertainty(of, run, asking->number.name);
    return true;
}

static bool work_at_once(void *context, Err *err)
{
    (void)err;
    Asking *asking = context;
    asking->is_found = find_at_once(asking);
    return true;
}

// Asks for what stands among the leaves.
static JpCaseStatus ask_leaves(Asking *asking, LibraryWork *work, JpCaseError *error)
{
    const JpCaseStatus status = call_of(asking->of, work_leaves, asking->of, error);
    return status == JP_CASE_OK ? call_of(asking->of, work, asking, error) : status;
}

static bool fail_unknown_number(const Asking *asking, const AnswerLeaves *leaves, Err *err)
{
    const char *first = asking->of->run != NULL ? asking->of->run->runs[0]->backend : "";
    const size_t length = strlen(first);
    const char **names = zeroed(leaves->count, sizeof *names);
    for (size_t i = 0; i < leaves->count; i++) {
        const char *name = leaves->leaves[i].name;
        // those of the first run may be asked for without its backend
        names[i] = leaves->leaves[i].run == 0 && strncmp(asking->name, first, length) != 0
                       ? name + length + 1
                       : name;
    }
    const char *nearest = text_nearest(asking->name, names, leaves->count);
    err_set(err, ERR_USAGE, "the answer has no '%s'%s%s%s", asking->name,
            nearest != NULL ? "; did you mean '" : "", nearest != NULL ? nearest : "",
            nearest != NULL ? "'?" : "");
    free(names);
    return false;
}

static bool find_leaf(Asking *asking, Err *err)
{
    JpAnswer *of = asking->of;
    const AnswerLeaves *leaves = &of->leaves;
    if (of->run != NULL) {
        char *name = join(of->run->runs[0]->backend, asking->name);
        asking->found = leaf_find(leaves, name);
        free(name);
    }
    asking->found = asking->found != NULL ? asking->found : leaf_find(leaves, asking->name);
    return asking->found != NULL || fail_unknown_number(asking, leaves, err);
}

// The unit that a setting has beside it.
static const char *unit_of(const AnswerLeaves *leaves, const char *name)
{
    static const char SETTINGS[] = "settings.";
    if (strncmp(name, SETTINGS, sizeof SETTINGS - 1) != 0) {
        return listing_unit(name);
    }
    char unit[CASEFILE_KEY_SIZE + sizeof "setting_units."];
    snprintf(unit, sizeof unit, "setting_units.%s", name + sizeof SETTINGS - 1);
    const AnswerLeaf *leaf = leaf_find(leaves, unit);
    return leaf != NULL && leaf->word != NULL ? leaf->word : "";
}

static void fill_number(const JpAnswer *of, const AnswerLeaf *leaf, JpNumber *number)
{
    *number = (JpNumber){
        .name = leaf->name,
        .value = leaf->value,
        .unit = unit_of(&of->leaves, leaf->name),
        .doc = leaf->run == SIZE_MAX ? "" : listing_doc(strchr(leaf->name, '.') + 1),
        .uncertainty = find_uncertainty(of, leaf->run, leaf->name),
    };
}

static bool work_number(void *context, Err *err)
{
    Asking *asking = context;
    if (!find_leaf(asking, err)) {
        return false;
    }
    if (asking->found->word != NULL) {
        return err_set(err, ERR_USAGE, "'%s' is a word and no number: '%s'", asking->name,
                       asking->found->word);
    }
    fill_number(asking->of, asking->found, &asking->number);
    return true;
}

JpCaseStatus jp_answer_number(JpAnswer *of, const char *name, JpNumber *number, JpCaseError *error)
{
    if (name == NULL || number == NULL) {
        return library_refuse(error, name == NULL ? NO_NAME : NOWHERE);
    }
    Asking asking = {.of = of, .name = name};
    JpCaseStatus status = call_of(of, work_at_once, &asking, error);
    if (status == JP_CASE_OK && !asking.is_found) {
        status = ask_leaves(&asking, work_number, error);
    }
    if (status == JP_CASE_OK) {
        *number = asking.number;
    }
    return status;
}

size_t jp_answer_number_count(JpAnswer *of, JpCaseError *error)
{
    return call_of(of, work_leaves, of, error) == JP_CASE_OK ? of->leaves.number_count : 0;
}

static bool work_number_at(void *context, Err *err)
{
    Asking *asking = context;
    const AnswerLeaves *leaves = &asking->of->leaves;
    if (asking->index >= leaves->number_count) {
        return err_set(err, ERR_USAGE, "the answer has %zu numbers, and none of number %zu",
                       leaves->number_count, asking->index);
    }
    fill_number(asking->of, &leaves->leaves[leaves->numbers[asking->index]], &asking->number);
    return true;
}

JpCaseStatus jp_answer_number_at(JpAnswer *of, size_t index, JpNumber *number, JpCaseError *error)
{
    if (number == NULL) {
        return library_refuse(error, NOWHERE);
    }
    Asking asking = {.of = of, .index = index};
    const JpCaseStatus status = ask_leaves(&asking, work_number_at, error);
    if (status == JP_CASE_OK) {
        *number = asking.number;
    }
    return status;
}

static bool work_word(void *context, Err *err)
{
    Asking *asking = context;
    if (!find_leaf(asking, err)) {
        return false;
    }
    return asking->found->word != NULL || isnan(asking->found->value) ||
           err_set(err, ERR_USAGE, "'%s' is a number and no word", asking->name);
}

JpCaseStatus jp_answer_word(JpAnswer *of, const char *name, const char **word, JpCaseError *error)
{
    if (name == NULL || word == NULL) {
        return library_refuse(error, name == NULL ? NO_NAME : NOWHERE);
    }
    Asking asking = {.of = of, .name = name};
    const JpCaseStatus status = ask_leaves(&asking, work_word, error);
    if (status == JP_CASE_OK) {
        *word = asking.found->word != NULL ? asking.found->word : "";
    }
    return status;
}
