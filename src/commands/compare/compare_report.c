// Reports a comparison as text, CSV and JSON.
#include "commands/compare/compare.h"
#include "write/json_value.h"
#include "write/measured_fields.h"
#include "write/settings_json.h"
#include "write/settled.h"
#include "write/table.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// A point in JSON, CSV and tables, and the order of a scheme.

static double compare_report_step_of(const void *record)
{
    const LadderPoint *point = record;
    return point->step_s > 0.0 ? point->step_s : NAN;
}

static const char *heading_of(const void *record)
{
    const LadderPoint *point = record;
    return point->is_first ? point->name : "";
}

static const char *compare_report_status_of(const void *record)
{
    const LadderPoint *point = record;
    return point->is_left_out ? "left out" : point->is_failed ? "failed" : "ok";
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

static double compare_report_step_wall_of(const void *record)
{
    const LadderPoint *point = record;
    return point->wall_median_s / (double)point->run.steps;
}

static double compare_report_us_per_step_of(const void *record)
{
    return compare_report_step_wall_of(record) * UNITS_US;
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
        return compare_report_status_of(point);
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
    {"us_per_step", FIELD_NUMBER, FIELD_JSON, .number = compare_report_us_per_step_of},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "a step", "us", "%.3g", .align = TABLE_MINOR,
     .number = compare_report_step_wall_of},
    {"on_frontier", FIELD_FLAG, FIELD_FILES, AT(is_on_frontier)},
    {"hash", FIELD_HASH, FIELD_JSON, AT(run.hash)},
    {0},
};

static const Field POINT_FIELDS[] = {
    {NULL, FIELD_LABEL, CHEAPEST, .title = "error at most"},
    {"scheme", FIELD_NAME, FIELD_CSV | CHEAPEST, "scheme", "", AT(name), .absent = "none of these"},
    {NULL, FIELD_NAME, FIELD_TABLE, "scheme", "", .word = heading_of},
    {"step_s", FIELD_NUMBER, FIELD_FILES | TABLES, "step", "us", "%.4g", .absent = "its own",
     .number = compare_report_step_of},
    {"status", FIELD_NAME, FIELD_FILES, .word = compare_report_status_of},
    {"message", FIELD_TEXT, FIELD_JSON, AT(reason)},
    {NULL, FIELD_PART, FIELD_FILES | TABLES, .of = DONE_FIELDS, .part = if_done},
    {NULL, FIELD_NAME, FIELD_TABLE, "", "", .word = marks_of},
    {"message", FIELD_TEXT, FIELD_CSV, AT(reason)},
    {0},
};
#undef AT

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

static json_t *compare_rows_point(const LadderPoint *point)
{
    return fields_json(POINT_FIELDS, FIELD_JSON, point);
}

bool compare_rows_write_csv(const void *report, const char *path, Err *err)
{
    const Ladder *ladder = ((const CompareReport *)report)->ladder;
    return fields_csv_write(POINT_FIELDS, FIELD_CSV, ladder->points, ladder->point_count,
                            sizeof *ladder->points, path, err);
}

static void compare_rows_write_points(const Ladder *ladder, const Style *style, Text *text)
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

static json_t *compare_rows_order(const Order *order)
{
    return order->is_known ? fields_json(ORDER_FIELDS, FIELD_JSON, order) : json_null();
}

static void compare_rows_write_orders(const Ladder *ladder, const Style *style, Text *text)
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

// New references: a point, the order of a scheme, the cheapest point of a target.
static json_t *compare_rows_cheapest(const Ladder *ladder, size_t target)
{
    const LadderPoint *point = cheapest_point(ladder, target);
    json_t *object = json_pack("{s:f, s:n}", "error_at_most", LADDER_TARGETS[target], "scheme");
    if (point != NULL) {
        fields_json_set(POINT_FIELDS, CHEAPEST, point, object);
    }
    return object;
}

