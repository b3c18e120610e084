// The paper's slips: what it prints, what it must mean, and how one can tell.
#pragma once

#include <stddef.h>

// Where in the output a slip is named.
typedef enum TypoPlace {
    TYPO_TABLE_1,
    TYPO_TABLE_2,
    TYPO_TABLE_3,
    TYPO_TABLES_7_8,
    TYPO_MODEL, // of no one table
} TypoPlace;

typedef struct Typo {
    TypoPlace place;
    const char *where;    // in the paper
    const char *printed;  // what stands there
    const char *reading;  // what it is taken for
    const char *evidence; // why, and what follows
} Typo;

extern const Typo TYPOS[];
extern const size_t TYPOS_COUNT;
