// How does speed stand against error, and what is the cheapest setting?
#include "commands/compare/compare_text.h"

#include "write/section.h"
#include "write/units.h"

#include <math.h>
#include <string.h>

static void step_cell(Table *table, double step_s)
{
    if (step_s > 0.0) {
        table_cell(table, "%.4g", step_s * UNITS_US);
    } else {
        table_cell(table, "its own");
    }
}

static void write_head(const CompareReport *report, const Style *style, Text *text)
{
    const Scenario *scenario = report->scenario;
    const Ladder *ladder = report->ladder;
    const LadderTruth *truth = &ladder->truth;
    const char *title = scenario->title[0] != '\0' ? scenario->title : "A case without a title";
    text_append(text, "%s%s%s\n\n", style->heading, title, style->end);
    text_append(text, "  case        ");
    text_append_shown(text, scenario->path);
    text_append(text, "\n");
    if (truth->message[0] != '\0') {
        text_append(text, "  truth       %s, made in %.3g s; could not be certified: %s\n",
                    truth->backend, truth->wall_s, truth->message);
    } else {
        text_append(text, "  truth       %s, to %.2g of omega; made and certified in %.3g s\n",
                    truth->backend, truth->uncertainty, truth->wall_s);
    }
    if (truth->is_limited && truth->message[0] == '\0') {
        text_append(text,
                    "  horizon     %.4g ms of %.4g ms: beyond it no trajectory can be told, and "
                    "errors are those up to it (a start 1e-10 beside has grown "
                    "%.2g times by then)\n",
                    truth->horizon_s * UNITS_MS, scenario_duration(scenario) * UNITS_MS,
                    truth->growth);
    }
    if (compare_report_mixes_models(report)) {
        text_append(text, "  contact     the reference has the elastic law, ODE the POISSON model: "
                          "errors contain the difference of the two models\n");
    }
    text_append(text, "  times       median of %zu runs, taken in turn, on %s\n", ladder->repeats,
                report->machine);
}

static void failed_row(Table *table)
{
    table_cell(table, "failed");
    for (int i = 0; i < 5; i++) {
        table_cell(table, "-");
    }
}

static void point_row(Table *table, const LadderPoint *point)
{
    if (point->is_failed) {
        table_cell(table, "-");
        table_cell(table, "-");
        failed_row(table);
        return;
    }
    table_cell(table, "%zu", point->run.steps);
    table_cell(table, point->run.evaluations > 0 ? "%zu" : "-", point->run.evaluations);
    section_finite(table, "%.2e", point->error);
    section_finite(table, "%.4g", point->wall_median_s * UNITS_MS);
    section_finite(table, "%.4g", point->wall_min_s * UNITS_MS);
    section_finite(table, "%.4g", point->wall_max_s * UNITS_MS);
    section_finite(table, "%.3g", point->wall_median_s / (double)point->run.steps * UNITS_US);
    table_cell(table, "%s%s%s", point->is_on_frontier ? "frontier" : "",
               point->is_on_frontier && point->is_limited_by_truth ? ", " : "",
               point->is_limited_by_truth ? "truth-limited" : "");
}

// Why there is no error for points that did not fail: once where neighbours have the same reason.
static void write_without_error(const Ladder *ladder, Text *text)
{
    const char *last = "";
    size_t last_scheme = ladder->scheme_count;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        const bool is_told = point->scheme == last_scheme && strcmp(point->reason, last) == 0;
        if (!point->is_failed && point->reason[0] != '\0' && !is_told) {
            text_append(text, "\n  %s %s\n", ladder->schemes[point->scheme].name, point->reason);
        }
        last = point->is_failed ? "" : point->reason;
        last_scheme = point->scheme;
    }
}

// Why points failed; neighbours of one scheme that failed alike are told together.
static void write_failures(const CompareReport *report, const Style *style, Text *text)
{
    const Ladder *ladder = report->ladder;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->is_failed) {
            text_append(text, "\n  %s%s", style->failure, ladder->schemes[point->scheme].name);
            if (point->step_s > 0.0) {
                text_append(text, ", %.4g us", point->step_s * UNITS_US);
            }
            text_append(text, " failed: %s%s\n", point->reason, style->end);
        }
    }
}

