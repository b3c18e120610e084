// Everything there is to say about a comparison, and the forms in which it is said.
#pragma once

#include "measure/ladder.h"
#include "write/fields.h"

typedef struct CompareReport {
    const Scenario *scenario;
    const Ladder *ladder; // concluded
    const char *machine;  // the processor that the times are of
} CompareReport;

// Whether the errors contain more than ODE's own: the reference knows contact by its elastic law
// alone.
static inline bool compare_report_mixes_models(const CompareReport *report)
{
    return report->scenario->contact.model == CONTACT_POISSON &&
           scenario_has_clearance(report->scenario);
}

// New references: a point, the order of a scheme, the cheapest point of a target.
json_t *compare_rows_point(const LadderPoint *point);
json_t *compare_rows_order(const Order *order);
json_t *compare_rows_cheapest(const Ladder *ladder, size_t target);

// The same as tables.
void compare_rows_write_points(const Ladder *ladder, const Style *style, Text *text);
void compare_rows_write_orders(const Ladder *ladder, const Style *style, Text *text);
void compare_rows_write_cheapest(const Ladder *ladder, const Style *style, Text *text);

// The forms, each of a CompareReport. The CSV is a file of its own, a row a point, with its reason
// and no numbers where it failed: ERR_FILE.
void compare_text_write(const void *report, const Style *style, Text *text);
bool compare_rows_write_csv(const void *report, const char *path, Err *err);
void compare_plot_write(const void *report, Text *svg);
json_t *compare_json_build(const void *report);

// The distributions of an ensemble, one row a scheme and joint; nothing where there is none.
void compare_spread_write(const CompareReport *report, const Style *style, Text *text);
