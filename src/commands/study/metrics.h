// What a study keeps of a trajectory, by name.
#pragma once

#include "commands/study/spec.h"
#include "measure/error.h"
#include "measure/truth.h"

// The columns of a study: its variables and what is measured of the linkage of its case.
void metrics_layout(const Spec *spec, const Scenario *scenario, Layout *layout);

// Whether a row has room for all results of a linkage; else ERR_CASE.
bool metrics_fit(const Scenario *scenario, Err *err);

// The results of a complete run, in the order of metrics_layout. Without a truth (NULL) there is
// no error. Returns false where error_fail_unstable makes it one that failed.
bool metrics_take(const Layout *layout, const Scenario *scenario, Trajectory *trajectory,
                  const Truth *truth, double results[RECORD_RESULT_MAX]);

// What a column of the results is, for the axis of a picture, and its key, with the unit; of a
// number of a body or joint how many letters its name takes in front of the key, else 0. False
// where the column is no result.
bool metrics_title(const char *column, const char **title, const char **key, size_t *owner_length);

// Whether the end of a study shows that column of the results without being asked for all.
bool metrics_is_main(const char *column);

// Appends what each result is, for people: a line or more each, or the rows of a Markdown table.
void metrics_describe(bool is_markdown, Text *text);
