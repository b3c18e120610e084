// Which column of a study is meant?
#include "commands/study/study_columns.h"

#include "base/text.h"

#include <stdio.h>

bool study_columns_find(const Layout *layout, const char *name, StudyColumns wanted, size_t *column,
                        Err *err)
{
    const char *names[RECORD_SETTING_MAX + RECORD_RESULT_MAX];
    const size_t all = layout->setting_count + layout->result_count;
    const size_t count = wanted == STUDY_SETTING ? layout->setting_count : all;
    for (size_t i = 0; i < count; i++) {
        names[i] = store_column_at(layout, i)->name;
    }
    *column = store_column(layout, name);
    if (*column >= count) {
        const char *nearest = text_nearest(name, names, count);
        return err_set(err, ERR_USAGE, "the study has no %s '%s'%s%s%s",
                       wanted == STUDY_SETTING ? "setting" : "column", name,
                       nearest == NULL ? "" : "; did you mean '", nearest == NULL ? "" : nearest,
                       nearest == NULL ? "" : "'?");
    }
    return wanted == STUDY_SETTING || store_column_at(layout, *column)->kind != COLUMN_WORD ||
           err_set(err, ERR_USAGE, "the column %s holds words, and numbers are wanted", name);
}

bool study_columns_groups(Store *store, const char *by, size_t most, size_t *column, Cell *values,
                          size_t *count, Err *err)
{
    *count = 1;
    if (by == NULL) {
        return true;
    }
    return study_columns_find(store_layout(store), by, STUDY_SETTING, column, err) &&
           store_values(store, *column, most, values, count, err) &&
           (*count <= most ||
            err_set(err, ERR_USAGE, "%s has more than %zu values, too many to tell apart", by,
                    most));
}

void study_columns_word(const Layout *layout, size_t column, const Cell *value,
                        char words[RECORD_WORD_SIZE])
{
    if (store_column_at(layout, column)->kind == COLUMN_WORD) {
        text_copy(words, RECORD_WORD_SIZE, value->word);
    } else {
        snprintf(words, RECORD_WORD_SIZE, "%.4g", value->number);
    }
}
