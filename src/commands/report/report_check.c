// Writes what a check found: how many numbers kept to their bands, what left its band, and each
// number in its band.
#include "base/zeroed.h"
#include "commands/report/report_html.h"
#include "commands/report/report_result.h"
#include "commands/report/report_svg.h"
#include "write/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_within(const json_t *item)
{
    return strcmp(html_text_of(item, "status"), "within") == 0;
}

static void append_check_answer(const json_t *result, Text *html)
{
    static const char *const HEADS[] = {"case",    "status",       "within",
                                        "outside", "not compared", "~why"};
    const json_t *cases = json_object_get(result, "cases");
    size_t kept = 0;
    double within = 0.0;
    double out = 0.0;
    size_t i;
    json_t *item;
    json_array_foreach(cases, i, item)
    {
        kept += is_within(item) ? 1 : 0;
        within += fmax(0.0, html_number_of(item, "within"));
        out += fmax(0.0, html_number_of(item, "out"));
    }
    text_append(html,
                "<section>\n<h2>The answer</h2>\n<p>%zu of %zu cases are within their baselines: "
                "%.0f numbers inside their bands, %.0f outside.</p>\n",
                kept, json_array_size(cases), within, out);
    html_cards_begin("Cases", 6, HEADS, html);
    json_array_foreach(cases, i, item)
    {
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", html_text_of(item, "case"), html);
        html_cell_headed(HEADS[1], html_text_of(item, "status"), html);
        for (size_t k = 0; k < 3; k++) {
            static const char *const COUNTS[] = {"within", "out", "left_out"};
            char count[32];
            snprintf(count, sizeof count, "%.0f", fmax(0.0, html_number_of(item, COUNTS[k])));
            html_cell_headed(HEADS[2 + k], count, html);
        }
        html_cell_headed(HEADS[5], html_text_of(item, "message"), html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
    text_append(html, "</section>\n");
}

// Each number in its band: how far it has moved, over the width of the band.

static const double STRIP_WIDTH = 1000.0; // pixels, as the others
static const double STRIP_LEFT = 90.0;
static const double STRIP_HEIGHT = 230.0;
static const double SHOWN_MOST = 3.0;  // bands; what is further out stands at the edge
static const double SEEN_LEAST = 0.01; // bands: below all spots stand on one line

static bool is_out(const json_t *metric)
{
    return strcmp(html_text_of(metric, "verdict"), "out") == 0;
}

// The farthest that any number has moved, over its band; INFINITY where one is out.
static double farthest_of(const json_t *metrics)
{
    double farthest = 0.0;
    size_t i;
    json_t *metric;
    json_array_foreach(metrics, i, metric)
    {
        const double off = fabs(html_number_of(metric, "bands_off"));
        farthest = is_out(metric) ? INFINITY : off > farthest ? off : farthest;
    }
    return farthest;
}

static void append_strip(const json_t *item, Text *html)
{
    const json_t *metrics = json_object_get(item, "metrics");
    const double farthest = farthest_of(metrics);
    if (farthest == 0.0) {
        text_append(html, "<p>No number has moved.</p>\n");
        return;
    }
    if (farthest < SEEN_LEAST) {
        text_append(html, "<p>No number has moved by a hundredth of its band.</p>\n");
        return;
    }
    static const char title[] = "Each number in its band";
    Text svg;
    text_init(&svg);
    const double count = (double)json_array_size(metrics);
    PlotPanel panel = {
        .svg = &svg,
        .title = "",
        .left = STRIP_LEFT,
        .top = 30.0,
        .width = STRIP_WIDTH - STRIP_LEFT - 30.0,
        .height = STRIP_HEIGHT - 80.0,
        .x = {.title = "change since the baseline, over the width of the number's band",
              .low = -SHOWN_MOST,
              .high = SHOWN_MOST,
              .tick = 1.0},
        .y = {.title = "number", .low = 0.0, .high = count + 1.0, .tick = count + 1.0}};
    plot_begin(&svg, STRIP_WIDTH, STRIP_HEIGHT, title);
    plot_text(&svg, STRIP_LEFT, 18.0, "start", "panel", title);
    plot_enter(&panel);
    plot_shade(&panel, -1.0, 1.0);
    size_t i;
    json_t *metric;
    json_array_foreach(metrics, i, metric)
    {
        const double off = html_number_of(metric, "bands_off");
        if (isfinite(off)) {
            plot_spot(&svg, plot_x(&panel, fmax(-SHOWN_MOST, fmin(SHOWN_MOST, off))),
                      plot_y(&panel, (double)i + 1.0), is_out(metric) ? 4.0 : 2.4,
                      is_out(metric) ? "#d55e00" : "#0072b2", "#fff", 0.6);
        }
    }
    plot_leave(&panel);
    plot_end(&svg);
    svg_embed(svg.data, title, html);
    text_finish(&svg);
}

static double distance_of(const json_t *metric)
{
    const double off = fabs(html_number_of(metric, "bands_off"));
    return is_out(metric) ? 1e300 : isfinite(off) ? off : -1.0;
}

static int compare_metrics(const void *a, const void *b)
{
    const double left = distance_of(*(const json_t *const *)a);
    const double right = distance_of(*(const json_t *const *)b);
    return (left < right) - (left > right);
}

static void metric_row(const json_t *metric, Text *html)
{
    text_append(html, "<tr>");
    html_words("th scope=\"row\"", html_text_of(metric, "metric"), html);
    html_cell_text_of(metric, "verdict", html);
    html_cell_number_of(metric, "was", "%.7g", html);
    html_cell_number_of(metric, "now", "%.7g", html);
    html_cell_number_of(metric, "bands_off", "%.3g", html);
    html_cell_text_of(metric, "band_kind", html);
    html_words("td class=\"words\"", html_text_of(metric, "why"), html);
    text_append(html, "</tr>\n");
}

// All numbers, those that are out or nearest to it first.
static void append_metrics(const json_t *item, Text *html)
{
    static const char *const HEADS[] = {"number", "verdict", "was",         "is",
                                        "bands",  "band",    "~why so wide"};
    const json_t *metrics = json_object_get(item, "metrics");
    const size_t count = json_array_size(metrics);
    const json_t **sorted = zeroed(count, sizeof *sorted);
    for (size_t i = 0; i < count; i++) {
        sorted[i] = json_array_get(metrics, i);
    }
    if (count > 0) {
        qsort(sorted, count, sizeof *sorted, compare_metrics);
    }
    text_append(html,
                "<details%s><summary>%zu numbers, those nearest to the edge of their bands "
                "first</summary>\n",
                count > 0 && is_out(sorted[0]) ? " open" : "", count);
    html_table_begin("Numbers", 7, HEADS, html);
    for (size_t i = 0; i < count; i++) {
        metric_row(sorted[i], html);
    }
    html_table_end(html);
    text_append(html, "</details>\n");
    free(sorted);
}

// The limits that a case sets for itself under expect, and how its runs were to end.
static void append_limits(const json_t *item, Text *html)
{
    static const char *const HEADS[] = {"limit of the case", "verdict", "value", "~expected"};
    const json_t *limits = json_object_get(item, "limits");
    if (json_array_size(limits) == 0) {
        return;
    }
    html_cards_begin("Limits of the case", 4, HEADS, html);
    size_t i;
    json_t *limit;
    json_array_foreach(limits, i, limit)
    {
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", html_text_of(limit, "path"), html);
        char value[32] = "";
        if (isfinite(html_number_of(limit, "value"))) {
            snprintf(value, sizeof value, "%.6g", html_number_of(limit, "value"));
        }
        html_cell_headed(HEADS[1], html_text_of(limit, "verdict"), html);
        html_cell_headed(HEADS[2], value, html);
        html_cell_headed(HEADS[3], html_text_of(limit, "limit"), html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
}

static void append_outcomes(const json_t *item, Text *html)
{
    static const char *const HEADS[] = {"run", "outcome", "~expected", "~found"};
    const json_t *outcomes = json_object_get(item, "outcomes");
    if (json_array_size(outcomes) == 0) {
        return;
    }
    html_cards_begin("How its runs ended", 4, HEADS, html);
    size_t i;
    json_t *outcome;
    json_array_foreach(outcomes, i, outcome)
    {
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", html_text_of(outcome, "run"), html);
        html_cell_headed(HEADS[1], html_text_of(outcome, "outcome"), html);
        html_cell_headed(HEADS[2], html_text_of(outcome, "expected"), html);
        html_cell_headed(HEADS[3], html_text_of(outcome, "found"), html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
}

static void report_check_write(const json_t *result, Text *html)
{
    append_check_answer(result, html);
    size_t i;
    json_t *item;
    json_array_foreach(json_object_get(result, "cases"), i, item)
    {
        text_append(html, "<section>\n");
        html_words("h2", html_text_of(item, "case"), html);
        if (json_array_size(json_object_get(item, "metrics")) > 0) {
            append_strip(item, html);
            append_metrics(item, html);
        }
        append_limits(item, html);
        append_outcomes(item, html);
        text_append(html, "</section>\n");
    }
}

const ResultKind REPORT_CHECK = {
    .command = "check", .key = "rank_tests", .write = report_check_write};