// The same as tables.
static void compare_rows_write_cheapest(const Ladder *ladder, const Style *style, Text *text)
{
    const char *title =
        compare_engines_are_any(ladder) ? "Cheapest setting" : "Cheapest setting of ODE";
    Table *table = fields_table(title, POINT_FIELDS, CHEAPEST, style, text);
    for (size_t i = 0; i < LADDER_TARGET_COUNT; i++) {
        table_cell(table, "%.0e", LADDER_TARGETS[i]);
        fields_table_row(POINT_FIELDS, CHEAPEST, cheapest_point(ladder, i), table);
    }
    section_end(table, text);
}

// Runs beyond the time up to which the motion can be predicted.
//
// Beyond the horizon two starts that differ by nothing measurable part. What stays are
// distributions over many starts, and whether a scheme's agree with the reference's.

static const EnsembleMetric COLUMNS[] = {
    ENSEMBLE_IMPACTS,         ENSEMBLE_FORCE_MAX,     ENSEMBLE_IMPULSE,
    ENSEMBLE_PENETRATION_MAX, ENSEMBLE_CONTACT_SHARE,
};
enum { COLUMN_COUNT = sizeof COLUMNS / sizeof COLUMNS[0] };

static void compare_report_spread_row(Table *table, const CompareReport *report, size_t scheme,
                                      size_t joint)
{
    const LadderEnsemble *ensemble = &report->ladder->ensembles[scheme];
    const Field *metrics = measured_metric_fields(&report->scenario->linkage.joints[joint]);
    table_cell(table, "%s", report->ladder->schemes[scheme].name);
    table_cell(table, ensemble->step_s > 0.0 ? "%.4g" : "its own", ensemble->step_s * UNITS_US);
    for (int i = 0; i < COLUMN_COUNT; i++) {
        const Distribution *d = &ensemble->ensemble.joints[joint][COLUMNS[i]];
        if (ensemble->ensemble.members == 0) {
            table_cell(table, "failed");
        } else {
            const double scale = units_per_si(metrics[COLUMNS[i]].unit);
            table_cell(table, "%.4g [%.4g, %.4g]", d->median * scale, d->low * scale,
                       d->high * scale);
        }
    }
}

static void compare_spread_write_failures(const CompareReport *report, const Style *style,
                                          Text *text)
{
    for (size_t i = 0; i < report->ladder->scheme_count; i++) {
        const Ensemble *ensemble = &report->ladder->ensembles[i].ensemble;
        if (ensemble->failed > 0) {
            text_append(text, "\n  %s%s: %zu of the ensemble's runs failed: %s%s\n", style->failure,
                        report->ladder->schemes[i].name, ensemble->failed, ensemble->message,
                        style->end);
        }
    }
}

// One joint with play: the motion's spread by every scheme that has one.
static void compare_report_write_joint(const CompareReport *report, size_t joint,
                                       const Style *style, Text *text)
{
    const Field *metrics = measured_metric_fields(&report->scenario->linkage.joints[joint]);
    Table *table = table_create(2 + COLUMN_COUNT);
    table_fit(table, style->width);
    table_head(table, 0, "scheme", "", TABLE_LEFT);
    table_head(table, 1, "step", "us", TABLE_RIGHT);
    for (int i = 0; i < COLUMN_COUNT; i++) {
        const Field *metric = &metrics[COLUMNS[i]];
        table_head(table, (size_t)(2 + i), metric->title, metric->unit, TABLE_RIGHT);
    }
    for (size_t i = 0; i < report->ladder->scheme_count; i++) {
        if (report->ladder->ensembles[i].is_known) {
            compare_report_spread_row(table, report, i, joint);
        }
    }
    text_append(text, "\n  %s\n\n", report->scenario->linkage.joints[joint].name);
    table_write(table, text);
    table_destroy(table);
}

// The distributions of an ensemble, one row a scheme and joint; nothing where there is none.
static void compare_spread_write(const CompareReport *report, const Style *style, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    if (!report->ladder->truth.is_limited) {
        return;
    }
    text_append(
        text,
        "\n%sThe whole run from %d starts, their speeds a little apart: median [least, most]%s\n",
        style->heading, ENSEMBLE_MEMBERS, style->end);
    for (size_t joint = 0; joint < ensemble_joint_count(linkage); joint++) {
        if (linkage_has_play(&linkage->joints[joint])) {
            compare_report_write_joint(report, joint, style, text);
        }
    }
    compare_spread_write_failures(report, style, text);
}

