// Reports a study: progress and distributions as text, its runs as CSV and JSON.
#include "commands/study/metrics.h"
#include "commands/study/study.h"
#include "write/csv.h"
#include "write/fields.h"
#include "write/file.h"
#include "write/json_value.h"
#include "write/settings_json.h"
#include "write/table.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// What the study did, in JSON.

#define AT(type, member) type, FIELD_JSON, .offset = offsetof(StudyReport, member)

// What this process did of it.
static const Field EFFORT_FIELDS[] = {
    {"made", AT(FIELD_COUNT, state.made)},
    {"failed", AT(FIELD_COUNT, state.failed)},
    {"without_truth", AT(FIELD_COUNT, state.without_truth)},
    {"why_without_truth", AT(FIELD_TEXT, state.no_truth)},
    {"jobs", AT(FIELD_COUNT, jobs)},
    {"wall_s", AT(FIELD_NUMBER, state.wall_s)},
    {"inside_s", AT(FIELD_NUMBER, state.inside_s)},
    {"inside_share", AT(FIELD_NUMBER, inside_share)},
    {"children_cpu_s", AT(FIELD_NUMBER, children_cpu_s)},
    {"own_cpu_s", AT(FIELD_NUMBER, own_cpu_s)},
    {0},
};
#undef AT

// Counts of runs are whole numbers, and below 2^53.
static json_t *whole(uint64_t count)
{
    return json_integer((json_int_t)count);
}

json_t *study_json_build(const StudyReport *report)
{
    json_t *outcomes = json_object();
    for (int i = 0; i < RUN_OUTCOME_COUNT; i++) {
        json_object_set_new(outcomes, RUN_OUTCOME_WORDS[i], whole(report->count.outcomes[i]));
    }
    json_t *object = json_object();
    json_object_set_new(object, "tool", settings_json_tool());
    json_object_set_new(object, "study", json_value_text(report->spec->path));
    json_object_set_new(object, "title", json_value_text(report->spec->title));
    json_object_set_new(object, "case", json_value_text(report->spec->case_path));
    json_object_set_new(object, "store", json_value_text(report->store));
    json_object_set_new(object, "shard",
                        json_pack("{s:o, s:o}", "index", whole(report->shard.index + 1), "count",
                                  whole(report->shard.count)));
    json_object_set_new(object, "runs", whole(report->state.total));
    json_object_set_new(object, "done", whole(report->state.done));
    json_object_set_new(object, "outcomes", outcomes);
    json_value_set(object, "wall_s", report->count.wall_s);
    json_object_set_new(object, "now", fields_json(EFFORT_FIELDS, FIELD_JSON, report));
    return object;
}

// The text.

enum {
    REASONS_SHOWN = 8,
    REASONS_ASKED = 64, // of each part; those of all are added up
};

// All parts together.
typedef struct Progress {
    uint64_t wanted;
    StoreCount count;
    size_t reason_count;
    StoreReason reasons[REASONS_ASKED];
} Progress;

static void add_reason(Progress *progress, const StoreReason *reason)
{
    for (size_t i = 0; i < progress->reason_count; i++) {
        StoreReason *known = &progress->reasons[i];
        if (known->outcome == reason->outcome && strcmp(known->reason, reason->reason) == 0) {
            known->count += reason->count;
            known->example = known->example < reason->example ? known->example : reason->example;
            return;
        }
    }
    if (progress->reason_count < REASONS_ASKED) {
        progress->reasons[progress->reason_count++] = *reason;
    }
}

static bool study_report_add_part(Progress *progress, const StudyPart *part, StoreCount *count,
                                  Err *err)
{
    StoreReason reasons[REASONS_ASKED];
    size_t reason_count = 0;
    *count = (StoreCount){0};
    progress->wanted += part->wanted;
    if (part->store == NULL) {
        return true;
    }
    if (!store_count(part->store, count, err) ||
        !store_reasons(part->store, REASONS_ASKED, reasons, &reason_count, err)) {
        return false;
    }
    progress->count.run_count = count->run_count;
    progress->count.rows += count->rows;
    progress->count.wall_s += count->wall_s;
    for (int outcome = 0; outcome < RUN_OUTCOME_COUNT; outcome++) {
        progress->count.outcomes[outcome] += count->outcomes[outcome];
    }
    for (size_t i = 0; i < reason_count; i++) {
        add_reason(progress, &reasons[i]);
    }
    return true;
}

