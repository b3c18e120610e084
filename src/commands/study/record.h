// What a study keeps of a run: which columns there are, and one row of them.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    RECORD_NAME_SIZE = 192,
    RECORD_WORD_SIZE = 64,
    RECORD_REASON_SIZE = 256,
    RECORD_SETTING_MAX = 48,
    RECORD_RESULT_MAX = 1200, // some 35 bodies and as many joints with play
};

typedef enum ColumnKind {
    COLUMN_REAL,  // a number, SI
    COLUMN_WHOLE, // a whole number
    COLUMN_WORD,  // of settings only
    // of the columns that every study has
    COLUMN_RUN,
    COLUMN_FATE,
    COLUMN_REASON,
    COLUMN_HASH,
} ColumnKind;

typedef struct Column {
    char name[RECORD_NAME_SIZE]; // letters, digits and _, with its unit: follower_omega_max_rad_s
    ColumnKind kind;
} Column;

typedef struct Layout {
    size_t setting_count; // what the study varies
    Column settings[RECORD_SETTING_MAX];
    size_t result_count;
    Column results[RECORD_RESULT_MAX];
} Layout;

// What became of a run. Stores hold the number: members are only ever added at the end.
typedef enum RunOutcome {
    RUN_OUTCOME_OK,
    RUN_OUTCOME_REFUSED,   // these values make no valid case
    RUN_OUTCOME_FAILED,    // the solver gave up: a number that is not finite, a step too long
    RUN_OUTCOME_ENDED,     // its process ended by a signal or by itself, without a result
    RUN_OUTCOME_TIMED_OUT, // it took longer than its limit
    RUN_OUTCOME_NO_MEMORY, // it needed more than its limit
    RUN_OUTCOME_COUNT,
} RunOutcome;

// The word of each, as people and files see it.
extern const char *const RUN_OUTCOME_WORDS[RUN_OUTCOME_COUNT];

typedef union Cell {
    double number; // NAN where there is none
    char word[RECORD_WORD_SIZE];
} Cell;

// One run that is over. It holds no pointers, so that it can cross a pipe.
typedef struct Record {
    uint64_t run; // number in the study, from 0
    RunOutcome outcome;
    char reason[RECORD_REASON_SIZE]; // empty for RUN_OUTCOME_OK
    Cell settings[RECORD_SETTING_MAX];
    double results[RECORD_RESULT_MAX]; // NAN where there is none
    uint64_t hash;                     // of the trajectory; 0 where there is none
    double wall_s; // that its process took, the only column that differs from run to run
} Record;

// One column of the rows and where a record holds its value: a double of COLUMN_REAL and
// COLUMN_WHOLE, text of COLUMN_WORD and COLUMN_REASON.
typedef struct RecordField {
    const char *name;
    ColumnKind kind;
    size_t offset;
} RecordField;

// The field of a number in the order of the store and of all files: run, the settings, outcome,
// reason, the results, hash, wall_s. False behind the last.
bool record_field(const Layout *layout, size_t number, RecordField *field);

// Where a record holds the value of a field, and the value of one that holds a number or text.
static inline void *record_target(Record *record, const RecordField *field)
{
    return (char *)record + field->offset;
}

static inline double record_number(const Record *record, const RecordField *field)
{
    return *(const double *)((const char *)record + field->offset);
}

static inline const char *record_text(const Record *record, const RecordField *field)
{
    return (const char *)record + field->offset;
}
