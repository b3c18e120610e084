// `expect:` of a case: limits for the numbers of its own runs.
#pragma once

#include "casefile/entries.h"

// What kind of thing a number belongs to: the first word of its path.
typedef enum ExpectGroup {
    EXPECT_BODIES,
    EXPECT_JOINTS,
    EXPECT_ERROR,
    EXPECT_ENERGY,
    EXPECT_COST,
    EXPECT_GROUP_COUNT,
} ExpectGroup;

// A number that can be limited.
typedef struct ExpectRow {
    ExpectGroup group;
    const char *name; // the last word of its path
    ExpectedNumber number;
    Dimension dimension;
    bool is_count;   // a whole number
    bool needs_play; // of a joint
    const char *doc;
} ExpectRow;

extern const char *const EXPECT_GROUPS[EXPECT_GROUP_COUNT];
extern const ExpectRow EXPECT_ROWS[EXPECTED_NUMBER_COUNT]; // by number

// The ways to write a limit, in one line.
extern const char EXPECT_FORMS[];

// Reads the mapping of an entry into the scenario, whose bodies and joints have their names. Fails
// on a path that names no number of this case, and on a limit that cannot be understood.
bool expect_store(const Entries *entries, const Entry *entry, Scenario *scenario, Err *err);
