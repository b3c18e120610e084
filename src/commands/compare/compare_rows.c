// What is to be said of a point, in JSON, CSV and tables, and of the order of a scheme?
#include "commands/compare/compare_report.h"
#include "write/json_value.h"
#include "write/measured_fields.h"
#include "write/units.h"

#include <math.h>

static double step_of(const void *record)
{
    const LadderPoint *point = record;
    return point->step_s > 0.0 ? point->step_s : NAN;
}

static const char *heading_of(const void *record)
{
    const LadderPoint *point = record;
    return point->is_first ? point->name : "";
}

static const char *status_of(const void *record)
{
    return ((const LadderPoint *)record)->is_failed ? "failed" : "ok";
}

// The point where it did not fail.
static const void *if_done(const void *record)
{
    return ((const LadderPoint *)record)->is_failed ? NULL : record;
}

static double evaluations_of(const void *record)
{
    const size_t evaluations = ((const LadderPoint *)record)->run.evaluations;
    return evaluations > 0 ? (double)evaluations : NAN;
}

static double step_wall_of(const void *record)
{
    const LadderPoint *point = record;
    return point->wall_median_s / (double)point->run.steps;
}

static double us_per_step_of(const void *record)
{
    return step_wall_of(record) * UNITS_US;
}

static json_t *walls_of(const void *record)
{
    const LadderPoint *point = record;
    json_t *walls = json_array();
    for (size_t i = 0; i < LADDER_REPEAT_MAX; i++) {
        if (point->is_timed[i]) {
            json_array_append_new(walls, json_value_real(point->wall_s[i]));
        }
    }
    return walls;
}

static const char *marks_of(const void *record)
{
    const LadderPoint *point = record;
    if (point->is_failed) {
        return "failed";
    }
    return point->is_on_frontier
               ? (point->is_limited_by_truth ? "frontier, truth-limited" : "frontier")
               : (point->is_limited_by_truth ? "truth-limited" : "");
}

// the table of the cheapest points has some of the same columns
enum { CHEAPEST = FIELD_OWN, TABLES = FIELD_TABLE | CHEAPEST };

#define AT(member)    .offset = offsetof(LadderPoint, member)
#define ORDER(member) .offset = offsetof(Order, member)

// clang-format off
static const Field DONE_FIELDS[] = {
    {"steps", FIELD_COUNT, FIELD_ALL, "steps", "", AT(run.steps), .align = TABLE_MINOR},
    {"evaluations", FIELD_COUNT, FIELD_FILES, AT(run.evaluations)},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "evaluations", "", "%.0f", .align = TABLE_DETAIL,
     .number = evaluations_of},
    {"error_max", FIELD_NUMBER, FIELD_FILES | TABLES, "error", "1", "%.2e", AT(error)},
    {"limited_by_truth", FIELD_FLAG, FIELD_FILES, AT(is_limited_by_truth)},
    {"error", FIELD_GROUP, FIELD_JSON, AT(run.error), .of = ERROR_FIELDS},
    {NULL, FIELD_GROUP, FIELD_CSV, AT(run.error), .of = ERROR_FIELDS},
    {"wall_median_s", FIELD_NUMBER, FIELD_FILES | TABLES, "wall time", "ms", "%.4g",
     AT(wall_median_s)},
    {"wall_min_s", FIELD_NUMBER, FIELD_ALL, "least", "ms", "%.4g", AT(wall_min_s),
     .align = TABLE_DETAIL},
    {"wall_max_s", FIELD_NUMBER, FIELD_ALL, "most", "ms", "%.4g", AT(wall_max_s),
     .align = TABLE_DETAIL},
    {"wall_s", FIELD_VALUE, FIELD_JSON, .json = walls_of},
    {"us_per_step", FIELD_NUMBER, FIELD_JSON, .number = us_per_step_of},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "a step", "us", "%.3g", .align = TABLE_MINOR,
     .number = step_wall_of},
    {"on_frontier", FIELD_FLAG, FIELD_FILES, AT(is_on_frontier)},
    {"hash", FIELD_HASH, FIELD_JSON, AT(run.hash)},
    {0},
};

