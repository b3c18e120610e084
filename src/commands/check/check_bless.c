// Makes new baselines, and stores the starts that are measured for them.
//
// truth, for the horizon -> the case's own start and 8 beside it, in full -> bands -> where one is
// statistical a sample of 32 starts -> the file. What the new one says of the old one is a check.
// Until then each measured start is kept in a file, so that an interrupted run can be resumed.
#include "base/clock.h"
#include "base/room.h"
#include "base/text.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/written.h"
#include "commands/check/baseline.h"
#include "commands/check/check_list.h"
#include "commands/check/check_run.h"
#include "commands/check/check_work.h"
#include "measure/task.h"
#include "write/fields.h"
#include "write/journal.h"
#include "write/json_value.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct CheckStore {
    Journal journal;
} CheckStore;

// The store of the starts.
//
// The key of the file is what the starts depend on: the program's fingerprint, the case, and every
// setting that it makes use of.

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

// Opens the file of an item, or makes it. One that is of another state of the case or the program,
// or has a damaged first line, is begun anew. ERR_FILE.
static bool check_store_open(CheckStore *store, const CheckItem *item, Err *err)
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

static bool check_store_take_plan(const CheckStore *store, CheckPlan *plan, char *no_truth,
                                  size_t size)
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
static bool check_bless_append_line(CheckStore *store, json_t *line, Err *err)
{
    json_array_append(store->journal.entries, line);
    return journal_add(&store->journal, line, err);
}

// The plan, if it was kept; and keeping it. The reason is empty where the plan has a truth.
static bool check_store_keep_plan(CheckStore *store, const CheckPlan *plan, const char *no_truth,
                                  Err *err)
{
    PlanLine line = {.plan = *plan};
    text_copy(line.no_truth, sizeof line.no_truth, no_truth);
    return check_bless_append_line(
        store, json_pack("{s:o}", "plan", fields_json(PLAN_FIELDS, FIELD_STORE, &line)), err);
}

static void check_store_take(CheckStore *store, CheckWork *works, size_t count)
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

// Takes those of the works that were kept: they are then over.
static bool check_store_keep(CheckStore *store, const CheckWork *work, Err *err)
{
    return check_bless_append_line(store, start_line(work->start, work->measure), err);
}

// The number of starts that the file holds now.
static size_t check_store_count(const CheckStore *store)
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

// Closes the file, and removes it where it is not needed any more. Accepts a zeroed store.
static void check_store_close(CheckStore *store, bool is_needed)
{
    if (is_needed) {
        journal_close(&store->journal);
    } else {
        journal_discard(&store->journal);
    }
}

// The measures of a baseline in the making.
typedef struct Making {
    const CheckItem *item;
    const CheckOptions *options;
    CheckProgress progress;
    CheckStore store;
    CheckPlan plan;
    char no_truth[CHECK_NOTE_SIZE]; // why there are no errors; empty where there are
    CheckMeasure *measures;         // the case's own, then the members of an ensemble
} Making;

static void check_bless_wait_for_truth(const char *doing, void *context)
{
    (void)doing;
    Making *making = context;
    check_progress_show(&making->progress, &(CheckWorkState){.total = 0});
}

static bool check_bless_should_stop(void *context)
{
    (void)context;
    return interrupt_number() != 0;
}

static bool check_bless_wait(const CheckWorkState *state, void *context)
{
    Making *making = context;
    check_progress_show(&making->progress, state);
    return interrupt_number() == 0;
}

static bool check_bless_keep(const CheckWork *work, void *context, Err *err)
{
    Making *making = context;
    return check_store_keep(&making->store, work, err);
}

