// The columns of a study, as people name them.
#pragma once

#include "commands/study/store.h"

typedef enum StudyColumns {
    STUDY_NUMBER,  // of settings or results, not of words
    STUDY_SETTING, // of settings alone
} StudyColumns;

// Finds a column by name. Fails with ERR_USAGE, naming the one that may have been meant.
bool study_columns_find(const Layout *layout, const char *name, StudyColumns wanted, size_t *column,
                        Err *err);

// The values of a column of settings, of which there may be no more than `most`; NULL: there is one
// group, of all runs. Fails with ERR_FILE or ERR_USAGE.
bool study_columns_groups(Store *store, const char *by, size_t most, size_t *column, Cell *values,
                          size_t *count, Err *err);

// A value of a column in words.
void study_columns_word(const Layout *layout, size_t column, const Cell *value,
                        char words[RECORD_WORD_SIZE]);
