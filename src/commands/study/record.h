// What a study keeps of a run: which columns there are, and one row of them.
#pragma once

#include <stddef.h>
#include <stdint.h>

enum {
    RECORD_NAME_SIZE = 192,
    RECORD_WORD_SIZE = 64,
    RECORD_REASON_SIZE = 256,
    RECORD_SETTING_MAX = 48,
    RECORD_RESULT_MAX = 256, // a linkage with all bodies and joints there may be has 210
};

typedef enum ColumnKind {
    COLUMN_REAL,  // a number, SI
    COLUMN_WHOLE, // a whole number
    COLUMN_WORD,  // of settings only
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
typedef enum Fate {
    FATE_OK,
    FATE_REFUSED,   // these values make no valid case
    FATE_FAILED,    // the solver gave up: a number that is not finite, a step too long
    FATE_ENDED,     // its process ended by a signal or by itself, without a result
    FATE_TIMED_OUT, // it took longer than its limit
    FATE_NO_MEMORY, // it wanted more than its limit
    FATE_COUNT,
} Fate;

// The word of each fate, as people and files see it.
extern const char *const FATE_WORDS[FATE_COUNT];

typedef union Cell {
    double number; // NAN where there is none
    char word[RECORD_WORD_SIZE];
} Cell;

// One run that is over. It holds no pointers, so that it can cross a pipe.
typedef struct Record {
    uint64_t run; // number in the study, from 0
    Fate fate;
    char reason[RECORD_REASON_SIZE]; // empty for FATE_OK
    Cell settings[RECORD_SETTING_MAX];
    double results[RECORD_RESULT_MAX]; // NAN where there is none
    uint64_t hash;                     // of the trajectory; 0 where there is none
    double wall_s; // that its process took, the one thing that is never twice the same
} Record;
