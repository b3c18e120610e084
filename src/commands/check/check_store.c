// Where are the starts stored that were measured for a baseline?
//
// The key of the file is what the starts depend on: the program's fingerprint, the case, and every
// setting that it makes use of.
#include "commands/check/check_store.h"

#include "base/room.h"
#include "base/text.h"
#include "write/fields.h"
#include "write/json_value.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

// A plan, and why it has no truth, which is empty where it has one.
typedef struct PlanLine {
    CheckPlan plan;
    char no_truth[CHECK_NOTE_SIZE];
} PlanLine;

#define PLAN(member) .offset = offsetof(PlanLine, member)

static const Field PLAN_FIELDS[] = {
    {"has_truth", FIELD_FLAG, FIELD_STORE, PLAN(plan.has_truth)},
    {"uncertainty", FIELD_NUMBER, FIELD_STORE, PLAN(plan.uncertainty)},
    {"is_limited", FIELD_FLAG, FIELD_STORE, PLAN(plan.is_limited)},
    {"horizon_s", FIELD_NUMBER, FIELD_STORE, PLAN(plan.horizon_s)},
    {"is_full", FIELD_FLAG, FIELD_STORE, PLAN(plan.is_full)},
    {"no_truth", FIELD_TEXT, FIELD_STORE, PLAN(no_truth), .size = CHECK_NOTE_SIZE},
    {0},
};

static json_t *start_array(CheckStart start)
{
    return json_pack("[I, f, I]", (json_int_t)start.member, start.share, (json_int_t)start.shake);
}

// {"start": [member, share, shake], "metrics": [[name, kind, is slow, value, scale, floor], ...]};
// of a hash the value is its hexadecimal digits.
static json_t *start_line(CheckStart start, const CheckMeasure *measure)
{
    json_t *metrics = json_array();
    for (size_t i = 0; i < measure->count; i++) {
        const CheckMetric *metric = &measure->metrics[i];
        json_t *value = metric->kind == CHECK_HASH ? json_sprintf("%016" PRIx64, metric->hash)
                                                   : json_real(metric->value);
        json_array_append_new(metrics,
                              json_pack("[s, i, b, o, f, f]", metric->name, (int)metric->kind,
                                        (int)metric->is_slow, value, metric->scale, metric->floor));
    }
    return json_pack("{s:o, s:o}", "start", start_array(start), "metrics", metrics);
}

static bool take_metric(json_t *line, CheckMetric *metric)
{
    const char *name;
    int kind;
    int is_slow;
    json_t *value;
    if (json_unpack(line, "[s, i, b, o, F, F]", &name, &kind, &is_slow, &value, &metric->scale,
                    &metric->floor) != 0 ||
        kind < CHECK_REAL || kind > CHECK_HASH ||
        (kind == CHECK_HASH ? !json_is_string(value) : !json_is_number(value))) {
        return false;
    }
    text_copy(metric->name, sizeof metric->name, name);
    metric->kind = (CheckKind)kind;
    metric->is_slow = is_slow != 0;
    if (metric->kind == CHECK_HASH) {
        metric->hash = strtoull(json_string_value(value), NULL, 16);
    } else {
        metric->value = json_number_value(value);
    }
    return true;
}

// Whether a line is of that start; it then fills the measure. False also where it is damaged.
static bool take_start(const json_t *line, CheckStart start, CheckMeasure *measure)
{
    const json_t *metrics = json_object_get(line, "metrics");
    json_t *wanted = start_array(start);
    const bool is_it = json_equal(json_object_get(line, "start"), wanted) != 0;
    json_decref(wanted);
    const size_t count = json_array_size(metrics);
    if (!is_it || count == 0) {
        return false;
    }
    check_measure_finish(measure);
    measure->metrics = room_grow(measure->metrics, &measure->room, count, sizeof *measure->metrics);
    measure->is_complete = true;
    measure->count = count;
    for (size_t i = 0; i < count; i++) {
        if (!take_metric(json_array_get(metrics, i), &measure->metrics[i])) {
            check_measure_finish(measure);
            return false;
        }
    }
    return true;
}

static json_t *make_key(const CheckItem *item)
{
    const Baseline *now = &item->now;
    json_t *settings = json_object();
    for (size_t i = 0; i < now->setting_count; i++) {
        json_object_set_new(settings, now->settings[i].key,
                            json_value_text(now->settings[i].value));
    }
    return json_pack("{s:s, s:o, s:o}", "build", now->build, "case",
                     json_value_text(item->relative), "settings", settings);
}

bool check_store_open(CheckStore *store, const CheckItem *item, Err *err)
{
    char path[FILE_PATH_SIZE + sizeof ".partial"];
    *store = (CheckStore){0};
    snprintf(path, sizeof path, "%s.partial", item->baseline_path);
    json_t *key = make_key(item);
    Err own = {0};
    // starts of another state of the case are worth nothing; what is no file of starts stays
    const bool is_open = journal_open(&store->journal, &JOURNAL_BLESS, path, key, false, &own) ||
                         journal_open(&store->journal, &JOURNAL_BLESS, path, key, true, err);
    json_decref(key);
    return is_open;
}

bool check_store_take_plan(const CheckStore *store, CheckPlan *plan, char *no_truth, size_t size)
{
    size_t index;
    json_t *line;
    json_array_foreach(store->journal.entries, index, line)
    {
        PlanLine kept;
        if (fields_json_read(PLAN_FIELDS, FIELD_STORE, json_object_get(line, "plan"), &kept)) {
            *plan = kept.plan;
            text_copy(no_truth, size, kept.no_truth);
            return true;
        }
    }
    return false;
}

// Adds a line, and to the lines that are known.
static bool keep(CheckStore *store, json_t *line, Err *err)
{
    json_array_append(store->journal.entries, line);
    return journal_add(&store->journal, line, err);
}

bool check_store_keep_plan(CheckStore *store, const CheckPlan *plan, const char *no_truth, Err *err)
{
    PlanLine line = {.plan = *plan};
    text_copy(line.no_truth, sizeof line.no_truth, no_truth);
    return keep(store, json_pack("{s:o}", "plan", fields_json(PLAN_FIELDS, FIELD_STORE, &line)),
                err);
}

void check_store_take(CheckStore *store, CheckWork *works, size_t count)
{
    size_t index;
    json_t *line;
    json_array_foreach(store->journal.entries, index, line)
    {
        for (size_t i = 0; i < count; i++) {
            if (!works[i].is_over && take_start(line, works[i].start, works[i].measure)) {
                works[i].is_over = true;
            }
        }
    }
}

bool check_store_keep(CheckStore *store, const CheckWork *work, Err *err)
{
    return keep(store, start_line(work->start, work->measure), err);
}

size_t check_store_count(const CheckStore *store)
{
    size_t count = 0;
    size_t index;
    json_t *line;
    json_array_foreach(store->journal.entries, index, line)
    {
        count += json_object_get(line, "metrics") != NULL ? 1 : 0;
    }
    return count;
}

void check_store_close(CheckStore *store, bool is_needed)
{
    if (is_needed) {
        journal_close(&store->journal);
    } else {
        journal_discard(&store->journal);
    }
}
