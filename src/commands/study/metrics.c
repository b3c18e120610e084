// The numbers of a run that a study keeps, by name.
//
// The names are those of the JSON output, joined: bodies.follower.omega_max_rad_s becomes
// follower_omega_max_rad_s. What was not measured, or is not finite, is NAN.
#include "commands/study/metrics.h"
#include "base/text.h"
#include "measure/number_values.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

// Whether a name stands in the layout before a column; stores tell no small letters from large
// ones.
static bool is_taken(const Layout *layout, const Column *until)
{
    const Column *const columns[] = {layout->settings, layout->results};
    const size_t counts[] = {layout->setting_count, layout->result_count};
    for (size_t part = 0; part < 2; part++) {
        for (size_t i = 0; i < counts[part]; i++) {
            const Column *column = &columns[part][i];
            if (column != until && strcasecmp(column->name, until->name) == 0) {
                return true;
            }
        }
    }
    return false;
}

// Joins two words by _. Letters and digits stay, all else becomes _; rad/s^2 becomes rad_s2, as in
// the JSON output. Names that become one are numbered.
static void name_column(const Layout *layout, Column *column, const char *first, const char *last)
{
    static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    enum { ROOM = RECORD_NAME_SIZE - 16 }; // the rest is for a number behind the name
    const bool is_joined = first[0] != '\0' && last[0] != '\0';
    char words[RECORD_NAME_SIZE];
    char name[ROOM];
    size_t length = 0;
    snprintf(words, sizeof words, "%s%s%s", first, is_joined ? "_" : "", last);
    for (const char *c = words; *c != '\0' && length < ROOM - 1; c++) {
        if (*c != '^') {
            name[length++] = (char)(strchr(PLAIN, *c) != NULL ? *c : '_');
        }
    }
    name[length] = '\0';
    text_copy(column->name, sizeof column->name, name);
    for (int number = 2; is_taken(layout, column); number++) {
        snprintf(column->name, sizeof column->name, "%s_%d", name, number);
    }
}

static void metrics_add_settings(const Spec *spec, Layout *layout)
{
    for (size_t i = 0; i < spec->variable_count; i++) {
        const Variable *variable = &spec->variables[i];
        Column *column = &layout->settings[layout->setting_count++];
        column->kind = variable->is_word    ? COLUMN_WORD
                       : variable->is_whole ? COLUMN_WHOLE
                                            : COLUMN_REAL;
        name_column(layout, column, variable->key, variable->is_word ? "" : variable->column_unit);
    }
}

// One result of a linkage.
typedef struct Result {
    NumberId id;
    size_t member; // number of its body or joint
} Result;

// Of which results there are none in some studies.
typedef struct Lists {
    bool has_settled;
    bool is_following;
    bool has_growth;
    bool has_neighbours;
} Lists;

static bool is_of_settled(NumberOwner owner)
{
    return owner == NUMBER_OWNER_SETTLED || owner == NUMBER_OWNER_SETTLED_JOINT ||
           owner == NUMBER_OWNER_SETTLED_BODY;
}

static bool is_of_error(NumberOwner owner)
{
    return owner == NUMBER_OWNER_ERROR || owner == NUMBER_OWNER_TRUTH;
}

// Whether a study of these lists has a number.
static bool metrics_is_listed(const Number *number, Lists lists)
{
    return (number->places & NUMBER_STUDY) != 0 &&
           (!is_of_settled(number->owner) || lists.has_settled) &&
           ((number->traits & NUMBER_FOLLOWED) == 0 || lists.is_following) &&
           ((number->traits & NUMBER_GROWTH) == 0 || lists.has_growth) &&
           ((number->traits & NUMBER_NEIGHBOURS) == 0 || lists.has_neighbours);
}

// Whether rows of a study have a number of a member: of joints, of those with play alone.
static bool has_result(const Number *number, const Linkage *linkage, size_t member)
{
    return number_is_of(number, linkage, member) && (number_members(number) != NUMBER_OF_JOINTS ||
                                                     linkage_has_play(&linkage->joints[member]));
}

