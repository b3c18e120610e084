// `outcome:` in the `expect:` of a case: how each of its runs ends.
#pragma once

#include "casefile/document.h"
#include "model/expectation.h"

// The ways to write an outcome, in one line; and the words of the kinds, as results have them.
extern const char EXPECT_OUTCOME_FORMS[];
extern const char *const EXPECT_OUTCOME_WORDS[OUTCOME_KIND_COUNT];

// Whether a value of `expect:` is an outcome: its path is `outcome` or ends in `.outcome`.
bool expect_outcome_is(const Node *node);

// Reads one. Fails where its path names neither a backend nor a way to use ODE, and where its value
// is none of EXPECT_OUTCOME_FORMS. Whether the case has such a scheme is not asked here.
bool expect_outcome_read(const Source *source, const Node *node, ExpectedOutcome *outcome,
                         Err *err);