// The most frequent first; there are few of them.
static void sort_reasons(Progress *progress)
{
    for (size_t i = 1; i < progress->reason_count; i++) {
        const StoreReason moved = progress->reasons[i];
        size_t k = i;
        for (; k > 0 && progress->reasons[k - 1].count < moved.count; k--) {
            progress->reasons[k] = progress->reasons[k - 1];
        }
        progress->reasons[k] = moved;
    }
}

static void append_duration(Text *text, double time_s)
{
    static const struct {
        double least_s;
        double unit_s;
        const char *unit;
    } UNITS[] = {{172800.0, 86400.0, "days"}, {7200.0, 3600.0, "h"}, {120.0, 60.0, "min"}};
    for (size_t i = 0; i < sizeof UNITS / sizeof *UNITS; i++) {
        if (time_s >= UNITS[i].least_s) {
            text_append(text, "%.3g %s", time_s / UNITS[i].unit_s, UNITS[i].unit);
            return;
        }
    }
    text_append(text, "%.3g s", time_s);
}

static double percent(uint64_t part, uint64_t whole)
{
    return whole == 0 ? 0.0 : 100.0 * (double)part / (double)whole;
}

static uint64_t study_report_count_failed(const StoreCount *count)
{
    return count->rows - count->outcomes[RUN_OUTCOME_OK];
}

static void part_row(Table *table, const StudyPart *part, const StoreCount *count)
{
    table_cell(table, "%s", part->path);
    table_cell(table, "%" PRIu64, part->wanted);
    table_cell(table, "%" PRIu64, count->rows);
    table_cell(table, "%.1f", percent(count->rows, part->wanted));
    table_cell(table, "%" PRIu64, study_report_count_failed(count));
    table_cell(table, part->store == NULL ? "not begun" : "");
}

static void study_report_write_outcomes(const Progress *progress, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"outcome", "", TABLE_LEFT}, {"runs", "", TABLE_RIGHT}, {"share", "%", TABLE_RIGHT}};
    Table *table = section_begin("How they ended", 3, HEADS, style, text);
    for (int outcome = 0; outcome < RUN_OUTCOME_COUNT; outcome++) {
        if (progress->count.outcomes[outcome] > 0) {
            table_cell(table, "%s", RUN_OUTCOME_WORDS[outcome]);
            table_cell(table, "%" PRIu64, progress->count.outcomes[outcome]);
            table_cell(table, "%.2f",
                       percent(progress->count.outcomes[outcome], progress->count.rows));
        }
    }
    section_end(table, text);
}

static void study_report_write_reasons(const Progress *progress, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {{"runs", "", TABLE_RIGHT},
                                        {"outcome", "", TABLE_LEFT},
                                        {"reason", "", TABLE_WRAP},
                                        {"such as run", "", TABLE_RIGHT}};
    if (progress->reason_count == 0) {
        return;
    }
    const size_t shown =
        progress->reason_count < REASONS_SHOWN ? progress->reason_count : REASONS_SHOWN;
    Table *table = section_begin("Why not ok", 4, HEADS, style, text);
    uint64_t told = 0;
    for (size_t i = 0; i < shown; i++) {
        const StoreReason *reason = &progress->reasons[i];
        told += reason->count;
        table_cell(table, "%" PRIu64, reason->count);
        table_cell(table, "%s", RUN_OUTCOME_WORDS[reason->outcome]);
        table_cell(table, "%s", reason->reason);
        table_cell(table, "%" PRIu64, reason->example);
    }
    section_end(table, text);
    const uint64_t others = study_report_count_failed(&progress->count) - told;
    if (others > 0) {
        text_append(text, "  and %" PRIu64 " more for other reasons\n", others);
    }
}

