// Which error does each scheme have, at which cost, and what is the cheapest setting?
#include "commands/compare/compare_report.h"
#include "write/section.h"
#include "write/units.h"

#include <math.h>
#include <string.h>

static void write_head(const CompareReport *report, const Style *style, Text *text)
{
    const Scenario *scenario = report->scenario;
    const Ladder *ladder = report->ladder;
    const LadderTruth *truth = &ladder->truth;
    section_title(scenario->title, scenario_path(scenario), style, text);
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
    text_append(text, "  times       median of %zu runs, taken in turn, on %s\n", ladder->repeats,
                report->machine);
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
            text_append(text, "\n  %s %s\n", point->name, point->reason);
        }
        last = point->is_failed ? "" : point->reason;
        last_scheme = point->scheme;
    }
}

// Why points failed.
static void write_failures(const CompareReport *report, const Style *style, Text *text)
{
    const Ladder *ladder = report->ladder;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->is_failed) {
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
        const bool is_ode = ladder->schemes[point->scheme].backend == BACKEND_ODE;
        if (!is_ode && !point->is_failed && isfinite(point->wall_median_s)) {
            text_append(text, "  beside it: %s, ", point->name);
            text_append(text, isfinite(point->error) ? "error %.1e" : "without an error",
                        point->error);
            text_append(text, " in %.4g ms\n", point->wall_median_s * UNITS_MS);
        }
    }
}

void compare_text_write(const void *of, const Style *style, Text *text)
{
    const CompareReport *report = of;
    write_head(report, style, text);
    compare_rows_write_points(report->ladder, style, text);
    text_append(text,
                "  frontier: every faster point of ODE has an error at least a hundredth larger.\n"
                "  truth-limited: the error is below ten times the truth's uncertainty, which "
                "dominates it.\n");
    write_failures(report, style, text);
    write_without_error(report->ladder, text);
    compare_rows_write_orders(report->ladder, style, text);
    text_append(text, "  none: the error does not fall alike over any three steps in a row.\n");
    compare_rows_write_cheapest(report->ladder, style, text);
    write_others(report->ladder, text);
    compare_spread_write(report, style, text);
}