// All results of a linkage in the order of their columns.
static size_t list_results(const Linkage *linkage, Lists lists, Result results[RECORD_RESULT_MAX])
{
    size_t count = 0;
    for (NumberOwner owner = 0; owner < NUMBER_OWNER_COUNT; owner++) {
        for (size_t i = 0; i < number_member_count(owner, linkage); i++) {
            for (NumberId id = 0; id < NUMBER_COUNT; id++) {
                const Number *number = &NUMBERS[id];
                if (number->owner == owner && metrics_is_listed(number, lists) &&
                    has_result(number, linkage, i)) {
                    assert(count < RECORD_RESULT_MAX);
                    results[count++] = (Result){id, i};
                }
            }
        }
    }
    return count;
}

bool metrics_fit(const Scenario *scenario, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    size_t count = 0;
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const bool is_there = (NUMBERS[id].places & NUMBER_STUDY) != 0;
        for (size_t i = 0; is_there && i < number_member_count(NUMBERS[id].owner, linkage); i++) {
            count += has_result(&NUMBERS[id], linkage, i) ? 1 : 0;
        }
    }
    return count <= RECORD_RESULT_MAX ||
           err_set(err, ERR_CASE,
                   "the mechanism has %zu bodies, and a row of a study has room for %d numbers of "
                   "bodies and joints; 'jointplay run --json' has them all",
                   linkage->body_count, RECORD_RESULT_MAX);
}

void metrics_layout(const Spec *spec, const Scenario *scenario, Layout *layout)
{
    Result results[RECORD_RESULT_MAX];
    const Linkage *linkage = &scenario->linkage;
    const Lists lists = {scenario_settles(scenario), spec->follow[0] != '\0', spec->has_growth,
                         spec->has_neighbours};
    const size_t count = list_results(linkage, lists, results);
    *layout = (Layout){0};
    metrics_add_settings(spec, layout);
    for (size_t i = 0; i < count; i++) {
        const size_t member = results[i].member;
        const Number *number = &NUMBERS[results[i].id];
        if (is_of_error(number->owner) && !spec->has_truth) {
            continue;
        }
        Column *column = &layout->results[layout->result_count++];
        column->kind = number_is_whole(number) ? COLUMN_WHOLE : COLUMN_REAL;
        name_column(layout, column, number_member(number->owner, linkage, member),
                    number->columns[number_turn(number->owner, linkage, member)]);
    }
}

// Whether a column is of a number with that key: its whole name, or with the name of a body or
// joint before it, whose length is then told.
static bool has_key(const char *column, const char *key, bool has_owner, size_t *owner_length)
{
    const size_t length = strlen(column);
    const size_t size = strlen(key);
    *owner_length = has_owner && length > size + 1 ? length - size - 1 : 0;
    return has_owner ? *owner_length > 0 && column[*owner_length] == '_' &&
                           strcmp(column + *owner_length + 1, key) == 0
                     : strcmp(column, key) == 0;
}

// The number of a column and how it turns, NULL where it is none: that of the longest key, so that
// one which ends as another does is not taken for it. Tells how long the owner's name is.
static const Number *number_of(const char *column, NumberTurn *turned, size_t *owner_length)
{
    const Number *found = NULL;
    size_t longest = 0;
    for (size_t i = 0; i < NUMBER_TURN_COUNT * NUMBER_COUNT; i++) {
        const Number *number = &NUMBERS[i / NUMBER_TURN_COUNT];
        const NumberTurn turn = (NumberTurn)(i % NUMBER_TURN_COUNT);
        const bool has_owner = number_members(number) != NUMBER_OF_WHOLE;
        const char *name = number->columns[turn];
        size_t length;
        if ((number->places & NUMBER_STUDY) != 0 && strlen(name) > longest &&
            has_key(column, name, has_owner, &length)) {
            longest = strlen(name);
            found = number;
            *turned = turn;
            *owner_length = length;
        }
    }
    return found;
}

bool metrics_title(const char *column, const char **title, const char **key, size_t *owner_length)
{
    NumberTurn turn;
    const Number *number = number_of(column, &turn, owner_length);
    if (number == NULL) {
        return false;
    }
    const bool is_torque = number->owner == NUMBER_OWNER_JOINT && turn == NUMBER_TURNED &&
                           number->kind == NUMBER_OF_FORCE;
    *title = is_torque ? "largest torque" : number->axis;
    *key = number->columns[turn];
    return true;
}

bool metrics_is_main(const char *column)
{
    NumberTurn turn;
    size_t owner_length;
    const Number *number = number_of(column, &turn, &owner_length);
    return number != NULL && (number->places & NUMBER_MAIN) != 0;
}

