// What do other programs read of a regression check?
#include "commands/check/check_report.h"

#include "write/json_value.h"
#include "write/settings_json.h"

#include <inttypes.h>

static void set_numbers(json_t *object, const CheckRow *row)
{
    if (row->verdict == CHECK_SETTING) {
        json_object_set_new(object, "was", json_value_text(row->was_text));
        json_object_set_new(object, "now", json_value_text(row->now_text));
    } else if (row->kind == CHECK_HASH) {
        json_object_set_new(object, "was", json_sprintf("%016" PRIx64, row->hash_was));
        json_object_set_new(object, "now", json_sprintf("%016" PRIx64, row->hash_now));
    } else {
        json_value_set(object, "was", row->was);
        json_value_set(object, "now", row->now);
        json_value_set(object, "difference", row->deviation);
        json_value_set(object, "band", row->band);
        json_value_set(object, "bands_off", row->severity);
        json_value_set(object, "p", row->band_kind == BAND_STATISTICAL ? row->p : NAN);
    }
}

static json_t *row_object(const CheckRow *row)
{
    char words[CHECK_WORDS_SIZE];
    check_report_words(row, words);
    json_t *object = json_object();
    json_object_set_new(object, "metric", json_value_text(row->name));
    json_object_set_new(object, "verdict", json_string(CHECK_VERDICT_WORDS[row->verdict]));
    set_numbers(object, row);
    if (row->verdict != CHECK_SETTING) {
        json_object_set_new(object, "band_kind", json_string(BASELINE_BAND_WORDS[row->band_kind]));
    }
    json_object_set_new(object, "why", json_value_text(row->why));
    json_object_set_new(object, "message", json_value_text(words));
    return object;
}

static json_t *limit_object(const CheckLimit *limit)
{
    char words[CHECK_WORDS_SIZE];
    check_report_limit(limit, words);
    json_t *object =
        json_pack("{s:o, s:o, s:s, s:o}", "path", json_value_text(limit->name), "limit",
                  json_value_text(limit->expectation->words), "verdict",
                  CHECK_VERDICT_WORDS[limit->verdict], "message", json_value_text(words));
    json_value_set(object, "value", limit->value);
    json_value_set(object, "low", limit->expectation->low);
    json_value_set(object, "high", limit->expectation->high);
    json_value_set(object, "outside_by", limit->off);
    return object;
}

static json_t *outcome_object(const CheckOutcome *outcome)
{
    const OutcomeRun *run = &outcome->run;
    char words[CHECK_OUTCOME_TEXT_SIZE];
    check_outcome_words(outcome, words);
    json_t *object = json_pack(
        "{s:o, s:o, s:s, s:b, s:o, s:o, s:I}", "run", json_value_text(outcome->name), "expected",
        json_value_text(outcome->expected->words), "outcome", check_outcome_kind(outcome),
        "complete", (int)run->is_complete, "message", json_value_text(run->message), "found",
        json_value_text(words), "steps", (json_int_t)run->steps);
    json_value_set(object, "error", run->has_error ? run->error : NAN);
    json_value_set(object, "reference_uncertainty", outcome->uncertainty);
    json_value_set(object, "horizon_s", outcome->share > 0.0 ? outcome->horizon_s : NAN);
    json_value_set(object, "step_s", run->step_s);
    json_value_set(object, "wall_s", run->wall_s);
    return object;
}

static json_t *case_object(const CheckReport *report, const CheckCase *item)
{
    const CheckCounts counts = check_report_count(item);
    const char *status = item->err.kind != ERR_NONE  ? "failed"
                         : check_report_is_out(item) ? "out"
                                                     : "within";
    json_t *rows = json_array();
    for (size_t i = 0; i < item->row_count; i++) {
        json_array_append_new(rows, row_object(&item->rows[i]));
    }
    json_t *object =
        json_pack("{s:o, s:o, s:s, s:o, s:o, s:I, s:I, s:I, s:o}", "case",
                  json_value_text(item->path), "baseline", json_value_text(item->baseline),
                  "status", status, "message", json_value_text(item->err.text), "note",
                  json_value_text(item->note), "within", (json_int_t)counts.within, "out",
                  (json_int_t)counts.out, "left_out", (json_int_t)counts.left_out, "metrics", rows);
    json_t *limits = json_array();
    for (size_t i = 0; i < item->limit_count; i++) {
        json_array_append_new(limits, limit_object(&item->limits[i]));
    }
    json_object_set_new(object, "limits", limits);
    json_t *outcomes = json_array();
    for (size_t i = 0; i < item->outcome_count; i++) {
        json_array_append_new(outcomes, outcome_object(&item->outcomes[i]));
    }
    json_object_set_new(object, "outcomes", outcomes);
    if (report->is_blessed && item->err.kind == ERR_NONE) {
        json_object_set_new(object, "change", json_string(CHECK_CHANGE_WORDS[item->change]));
        json_object_set_new(object, "numbers", json_integer((json_int_t)item->made_count));
    }
    return object;
}

json_t *check_json_build(const void *target)
{
    const CheckReport *report = target;
    json_t *cases = json_array();
    for (size_t i = 0; i < report->case_count; i++) {
        json_array_append_new(cases, case_object(report, &report->cases[i]));
    }
    return json_pack("{s:o, s:s, s:b, s:I, s:f, s:o}", "tool", settings_json_tool(), "mode",
                     report->is_full ? "full" : "quick", "blessed", (int)report->is_blessed,
                     "rank_tests", (json_int_t)report->test_count, "false_alarm_rate", report->rate,
                     "cases", cases);
}