// The text.

// What a finer ladder would cost.
// The number of schemes that ended before the finest step; adds their names and last steps to a
// list, where there is one.
static size_t count_ended(const Ladder *ladder, Text *list)
{
    size_t count = 0;
    for (size_t i = 1; i < ladder->point_count; i++) {
        const LadderPoint *last = &ladder->points[i - 1];
        if (!ladder->points[i].is_left_out || last->is_left_out) {
            continue;
        }
        if (list != NULL) {
            text_append(list, "%s%s at %.4g us", count > 0 ? ", " : "", last->name,
                        last->step_s * UNITS_US);
        }
        count++;
    }
    return count;
}

// Which schemes ended before the finest step.
static void write_ended(const Ladder *ladder, Text *text)
{
    Text words;
    text_init(&words);
    text_append(&words, "  Not run at finer steps, at which they could not be cheapest: ");
    if (count_ended(ladder, &words) > 0) {
        text_append(&words, ".");
        screen_line(&words, text);
    } else {
        text_finish(&words);
    }
}

static void compare_report_left(const CompareReport *report, Text *text)
{
    if (report->left.finest_s > 0.0) {
        text_append(text, "  --steps all: steps down to %.4g us, %.2g times as many world steps\n",
                    report->left.finest_s * UNITS_US, report->left.ratio);
    }
}

static void compare_report_write_head(const CompareReport *report, const Style *style, Text *text)
{
    const Scenario *scenario = report->scenario;
    const Ladder *ladder = report->ladder;
    const LadderTruth *truth = &ladder->truth;
    section_title(scenario->title, scenario_path(scenario), style, text);
    settled_text(scenario, text);
    if (truth->message[0] != '\0') {
        text_append(text, "  truth       %s, made in %.3g s; could not be certified: %s\n",
                    truth->backend, truth->wall_s, truth->message);
    } else {
        text_append(text, "  truth       %s, to %.2g; made and certified in %.3g s\n",
                    truth->backend, truth->uncertainty, truth->wall_s);
    }
    if (truth->is_limited && truth->message[0] == '\0') {
        text_append(
            text,
            "  horizon     %.4g ms of %.4g ms: beyond it no trajectory can be predicted, and "
            "errors are those up to it (a perturbation of 1e-10 has grown "
            "%.2g times by then)\n",
            truth->horizon_s * UNITS_MS, scenario_duration(scenario) * UNITS_MS, truth->growth);
    }
    if (compare_report_mixes_models(report)) {
        text_append(text, "  contact     the reference has the elastic law, ODE the POISSON model: "
                          "errors contain the difference of the two models\n");
    }
    compare_engines_write(ladder, text);
    text_append(text, "  times       median of %s%zu runs, taken in turn, on %s\n",
                ladder->is_whole ? "" : "up to ", ladder->repeats, report->machine);
}

// Why there is no error for points that did not fail: once where neighbours have the same reason.
static void write_without_error(const Ladder *ladder, Text *text)
{
    const char *last = "";
    size_t last_scheme = ladder->scheme_count;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        const bool is_reported = point->scheme == last_scheme && strcmp(point->reason, last) == 0;
        if (!point->is_failed && point->reason[0] != '\0' && !is_reported) {
            text_append(text, "\n  %s %s\n", point->name, point->reason);
        }
        last = point->is_failed ? "" : point->reason;
        last_scheme = point->scheme;
    }
}

// Why points failed.
static void compare_text_write_failures(const CompareReport *report, const Style *style, Text *text)
{
    const Ladder *ladder = report->ladder;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->is_failed && !point->is_left_out) {
            text_append(text, "\n  %s%s", style->failure, point->name);
            if (point->step_s > 0.0) {
                text_append(text, ", %.4g us", point->step_s * UNITS_US);
            }
            text_append(text, " failed: %s%s\n", point->reason, style->end);
        }
    }
}