// Whether the columns of a study have one of a name.
static bool metrics_has(const Layout *layout, const char *name)
{
    for (size_t i = 0; i < layout->result_count; i++) {
        if (strcmp(layout->results[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

bool metrics_take(const Layout *layout, const Scenario *scenario, Trajectory *trajectory,
                  const Truth *truth, double results[RECORD_RESULT_MAX])
{
    assert(trajectory->is_complete);
    TrajectoryError error = {.is_known = false};
    if (truth != NULL && truth->trajectory->is_complete) {
        error = error_against(trajectory, truth->trajectory, truth->horizon_s);
        if (error_fail_unstable(trajectory, truth->trajectory, &error)) {
            return false;
        }
    }
    const NumberSource source = {
        .scenario = scenario, .run = trajectory, .error = &error, .truth = truth};
    Result list[RECORD_RESULT_MAX];
    const Lists lists = {
        metrics_has(layout, "settled_period"), metrics_has(layout, "followed_from"),
        metrics_has(layout, "settled_growth"), metrics_has(layout, "settled_from_run")};
    const size_t count = list_results(&scenario->linkage, lists, list);
    for (size_t i = 0; i < RECORD_RESULT_MAX; i++) {
        const double value =
            i < count ? number_find(list[i].id, &source, list[i].member).value : NAN;
        results[i] = isfinite(value) ? value : NAN;
    }
    return true;
}

static const char *before_name(NumberOwner owner)
{
    switch (NUMBER_OWNERS[owner].members) {
    case NUMBER_OF_BODIES:
        return "<body>_";
    case NUMBER_OF_JOINTS:
        return "<joint>_";
    case NUMBER_OF_WHOLE:
        break;
    }
    return "";
}

static const char *column_of(const Number *number)
{
    return number->columns[number->owner == NUMBER_OWNER_BODY_SPIKE ? NUMBER_SPED : NUMBER_PUSHED];
}

// Whether a number of a study is described; on its page not if another page has the meaning.
static bool is_described(const Number *number, bool is_markdown)
{
    return (number->places & NUMBER_STUDY) != 0 &&
           !(is_markdown && (number->places & (NUMBER_EXPECT | NUMBER_JSON)) != 0);
}

// The columns whose meanings other pages have.
static void list_expectable(Text *text)
{
    text_append(text, "- with the meanings in [numbers](output.md#numbers) and "
                      "[`expect`](case-format.md#expect)");
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const Number *number = &NUMBERS[id];
        if (is_described(number, false) && !is_described(number, true)) {
            text_append(text, ", `%s%s`", before_name(number->owner), column_of(number));
        }
    }
    text_append(text, "\n");
}

// On lines of a terminal's width.
static void append_meaning(const char *meaning, Text *text)
{
    enum { INDENT = 8, WIDTH = 80 };
    Text words;
    text_init(&words);
    text_append(&words, "%s", meaning);
    text_fold(&words, WIDTH - INDENT);
    for (const char *line = words.data; *line != '\0';) {
        const size_t length = strcspn(line, "\n");
        text_append(text, "%*s%.*s\n", INDENT, "", (int)length, line);
        line += length + (line[length] == '\n' ? 1 : 0);
    }
    text_finish(&words);
}

// On the page those of one meaning are a range, and those that other pages have stand before.
void metrics_describe(bool is_markdown, Text *text)
{
    if (is_markdown) {
        list_expectable(text);
    }
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const Number *number = &NUMBERS[id];
        const char *before = before_name(number->owner);
        if (!is_described(number, is_markdown)) {
            continue;
        }
        if (!is_markdown) {
            text_append(text, "    %s%s\n", before, column_of(number));
            append_meaning(number->meaning, text);
            continue;
        }
        NumberId last = id;
        while (last + 1 < NUMBER_COUNT && NUMBERS[last + 1].owner == number->owner &&
               is_described(&NUMBERS[last + 1], true) &&
               strcmp(NUMBERS[last + 1].meaning, number->meaning) == 0) {
            last++;
        }
        text_append(text, "- `%s%s`", before, column_of(number));
        if (last > id) {
            text_append(text, " to `%s%s`", before, column_of(&NUMBERS[last]));
        }
        text_append(text, ": %s\n", number->meaning);
        id = last;
    }
}