static void write_points(const CompareReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"scheme", "", TABLE_LEFT},
        {"step", "us", TABLE_RIGHT},
        {"steps", "", TABLE_RIGHT | TABLE_MINOR},
        {"evaluations", "", TABLE_RIGHT | TABLE_DETAIL},
        {"error", "of omega", TABLE_RIGHT},
        {"wall time", "ms", TABLE_RIGHT},
        {"least", "ms", TABLE_RIGHT | TABLE_DETAIL},
        {"most", "ms", TABLE_RIGHT | TABLE_DETAIL},
        {"a step", "us", TABLE_RIGHT | TABLE_MINOR},
        {"", "", TABLE_LEFT},
    };
    const Ladder *ladder = report->ladder;
    Table *table = section_begin("Speed against error", 10, HEADS, style, text);
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        const bool is_first = i == 0 || point->scheme != ladder->points[i - 1].scheme;
        if (is_first && i > 0 && ladder->points[i - 1].step_s > 0.0) {
            table_rule(table);
        }
        table_cell(table, "%s", is_first ? ladder->schemes[point->scheme].name : "");
        step_cell(table, point->step_s);
        point_row(table, point);
    }
    section_end(table, text);
    text_append(text,
                "  frontier: every faster point of ODE has an error at least a hundredth larger.\n"
                "  truth-limited: below ten times the truth's own uncertainty, so not a number of "
                "its own.\n");
    write_failures(report, style, text);
    write_without_error(ladder, text);
}

static void write_orders(const CompareReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"scheme", "", TABLE_LEFT},       {"order", "1", TABLE_RIGHT},
        {"from step", "us", TABLE_RIGHT}, {"to step", "us", TABLE_RIGHT},
        {"points", "", TABLE_RIGHT},      {"spread", "1", TABLE_RIGHT},
    };
    const Ladder *ladder = report->ladder;
    Table *table =
        section_begin("Order observed: the error falls as step^order", 6, HEADS, style, text);
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        const Order *order = &ladder->orders[i];
        if (!scheme_has_step(&ladder->schemes[i])) {
            continue;
        }
        table_cell(table, "%s", ladder->schemes[i].name);
        if (!order->is_known) {
            table_cell(table, "none");
            for (int k = 0; k < 4; k++) {
                table_cell(table, "-");
            }
            continue;
        }
        table_cell(table, "%.2f", order->order);
        table_cell(table, "%.4g", ladder->steps[order->first] * UNITS_US);
        table_cell(table, "%.4g", ladder->steps[order->last] * UNITS_US);
        table_cell(table, "%zu", order->last - order->first + 1);
        table_cell(table, "%.2f", order->spread);
    }
    section_end(table, text);
    text_append(text, "  none: the error does not fall alike over any three steps in a row.\n");
}

// What the solvers that choose their own steps take, for the eye to hold beside it.
static void write_others(const Ladder *ladder, Text *text)
{
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        const bool is_ode = ladder->schemes[point->scheme].backend == BACKEND_ODE;
        if (!is_ode && !point->is_failed && isfinite(point->wall_median_s)) {
            text_append(text, "  beside it: %s, ", ladder->schemes[point->scheme].name);
            text_append(text, isfinite(point->error) ? "error %.1e" : "without an error",
                        point->error);
            text_append(text, " in %.4g ms\n", point->wall_median_s * UNITS_MS);
        }
    }
}

static void write_cheapest(const CompareReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"error at most", "", TABLE_LEFT}, {"scheme", "", TABLE_LEFT},
        {"step", "us", TABLE_RIGHT},       {"error", "of omega", TABLE_RIGHT},
        {"wall time", "ms", TABLE_RIGHT},
    };
    const Ladder *ladder = report->ladder;
    Table *table = section_begin("Cheapest setting of ODE", 5, HEADS, style, text);
    for (size_t i = 0; i < LADDER_TARGET_COUNT; i++) {
        table_cell(table, "%.0e", LADDER_TARGETS[i]);
        if (ladder->cheapest[i] == ladder->point_count) {
            table_cell(table, "none of these");
            for (int k = 0; k < 3; k++) {
                table_cell(table, "-");
            }
            continue;
        }
        const LadderPoint *point = &ladder->points[ladder->cheapest[i]];
        table_cell(table, "%s", ladder->schemes[point->scheme].name);
        step_cell(table, point->step_s);
        table_cell(table, "%.2e", point->error);
        table_cell(table, "%.4g", point->wall_median_s * UNITS_MS);
    }
    section_end(table, text);
    write_others(ladder, text);
}

void compare_text_write(const CompareReport *report, const Style *style, Text *text)
{
    write_head(report, style, text);
    write_points(report, style, text);
    write_orders(report, style, text);
    write_cheapest(report, style, text);
    compare_spread_write(report, style, text);
}
