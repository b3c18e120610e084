// A limit in words: "below 1.2 kN", "within 2 % of 950 N".
#pragma once

#include "casefile/quantity.h"
#include "model/expectation.h"

// What kind of thing a number belongs to: the first word of its path.
typedef enum ExpectGroup {
    EXPECT_BODIES,
    EXPECT_JOINTS,
    EXPECT_ERROR,
    EXPECT_ENERGY,
    EXPECT_SECTION,
    EXPECT_SETTLED,        // of the case, not of a run
    EXPECT_SETTLED_JOINTS, // likewise; two words
    EXPECT_COST,
    EXPECT_GROUP_COUNT,
} ExpectGroup;

// Whether its paths have the name of a body or joint.
static inline bool expect_has_member(ExpectGroup group)
{
    return group == EXPECT_BODIES || group == EXPECT_JOINTS || group == EXPECT_SETTLED_JOINTS;
}

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

// The ways to write a limit, in one line.
extern const char EXPECT_FORMS[];

// Reads a limit of a number into low, high, is_open, words, unit and unit_si. On failure the
// complaint says why, and *start and *length which bytes of the text are wrong.
bool expect_limit_read(const char *text, const ExpectRow *row, Expectation *expectation,
                       Complaint *complaint, size_t *start, size_t *length);