static void write_times(const Progress *progress, Text *text)
{
    const StoreCount *count = &progress->count;
    if (count->rows == 0) {
        return;
    }
    const double mean_s = count->wall_s / (double)count->rows;
    text_append(text, "\n  ");
    append_duration(text, count->wall_s);
    text_append(text, " inside runs, ");
    append_duration(text, mean_s);
    text_append(text, " a run");
    if (progress->wanted > count->rows) {
        text_append(text, "; at that rate one core has ");
        append_duration(text, mean_s * (double)(progress->wanted - count->rows));
        text_append(text, " left");
    }
    text_append(text, "\n");
}

// Which store was counted, or where the one that is not there was looked for.
static void append_place(const StudyPart *part, const char *places, Text *text)
{
    text_append(text, part->store == NULL ? "There is no " : "Store ");
    text_append_shown(text, part->path);
    text_append(text, part->store == NULL ? " %s.\n" : "\n", places);
}

bool study_text_status(const StudyPart *parts, size_t part_count, const char *places,
                       const Style *style, Text *text, Err *err)
{
    static const SectionHead HEADS[] = {{"store", "", TABLE_LEFT},   {"runs", "", TABLE_RIGHT},
                                        {"over", "", TABLE_RIGHT},   {"share", "%", TABLE_RIGHT},
                                        {"not ok", "", TABLE_RIGHT}, {"", "", TABLE_LEFT}};
    Progress progress = {0};
    Text stores;
    text_init(&stores);
    Table *table = section_begin("Stores", 6, HEADS, style, &stores);
    bool is_read = true;
    for (size_t i = 0; i < part_count && is_read; i++) {
        StoreCount count;
        is_read = study_report_add_part(&progress, &parts[i], &count, err);
        part_row(table, &parts[i], &count);
    }
    section_end(table, &stores);
    if (is_read) {
        // stores of shards that are each measured against the whole study
        const uint64_t whole = progress.count.run_count;
        progress.wanted = whole > 0 && progress.wanted > whole ? whole : progress.wanted;
        sort_reasons(&progress);
        text_append(text, "%s%" PRIu64 " of %" PRIu64 " runs are over (%.1f %%)%s\n",
                    style->heading, progress.count.rows, progress.wanted,
                    percent(progress.count.rows, progress.wanted), style->end);
        if (part_count == 1) {
            append_place(&parts[0], places, text);
        } else {
            text_append(text, "%s", stores.data);
        }
        if (progress.count.rows > 0) {
            study_report_write_outcomes(&progress, style, text);
        }
        study_report_write_reasons(&progress, style, text);
        write_times(&progress, text);
    }
    text_finish(&stores);
    return is_read;
}

static void study_report_spread_row(Table *table, const char *name, const StoreSpread *spread)
{
    table_cell(table, "%s", name);
    table_cell(table, "%" PRIu64, spread->count);
    const double values[] = {spread->least, spread->low, spread->median, spread->high,
                             spread->most};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        section_number_or_dash(table, spread->count > 0, values[i]);
    }
}

// The spread of a result by its name; without any number where there is no such result.
static StoreSpread spread_named(const Layout *layout, const StoreSpread *spreads, const char *name)
{
    StoreSpread found = {.count = 0};
    for (size_t i = 0; i < layout->result_count; i++) {
        found = strcmp(layout->results[i].name, name) == 0 ? spreads[i] : found;
    }
    return found;
}

// Which runs found their settled motion by themselves, and what those say of the others.
static void append_settled(const Layout *layout, const StoreSpread *spreads, Text *text)
{
    const StoreSpread from = spread_named(layout, spreads, "settled_from_run");
    const StoreSpread settled = spread_named(layout, spreads, "settled_period");
    const StoreSpread apart = spread_named(layout, spreads, "settled_apart");
    if (from.count == 0) {
        return;
    }
    text_append(text,
                "\nOf %" PRIu64 " settled runs %" PRIu64 " began in the motion of a neighbour, the "
                "others found theirs by themselves.\n",
                settled.count, from.count);
    if (apart.count > 0) {
        text_append(text,
                    "%" PRIu64
                    " did both: their largest forces differ by at most %.1e. Where it is "
                    "more than 1e-3, none of their twenty neighbours began so.\n",
                    apart.count, apart.most);
    }
}