// The plan that the truth gives. A mechanism that the reference cannot take has numbers all the
// same, and no errors. But where the old baseline has errors a missing reference is a failure: it
// would remove the most sensitive numbers.
static bool check_bless_make_plan(Making *making, Err *err)
{
    Truth truth;
    const TruthChild work = {.scenario = making->item->scenario,
                             .run_limit_s = making->options->common.time_limit_s,
                             .wait = check_bless_wait_for_truth,
                             .should_stop = check_bless_should_stop,
                             .context = making};
    Err own = {0};
    const bool is_made = truth_child_make(&work, &truth, &own);
    making->plan = is_made ? check_plan(&truth) : (CheckPlan){.is_full = true};
    if (!making->plan.has_truth) {
        snprintf(making->no_truth, sizeof making->no_truth, "without errors: %.200s",
                 is_made ? truth.message : own.text);
    }
    truth_finish(&truth);
    if (check_bless_should_stop(making)) {
        return err_set(err, ERR_SOLVER,
                       "stopped before its first start; nothing is kept, and the same "
                       "command begins anew");
    }
    const CheckItem *item = making->item;
    const bool had_truth = item->baseline_err.kind == ERR_NONE && item->baseline.plan.has_truth;
    if (!making->plan.has_truth && had_truth) {
        return err_set(err, ERR_SOLVER,
                       "the old baseline has numbers of errors, and now there is no reference for "
                       "them: %s; mend that (jointplay run shows it), or delete %s, and the new "
                       "one is made without errors",
                       making->no_truth, item->baseline_path);
    }
    return check_store_keep_plan(&making->store, &making->plan, making->no_truth, err);
}

static bool check_bless_find_plan(Making *making, Err *err)
{
    return check_store_take_plan(&making->store, &making->plan, making->no_truth,
                                 sizeof making->no_truth) ||
           check_bless_make_plan(making, err);
}

// Whether all works were measured; the error says which was not, and why.
static bool check_measures(const Making *making, const CheckWork *works, size_t count, Err *err)
{
    for (size_t i = 0; i < count; i++) {
        if (!works[i].is_over) {
            return err_set(err, ERR_SOLVER,
                           "stopped; %zu measured starts are kept in %s, and the same command "
                           "goes on from there",
                           check_store_count(&making->store), making->store.journal.path);
        }
        if (!works[i].measure->is_complete) {
            return err_set(err, ERR_SOLVER,
                           "no baseline of a run that fails: %s; change the case until jointplay "
                           "run completes it; one that is meant to end so states it under "
                           "expect: and needs no baseline",
                           works[i].measure->message);
        }
    }
    return true;
}

// Measures those starts that are not kept yet; the first of a list of works is the number of the
// member given.
static bool check_bless_measure(Making *making, CheckStart (*start_of)(unsigned member),
                                unsigned first, size_t count, CheckMeasure *measures, Err *err)
{
    CheckWork *works = calloc(count, sizeof *works);
    assert(works != NULL);
    for (size_t i = 0; i < count; i++) {
        const unsigned member = first + (unsigned)i;
        works[i] = (CheckWork){.scenario = making->item->scenario, .plan = making->plan};
        works[i].start = member > 0 ? start_of(member) : (CheckStart){0, 0.0, 0};
        works[i].measure = &measures[i];
    }
    check_store_take(&making->store, works, count);
    const CheckWorkers workers = {making->options->common.jobs,
                                  making->options->common.time_limit_s, check_bless_wait,
                                  check_bless_keep, making};
    const bool is_done =
        check_work_do(&workers, works, count, err) && check_measures(making, works, count, err);
    free(works);
    return is_done;
}

// The baseline; `run` receives the case's own measure, the sample stays in the making.
static bool make_baseline(Making *making, Baseline *made, CheckMeasure *run, size_t *sample_count,
                          Err *err)
{
    CheckMeasure *measures = making->measures;
    *sample_count = 0;
    if (!check_bless_find_plan(making, err) ||
        !check_bless_measure(making, baseline_rounding_start, 0, 1 + BASELINE_MEMBERS, measures,
                             err)) {
        return false;
    }
    *run = check_measure_copy(&measures[0]);
    baseline_set_head(made, &making->item->now, &making->plan);
    baseline_set_start(made, making->item->scenario);
    text_copy(made->case_path, sizeof made->case_path, making->item->relative);
    if (!baseline_set_metrics(made, run, &measures[1], BASELINE_MEMBERS, err)) {
        return false;
    }
    const size_t tests = check_test_count(made);
    if (tests == 0) {
        return true;
    }
    *sample_count = BASELINE_SAMPLE_SIZE;
    return check_bless_measure(making, baseline_sample_start, 1, BASELINE_SAMPLE_SIZE, measures,
                               err) &&
           baseline_set_sample(made, measures, BASELINE_SAMPLE_SIZE,
                               CHECK_FALSE_ALARM_RATE / (double)tests, err);
}