static const Field POINT_FIELDS[] = {
    {NULL, FIELD_LABEL, CHEAPEST, .title = "error at most"},
    {"scheme", FIELD_NAME, FIELD_CSV | CHEAPEST, "scheme", "", AT(name), .absent = "none of these"},
    {NULL, FIELD_NAME, FIELD_TABLE, "scheme", "", .word = heading_of},
    {"step_s", FIELD_NUMBER, FIELD_FILES | TABLES, "step", "us", "%.4g", .absent = "its own",
     .number = step_of},
    {"status", FIELD_NAME, FIELD_FILES, .word = status_of},
    {"message", FIELD_TEXT, FIELD_JSON, AT(reason)},
    {NULL, FIELD_PART, FIELD_FILES | TABLES, .of = DONE_FIELDS, .part = if_done},
    {NULL, FIELD_NAME, FIELD_TABLE, "", "", .word = marks_of},
    {"message", FIELD_TEXT, FIELD_CSV, AT(reason)},
    {0},
};

static const Field ORDER_FIELDS[] = {
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "scheme"},
    {"order", FIELD_NUMBER, FIELD_ALL, "order", "1", "%.2f", ORDER(order), .absent = "none"},
    {"from_step_s", FIELD_NUMBER, FIELD_ALL, "from step", "us", "%.4g", ORDER(from_s)},
    {"to_step_s", FIELD_NUMBER, FIELD_ALL, "to step", "us", "%.4g", ORDER(to_s)},
    {"points", FIELD_COUNT, FIELD_ALL, "points", "", ORDER(points)},
    {"spread", FIELD_NUMBER, FIELD_ALL, "spread", "1", "%.2f", ORDER(spread)},
    {0},
};
// clang-format on

json_t *compare_rows_point(const LadderPoint *point)
{
    return fields_json(POINT_FIELDS, FIELD_JSON, point);
}

bool compare_rows_write_csv(const void *report, const char *path, Err *err)
{
    const Ladder *ladder = ((const CompareReport *)report)->ladder;
    return fields_csv_write(POINT_FIELDS, FIELD_CSV, ladder->points, ladder->point_count,
                            sizeof *ladder->points, path, err);
}

void compare_rows_write_points(const Ladder *ladder, const Style *style, Text *text)
{
    Table *table = fields_table("Speed against error", POINT_FIELDS, FIELD_TABLE, style, text);
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->is_first && i > 0 && point[-1].step_s > 0.0) {
            table_rule(table);
        }
        fields_table_row(POINT_FIELDS, FIELD_TABLE, point, table);
    }
    section_end(table, text);
}

json_t *compare_rows_order(const Order *order)
{
    return order->is_known ? fields_json(ORDER_FIELDS, FIELD_JSON, order) : json_null();
}

void compare_rows_write_orders(const Ladder *ladder, const Style *style, Text *text)
{
    Table *table = fields_table("Order observed: the error falls as step^order", ORDER_FIELDS,
                                FIELD_TABLE, style, text);
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        const Order *order = &ladder->orders[i];
        if (scheme_has_step(&ladder->schemes[i])) {
            table_cell(table, "%s", ladder->schemes[i].name);
            fields_table_row(ORDER_FIELDS, FIELD_TABLE, order->is_known ? order : NULL, table);
        }
    }
    section_end(table, text);
}

// The cheapest point for a target, or NULL.
static const LadderPoint *cheapest_point(const Ladder *ladder, size_t target)
{
    const size_t point = ladder->cheapest[target];
    return point < ladder->point_count ? &ladder->points[point] : NULL;
}

json_t *compare_rows_cheapest(const Ladder *ladder, size_t target)
{
    const LadderPoint *point = cheapest_point(ladder, target);
    json_t *object = json_pack("{s:f, s:n}", "error_at_most", LADDER_TARGETS[target], "scheme");
    if (point != NULL) {
        fields_json_set(POINT_FIELDS, CHEAPEST, point, object);
    }
    return object;
}

void compare_rows_write_cheapest(const Ladder *ladder, const Style *style, Text *text)
{
    Table *table = fields_table("Cheapest setting of ODE", POINT_FIELDS, CHEAPEST, style, text);
    for (size_t i = 0; i < LADDER_TARGET_COUNT; i++) {
        table_cell(table, "%.0e", LADDER_TARGETS[i]);
        fields_table_row(POINT_FIELDS, CHEAPEST, cheapest_point(ladder, i), table);
    }
    section_end(table, text);
}