// Of many main results those of a kind are shown that become largest.
enum { MAIN_MANY = 12, MAIN_OF_KIND = 3 };

// Whether a result is the largest force of a settled motion that repeats each revolution: that of
// the run is the same.
static bool is_told_twice(const Layout *layout, const StoreSpread *spreads, size_t result)
{
    static const char SETTLED[] = "_settled_force_N";
    static const char OF_RUN[] = "_force_max_N";
    const char *name = layout->results[result].name;
    const size_t length = strlen(name);
    const size_t tail = strlen(SETTLED);
    if (length < tail || strcmp(name + length - tail, SETTLED) != 0) {
        return false;
    }
    for (size_t i = 0; i < layout->result_count; i++) {
        const char *other = layout->results[i].name;
        if (strncmp(other, name, length - tail) == 0 &&
            strcmp(other + length - tail, OF_RUN) == 0) {
            return store_spreads_alike(&spreads[i], &spreads[result]);
        }
    }
    return false;
}

// Whether the end of a study shows a result unasked.
static bool is_shown(const Layout *layout, const StoreSpread *spreads, size_t result)
{
    const char *title;
    const char *key;
    size_t owner_length;
    size_t count = 0;
    size_t larger = 0;
    if (is_told_twice(layout, spreads, result)) {
        return false;
    }
    if (!metrics_is_main(layout->results[result].name) ||
        !metrics_title(layout->results[result].name, &title, &key, &owner_length)) {
        return metrics_is_main(layout->results[result].name);
    }
    for (size_t i = 0; i < layout->result_count; i++) {
        const char *other;
        if (spreads[i].count > 0 && metrics_is_main(layout->results[i].name)) {
            count++;
            larger += metrics_title(layout->results[i].name, &title, &other, &owner_length) &&
                              strcmp(other, key) == 0 && spreads[i].most > spreads[result].most
                          ? 1
                          : 0;
        }
    }
    return count <= MAIN_MANY || larger < MAIN_OF_KIND;
}

bool study_text_summary(Store *store, bool is_full, const Style *style, Text *text, Err *err)
{
    static const SectionHead HEADS[] = {
        {"result", "", TABLE_LEFT},  {"runs", "", TABLE_RIGHT | TABLE_DETAIL},
        {"least", "", TABLE_RIGHT},  {"5 %", "", TABLE_RIGHT | TABLE_DETAIL},
        {"median", "", TABLE_RIGHT}, {"95 %", "", TABLE_RIGHT | TABLE_MINOR},
        {"most", "", TABLE_RIGHT}};
    Text section;
    text_init(&section);
    Table *table = section_begin("Results of the complete runs (quantiles interpolated)",
                                 sizeof HEADS / sizeof *HEADS, HEADS, style, &section);
    const Layout *layout = store_layout(store);
    StoreSpread spreads[RECORD_RESULT_MAX];
    const bool is_read =
        store_spreads(store, layout->setting_count, layout->result_count, spreads, err);
    size_t others = 0;
    for (size_t i = 0; i < layout->result_count && is_read; i++) {
        const char *name = layout->results[i].name;
        if (spreads[i].count > 0 && (is_full || is_shown(layout, spreads, i))) {
            study_report_spread_row(table, name, &spreads[i]);
        } else {
            others += spreads[i].count > 0 ? 1 : 0;
        }
    }
    section_end(table, &section);
    if (others > 0) {
        text_append(
            &section,
            "  And %zu more: --full shows them, 'jointplay study export' has every run's.\n",
            others);
    }
    text_append(text, "%s", is_read ? section.data : "");
    if (is_read) {
        append_settled(layout, spreads, text);
    }
    text_finish(&section);
    return is_read;
}

// The rows of the store, as CSV and as JSON lines.

enum { HASH_SIZE = 24 };

// 17 digits give back every number as it was
static const size_t LINE_FLAGS = JSON_REAL_PRECISION(17) | JSON_COMPACT;

static const double SHOWN_WHOLE_MAX = 9007199254740992.0; // 2^53: whole numbers up to it are exact