// What the old baseline, which may be none, says of the new measures.
static void hold_against_old(const Making *making, const Baseline *made, const CheckMeasure *run,
                             size_t sample_count, CheckCase *result)
{
    const Baseline *old = &making->item->baseline;
    const size_t tests = check_test_count(old);
    const CheckEvidence evidence = {
        .run = run,
        .sample = making->measures,
        .sample_count = sample_count,
        .now = made,
        .is_full = tests == 0 || sample_count > 0,
        .rate = CHECK_FALSE_ALARM_RATE / (double)(tests > 0 ? tests : 1),
    };
    text_copy(result->note, sizeof result->note, making->no_truth);
    result->made_count = made->count;
    if (making->item->baseline_err.kind != ERR_NONE) {
        // one that cannot be read is replaced and reported
        result->change = making->item->is_there ? CHECK_CHANGE_UNREADABLE : CHECK_CHANGE_NEW;
        return;
    }
    CheckRow *rows = calloc(check_row_max(old, &evidence), sizeof *rows);
    assert(rows != NULL);
    result->row_count = check_judge(old, &evidence, rows);
    result->rows = rows;
    result->change = check_report_count(result).out > 0 ? CHECK_CHANGE_REPLACED : CHECK_CHANGE_NONE;
}

// Reports what was measured before.
static void say_taken(Making *making)
{
    const size_t kept = check_store_count(&making->store);
    written_damage(&making->store.journal, making->options->common.is_quiet);
    if (kept > 0 && !making->options->common.is_quiet) {
        output_say("%s: %zu measured starts are kept in %s: going on from there\n",
                   making->item->path, kept, making->store.journal.path);
    }
}

// Measures, judges against the old baseline and writes the new one.
static bool make_item(Making *making, CheckCase *result)
{
    Baseline made = {.settings = NULL};
    size_t sample_count;
    CheckMeasure run = {.is_complete = false};
    making->measures =
        calloc(1 + BASELINE_MEMBERS + BASELINE_SAMPLE_SIZE, sizeof *making->measures);
    assert(making->measures != NULL);
    const bool is_made = make_baseline(making, &made, &run, &sample_count, &result->err) &&
                         baseline_json_write(making->item->baseline_path, &made, &result->err);
    if (is_made) {
        hold_against_old(making, &made, &run, sample_count, result);
    }
    baseline_finish(&made);
    for (size_t i = 0; i < 1 + BASELINE_MEMBERS + BASELINE_SAMPLE_SIZE; i++) {
        check_measure_finish(&making->measures[i]);
    }
    free(making->measures);
    check_measure_finish(&run);
    return is_made;
}

static void bless_item(Making *making, CheckCase *result)
{
    const CheckItem *item = making->item;
    *result = (CheckCase){.path = item->path, .baseline = item->baseline_path, .err = item->err};
    if (item->err.kind != ERR_NONE) {
        return;
    }
    if (interrupt_number() != 0) {
        err_set(&result->err, ERR_SOLVER, "stopped before it began");
        return;
    }
    if (!check_store_open(&making->store, item, &result->err)) {
        return;
    }
    say_taken(making);
    const double started_s = clock_now_s();
    const bool is_made = make_item(making, result);
    result->wall_s = clock_now_s() - started_s;
    check_progress_end(&making->progress);
    // a file with nothing but a plan is not kept
    check_store_close(&making->store, !is_made && check_store_count(&making->store) > 0);
}

void check_run_bless(const CheckOptions *options, CheckItem *items, size_t count, CheckRun *run)
{
    *run = (CheckRun){.cases = calloc(count + 1, sizeof *run->cases)};
    assert(run->cases != NULL);
    interrupt_watch();
    // one for all cases, so that long work is warned of once
    CheckProgress progress = check_progress_start("", options->common.is_quiet);
    progress.case_count = count;
    for (size_t i = 0; i < count; i++) {
        progress.doing = items[i].path;
        progress.case_number = i + 1;
        Making making = {.item = &items[i], .options = options, .progress = progress};
        bless_item(&making, &run->cases[i]);
        progress = making.progress;
    }
    run->report = (CheckReport){.case_count = count,
                                .cases = run->cases,
                                .is_full = true,
                                .is_blessed = true,
                                .rate = CHECK_FALSE_ALARM_RATE};
}