// What the solvers that choose their own steps take, for the eye to hold beside it.
static void write_others(const Ladder *ladder, Text *text)
{
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        const Scheme *scheme = &ladder->schemes[point->scheme];
        const bool is_beside = scheme->backend != BACKEND_ODE && scheme->driver == NULL;
        if (is_beside && !point->is_failed && isfinite(point->wall_median_s)) {
            text_append(text, "  For comparison: %s, ", point->name);
            text_append(text, isfinite(point->error) ? "error %.1e" : "without an error",
                        point->error);
            text_append(text, " in %.4g ms\n", point->wall_median_s * UNITS_MS);
        }
    }
}

void compare_text_write(const void *of, const Style *style, Text *text)
{
    const CompareReport *report = of;
    compare_report_write_head(report, style, text);
    compare_rows_write_points(report->ladder, style, text);
    text_append(text,
                "  frontier: every faster point has an error at least a hundredth larger.\n"
                "  truth-limited: the error is below ten times the truth's uncertainty, which "
                "dominates it.\n");
    compare_text_write_failures(report, style, text);
    write_without_error(report->ladder, text);
    compare_rows_write_orders(report->ladder, style, text);
    text_append(text, "  none: the error does not fall alike over any three steps in a row, or the "
                      "scheme ended.\n");
    compare_rows_write_cheapest(report->ladder, style, text);
    if (compare_engines_are_any(report->ladder)) {
        compare_engines_write_ways(report->ladder, style, text);
    }
    write_others(report->ladder, text);
    write_ended(report->ladder, text);
    compare_report_left(report, text);
    compare_spread_write(report, style, text);
}

// The first screen.

// The order of each scheme that has one, in a sentence, and how many points failed.
static void compare_screen_orders(const Ladder *ladder, Text *text)
{
    Text words;
    text_init(&words);
    size_t count = 0;
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        if (scheme_has_step(&ladder->schemes[i]) && ladder->orders[i].is_known) {
            text_append(&words, "%s%s %.2g",
                        count++ > 0 ? ", " : "  Order of the error in the step: ",
                        ladder->schemes[i].name, ladder->orders[i].order);
        }
    }
    if (count > 0) {
        text_append(&words, "; the others show none.");
    } else {
        text_append(&words, "  No scheme's error has an order: none falls alike over three steps "
                            "in a row.");
    }
    screen_line(&words, text);
    size_t failed = 0;
    for (size_t i = 0; i < ladder->point_count; i++) {
        failed += ladder->points[i].is_failed && !ladder->points[i].is_left_out ? 1 : 0;
    }
    if (failed > 0) {
        text_append(text, "  %zu of %zu settings failed: --full says why.\n", failed,
                    ladder->point_count);
    }
}

void compare_screen_write(const void *of, const Style *style, Text *text)
{
    const CompareReport *report = of;
    const Scenario *scenario = report->scenario;
    section_title(scenario->title, scenario_path(scenario), style, text);
    if (compare_engines_are_any(report->ladder)) {
        compare_engines_write_times(report->ladder, style, text);
    } else {
        compare_rows_write_cheapest(report->ladder, style, text);
    }
    write_others(report->ladder, text);
    compare_screen_orders(report->ladder, text);
    screen_truth(&report->ladder->truth, text);
    settled_lines(scenario, text);
    const size_t ended = count_ended(report->ladder, NULL);
    if (ended > 0) {
        text_append(text,
                    "  %zu scheme%s not run at finer steps, at which %s could not be cheapest.\n",
                    ended, ended > 1 ? "s were" : " was", ended > 1 ? "they" : "it");
    }
    compare_report_left(report, text);
    text_append(text, "  --full: every scheme at every step%s\n",
                compare_engines_are_any(report->ladder) ? ", and the way and step of these times"
                                                        : "");
}

// The JSON.

static json_t *compare_report_truth_object(const CompareReport *report)
{
    const LadderTruth *truth = &report->ladder->truth;
    json_t *object = json_object();
    json_object_set_new(object, "backend", json_string(truth->backend));
    json_value_set(object, "uncertainty", truth->uncertainty);
    const bool is_certified = truth->message[0] == '\0';
    json_object_set_new(object, "message", json_value_not_certified(truth->message));
    json_value_set(object, "horizon_s", is_certified ? truth->horizon_s : NAN);
    json_object_set_new(object, "is_limited", json_boolean(truth->is_limited));
    json_value_set(object, "growth", is_certified ? truth->growth : NAN);
    json_object_set_new(object, "other_contact_model",
                        json_boolean(compare_report_mixes_models(report)));
    json_value_set(object, "wall_s", truth->wall_s);
    return object;
}

