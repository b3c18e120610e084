// How are the results of a study distributed?
#include "commands/study/study_columns.h"
#include "commands/study/study_text.h"
#include "write/section.h"

#include <inttypes.h>
#include <stdio.h>

enum { GROUP_MAX = 16, HEAD_MAX = 8 };

// The runs of one value of a column, or all.
typedef struct Groups {
    size_t by; // column; used only where `values` are
    bool is_by;
    size_t count; // at least 1
    Cell values[GROUP_MAX];
} Groups;

static bool spread_row(Store *store, Table *table, const Groups *groups, size_t result,
                       size_t group, Err *err)
{
    const Layout *layout = store_layout(store);
    StoreSpread spread;
    if (!store_spread(store, layout->setting_count + result, groups->by,
                      groups->is_by ? &groups->values[group] : NULL, &spread, err)) {
        return false;
    }
    table_cell(table, "%s", group == 0 ? layout->results[result].name : "");
    if (groups->is_by) {
        char words[RECORD_WORD_SIZE];
        study_columns_word(layout, groups->by, &groups->values[group], words);
        table_cell(table, "%s", words);
    }
    table_cell(table, "%" PRIu64, spread.count);
    const double values[] = {spread.least, spread.low, spread.median, spread.high, spread.most};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        section_number_or_dash(table, spread.count > 0, values[i]);
    }
    return true;
}

bool study_text_summary(Store *store, const char *by, const Style *style, Text *text, Err *err)
{
    static const SectionHead TAIL[] = {{"runs", "", TABLE_RIGHT}, {"least", "", TABLE_RIGHT},
                                       {"5 %", "", TABLE_RIGHT},  {"median", "", TABLE_RIGHT},
                                       {"95 %", "", TABLE_RIGHT}, {"most", "", TABLE_RIGHT}};
    enum { TAIL_COUNT = sizeof TAIL / sizeof *TAIL };
    const Layout *layout = store_layout(store);
    Groups groups = {.is_by = by != NULL};
    if (!study_columns_groups(store, by, GROUP_MAX, &groups.by, groups.values, &groups.count,
                              err)) {
        return false;
    }
    SectionHead heads[HEAD_MAX] = {{"result", "", TABLE_LEFT}};
    size_t head_count = 1;
    if (groups.is_by) {
        heads[head_count++] = (SectionHead){by, "", TABLE_LEFT};
    }
    for (size_t i = 0; i < TAIL_COUNT; i++) {
        heads[head_count++] = TAIL[i];
    }
    Text section;
    text_init(&section);
    Table *table =
        section_begin("Results of the runs that went well", head_count, heads, style, &section);
    bool is_read = true;
    for (size_t result = 0; result < layout->result_count && is_read; result++) {
        for (size_t group = 0; group < groups.count && is_read; group++) {
            is_read = spread_row(store, table, &groups, result, group, err);
        }
    }
    if (is_read) {
        section_end(table, &section);
        text_append(text, "%s", section.data);
    } else {
        table_destroy(table);
    }
    text_finish(&section);
    return is_read;
}