// In hexadecimal: many readers of JSON know no whole number beyond 2^53. Empty where there is none.
static void write_hash(uint64_t hash, char words[HASH_SIZE])
{
    words[0] = '\0';
    if (hash != 0) {
        snprintf(words, HASH_SIZE, "%016" PRIx64, hash);
    }
}

static void study_report_write_cell(FILE *stream, const RecordField *field, const Record *record)
{
    char hash[HASH_SIZE];
    switch (field->kind) {
    case COLUMN_RUN:
        fprintf(stream, "%" PRIu64, record->run);
        break;
    case COLUMN_FATE:
        fputs(RUN_OUTCOME_WORDS[record->outcome], stream);
        break;
    case COLUMN_WORD:
    case COLUMN_REASON:
        csv_write_word(stream, record_text(record, field));
        break;
    case COLUMN_HASH:
        write_hash(record->hash, hash);
        fputs(hash, stream);
        break;
    case COLUMN_REAL:
    case COLUMN_WHOLE:
        csv_write_number(stream, record_number(record, field));
        break;
    }
}

// The names of the columns where there is no record.
static void study_report_write_line(FILE *stream, const Layout *layout, const Record *record)
{
    RecordField field;
    for (size_t i = 0; record_field(layout, i, &field); i++) {
        if (i > 0) {
            fputc(',', stream);
        }
        if (record == NULL) {
            csv_write_word(stream, field.name);
        } else {
            study_report_write_cell(stream, &field, record);
        }
    }
    fputc('\n', stream);
}

static bool take_csv(const Layout *layout, const Record *record, void *file, Err *err)
{
    study_report_write_line(((const WholeFile *)file)->stream, layout, record);
    return file_check(file, err);
}

static json_t *build_number(ColumnKind kind, double number)
{
    const bool is_whole =
        kind == COLUMN_WHOLE && fabs(number) <= SHOWN_WHOLE_MAX && number == rint(number);
    return is_whole ? json_integer((json_int_t)number) : json_value_real(number);
}

static json_t *build_value(const RecordField *field, const Record *record)
{
    char hash[HASH_SIZE];
    switch (field->kind) {
    case COLUMN_RUN:
        return json_integer((json_int_t)record->run);
    case COLUMN_FATE:
        return json_string(RUN_OUTCOME_WORDS[record->outcome]);
    case COLUMN_WORD:
        return json_value_text(record_text(record, field));
    case COLUMN_REASON:
        return record->reason[0] == '\0' ? json_null() : json_value_text(record->reason);
    case COLUMN_HASH:
        write_hash(record->hash, hash);
        return hash[0] == '\0' ? json_null() : json_string(hash);
    case COLUMN_REAL:
    case COLUMN_WHOLE:
        break;
    }
    return build_number(field->kind, record_number(record, field));
}

static bool take_jsonl(const Layout *layout, const Record *record, void *file, Err *err)
{
    json_t *object = json_object();
    RecordField field;
    for (size_t i = 0; record_field(layout, i, &field); i++) {
        json_object_set_new(object, field.name, build_value(&field, record));
    }
    Text line;
    text_init(&line);
    json_value_write(object, LINE_FLAGS, &line);
    json_decref(object);
    fprintf(((const WholeFile *)file)->stream, "%s\n", line.data);
    text_finish(&line);
    return file_check(file, err);
}

static bool study_report_write_rows(Store *store, FileKind kind, const char *path, StoreTaker take,
                                    Err *err)
{
    WholeFile file;
    if (!file_begin(&file, kind, path, err)) {
        return false;
    }
    if (kind == FILE_TABLE) {
        study_report_write_line(file.stream, store_layout(store), NULL);
    }
    if (!store_each(store, take, &file, err)) {
        file_abandon(&file);
        return false;
    }
    return file_end(&file, err);
}

bool study_rows_write_csv(Store *store, const char *path, Err *err)
{
    return study_report_write_rows(store, FILE_TABLE, path, take_csv, err);
}

bool study_rows_write_jsonl(Store *store, const char *path, Err *err)
{
    return study_report_write_rows(store, FILE_ROWS, path, take_jsonl, err);
}