static json_t *ensemble_object(const CompareReport *report, const LadderEnsemble *ensemble)
{
    if (!ensemble->is_known) {
        return json_null();
    }
    json_t *object = json_object();
    json_value_set(object, "step_s", ensemble->step_s > 0.0 ? ensemble->step_s : NAN);
    json_object_set_new(object, "members", json_integer((json_int_t)ensemble->ensemble.members));
    json_object_set_new(object, "failed", json_integer((json_int_t)ensemble->ensemble.failed));
    json_object_set_new(object, "message", json_value_text(ensemble->ensemble.message));
    if (ensemble->ensemble.members > 0) {
        json_object_set_new(object, "joints",
                            ensemble_joints_json(&report->scenario->linkage, &ensemble->ensemble));
    }
    return object;
}

static json_t *compare_report_scheme_object(const CompareReport *report, size_t index)
{
    const Ladder *ladder = report->ladder;
    const Scheme *scheme = &ladder->schemes[index];
    json_t *object =
        json_pack("{s:s, s:s}", "scheme", scheme->name, "backend", scheme_backend(scheme));
    if (scheme->driver != NULL) {
        json_object_set_new(object, "way", json_string(scheme->way));
        json_object_set_new(object, "engine_settings",
                            json_value_text(compare_engines_settings(ladder, index)));
    } else if (scheme_has_step(scheme)) {
        json_object_set_new(object, "solver", json_string(OPTIONS_ODE_SOLVERS[scheme->solver]));
        json_object_set_new(object, "stepping",
                            json_string(OPTIONS_ODE_STEPPINGS[scheme->stepping]));
        json_object_set_new(object, "map", json_string(OPTIONS_ODE_MAPS[scheme->map]));
        json_object_set_new(object, "collider",
                            json_string(OPTIONS_ODE_COLLIDERS[scheme->collider]));
    }
    if (scheme->tolerance > 0.0) {
        json_value_set(object, "tolerance", scheme->tolerance);
    }
    json_t *points = json_array();
    for (size_t i = 0; i < ladder->point_count; i++) {
        if (ladder->points[i].scheme == index) {
            json_array_append_new(points, compare_rows_point(&ladder->points[i]));
        }
    }
    json_object_set_new(object, "order", compare_rows_order(&ladder->orders[index]));
    json_object_set_new(object, "points", points);
    json_object_set_new(object, "ensemble", ensemble_object(report, &ladder->ensembles[index]));
    return object;
}

json_t *compare_json_build(const void *of)
{
    const CompareReport *report = of;
    const Ladder *ladder = report->ladder;
    json_t *object = json_object();
    settings_json_begin(object, report->scenario);
    json_object_set_new(object, "machine", json_value_text(report->machine));
    json_object_set_new(object, "repeats", json_integer((json_int_t)ladder->repeats));
    json_object_set_new(object, "truth", compare_report_truth_object(report));
    const bool is_cut = report->left.finest_s > 0.0;
    json_value_set(object, "left_out_finest_step_s", is_cut ? report->left.finest_s : NAN);
    json_value_set(object, "left_out_work_ratio", is_cut ? report->left.ratio : NAN);
    json_t *schemes = json_array();
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        json_array_append_new(schemes, compare_report_scheme_object(report, i));
    }
    json_object_set_new(object, "schemes", schemes);
    json_t *cheapest = json_array();
    for (size_t i = 0; i < LADDER_TARGET_COUNT; i++) {
        json_array_append_new(cheapest, compare_rows_cheapest(ladder, i));
    }
    json_object_set_new(object, "cheapest", cheapest);
    if (compare_engines_are_any(ladder)) {
        json_object_set_new(object, "engines", compare_engines_json(ladder));
        json_object_set_new(object, "cheapest_of_backends", compare_engines_cheapest(ladder));
    }
    return object;
}
