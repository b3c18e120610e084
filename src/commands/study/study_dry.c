// What would a study run?
#include "cli/output.h"
#include "commands/study/study_commands.h"
#include "commands/study/study_text.h"
#include "write/table.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    SHOWN_RUNS = 6,      // enough to see what changes fastest
    TRIED_RUNS = 200,    // over the whole study; a second's work
    STORE_BYTES = 30000, // of a store without rows
    NUMBER_BYTES = 8,    // of a real number in SQLite, besides a byte for its type
    ROW_BYTES = 70,      // of a row besides its cells: keys, hash, checksum, wall time, page ends
};

// The i-th of `count` runs spread over the whole shard.
static uint64_t spread(const StudyOptions *options, const Spec *spec, uint64_t i, uint64_t count)
{
    const double end = (double)design_run_count(spec);
    const uint64_t from = (uint64_t)floor((double)i * end / (double)count);
    return design_next(spec, options->shard, from);
}

static void append_cell(Table *table, const Column *column, const Cell *cell)
{
    if (column->kind == COLUMN_WORD) {
        table_cell(table, "%s", cell->word);
    } else {
        table_cell(table, "%.5g", cell->number);
    }
}

static void append_runs(const StudyOptions *options, const Spec *spec, const Layout *layout,
                        size_t width, Text *text)
{
    Table *table = table_create(layout->setting_count + 1);
    table_fit(table, width);
    table_head(table, 0, "run", "", TABLE_RIGHT);
    for (size_t i = 0; i < layout->setting_count; i++) {
        const bool is_word = layout->settings[i].kind == COLUMN_WORD;
        table_head(table, i + 1, layout->settings[i].name, "", is_word ? TABLE_LEFT : TABLE_RIGHT);
    }
    const uint64_t end = design_run_count(spec);
    uint64_t run = design_next(spec, options->shard, 0);
    for (int shown = 0; shown < SHOWN_RUNS && run < end; shown++) {
        Cell values[RECORD_SETTING_MAX];
        design_values(spec, run, values);
        table_cell(table, "%" PRIu64, run);
        for (size_t i = 0; i < layout->setting_count; i++) {
            append_cell(table, &layout->settings[i], &values[i]);
        }
        run = design_next(spec, options->shard, run + 1);
    }
    table_write(table, text);
    table_destroy(table);
}

// Tries whether values over the whole study make valid cases.
static void append_trials(const StudyOptions *options, const Spec *spec, Text *text)
{
    const uint64_t end = design_run_count(spec);
    const uint64_t count = end < TRIED_RUNS ? end : TRIED_RUNS;
    uint64_t tried = 0;
    uint64_t refused = 0;
    uint64_t first = 0;
    Err reason = {0};
    for (uint64_t i = 0; i < count; i++) {
        Cell values[RECORD_SETTING_MAX];
        BackendKind backend;
        Err err = {0};
        const uint64_t run = spread(options, spec, i, count);
        if (run >= end) {
            break;
        }
        tried++;
        design_values(spec, run, values);
        Scenario scenario = {.point_count = 0};
        if (!design_scenario(spec, values, &scenario, &backend, &err)) {
            reason = refused == 0 ? err : reason;
            first = refused++ == 0 ? run : first;
        }
        scenario_free(&scenario);
    }
    text_append(text, "Runs tried over all of it: %" PRIu64 "; of them no valid case: %" PRIu64,
                tried, refused);
    text_append(text, refused > 0 ? "; the first is run %" PRIu64 ": %s\n" : ".\n", first,
                reason.text);
}

// A setting that is a word or a few digits takes less than a number with all of its own.
static double store_bytes(const Layout *layout, uint64_t runs)
{
    const double cells = (double)(layout->setting_count + layout->result_count);
    return STORE_BYTES + (double)runs * (ROW_BYTES + cells * (NUMBER_BYTES + 1));
}

bool study_run_dry(const StudyOptions *options, const Spec *spec, const Layout *layout, Err *err)
{
    (void)err;
    const Style style = output_style(stdout, options->common.is_wide);
    const uint64_t end = design_run_count(spec);
    const uint64_t runs = design_shard_count(spec, options->shard);
    Text text;
    text_init(&text);
    text_append(&text, "%s%s%s\n\n", style.heading, spec->title, style.end);
    text_append(&text, "Case ");
    text_append_shown(&text, spec->case_path);
    text_append(&text, ", %zu variables, %" PRIu64 " runs", spec->variable_count, end);
    if (options->shard.count > 1) {
        text_append(&text, ", %" PRIu64 " of them in part %" PRIu64 " of %" PRIu64, runs,
                    options->shard.index + 1, options->shard.count);
    }
    if (spec->has_truth) {
        text_append(&text, ", %" PRIu64 " truths", design_group(spec, end - 1) + 1);
    }
    text_append(&text, ".\nThe store ");
    text_append_shown(&text, options->store);
    text_append(&text, " would take some %.2g MB.\n", 1e-6 * store_bytes(layout, runs));
    append_trials(options, spec, &text);
    text_append(&text, "\n%sFirst runs%s\n", style.heading, style.end);
    append_runs(options, spec, layout, style.width, &text);
    output_text(&text, &style);
    text_finish(&text);
    return true;
}
