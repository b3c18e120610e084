// Writes what a comparison of ODE's schemes found: the cheapest setting of each error, speed
// against error, and every point.
#include "commands/report/report_draw.h"
#include "commands/report/report_html.h"
#include "commands/report/report_result.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void append_step(double step_s, Text *words)
{
    if (isfinite(step_s)) {
        units_append(words, step_s, "s");
    } else {
        text_append(words, "its own");
    }
}

static void cell_step(const json_t *object, Text *html)
{
    Text words;
    text_init(&words);
    append_step(html_number_of(object, "step_s"), &words);
    html_words("td", words.data, html);
    text_finish(&words);
}

// The reference's own time and error, to which ODE's are compared.
static void append_truth(const json_t *result, Text *words)
{
    const json_t *truth = json_object_get(result, "truth");
    const double uncertainty = html_number_of(truth, "uncertainty");
    if (isfinite(uncertainty)) {
        text_append(words, "Errors are against %s, which is right to %.2g and takes ",
                    html_text_of(truth, "backend"), uncertainty);
        units_append(words, html_number_of(truth, "wall_s"), "s");
        text_append(words, " with its certificate.\n");
    }
    if (html_flag_of(truth, "is_limited")) {
        text_append(words, "They are those up to the predictability horizon, ");
        units_append(words, html_number_of(truth, "horizon_s"), "s");
        text_append(words, "; beyond it the motion cannot be predicted.\n");
    }
}

static void append_answer(const json_t *result, Text *html)
{
    static const char *const HEADS[] = {"error at most", "cheapest scheme", "step", "its error",
                                        "wall time"};
    text_append(html, "<section>\n<h2>The answer</h2>\n");
    html_table_begin("The cheapest setting of ODE for an error", 5, HEADS, html);
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(result, "cheapest"), i, row)
    {
        char words[32];
        snprintf(words, sizeof words, "%.0e", html_number_of(row, "error_at_most"));
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", words, html);
        const bool is_met = html_text_of(row, "scheme")[0] != '\0';
        if (!is_met) {
            text_append(html, "<td>none</td><td></td><td></td><td></td></tr>\n");
            continue;
        }
        html_cell_text_of(row, "scheme", html);
        cell_step(row, html);
        html_cell_number_of(row, "error_max", "%.2e", html);
        html_cell_units_of(row, "wall_median_s", "s", html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
    Text words;
    text_init(&words);
    append_truth(result, &words);
    html_list(words.data, html);
    text_finish(&words);
    text_append(html, "</section>\n");
}

static bool is_drawn(const json_t *point)
{
    return strcmp(html_text_of(point, "status"), "ok") == 0 &&
           html_number_of(point, "error_max") > 0.0 && html_number_of(point, "wall_median_s") > 0.0;
}

static int compare_times(const void *a, const void *b)
{
    const DrawPoint *left = a;
    const DrawPoint *right = b;
    return (left->x > right->x) - (left->x < right->x);
}

// The points that no other beats in both time and error.
static void draw_frontier(const json_t *schemes, Drawing *drawing)
{
    DrawLine *frontier = draw_add(drawing, "frontier: nothing is faster and better",
                                  (PlotStyle){"#f0c419", 9.0, 0.5, NULL});
    frontier->is_bare = true;
    size_t i;
    size_t k;
    json_t *scheme;
    json_t *point;
    json_array_foreach(schemes, i, scheme)
    {
        json_array_foreach(json_object_get(scheme, "points"), k, point)
        {
            if (is_drawn(point) && html_flag_of(point, "on_frontier")) {
                draw_point(drawing, frontier, html_number_of(point, "wall_median_s") * UNITS_MS,
                           html_number_of(point, "error_max"));
            }
        }
    }
    if (frontier->count > 0) {
        qsort(frontier->points, frontier->count, sizeof *frontier->points, compare_times);
    }
}

static void append_picture(const json_t *result, Text *html)
{
    Drawing drawing = {.title = "Error of ODE against wall time",
                       .x_title = "wall time of the run, ms",
                       .y_title = "largest error, relative",
                       .is_x_log = true,
                       .is_y_log = true,
                       .level = NAN};
    const json_t *schemes = json_object_get(result, "schemes");
    draw_frontier(schemes, &drawing);
    size_t i;
    size_t k;
    json_t *scheme;
    json_t *point;
    json_array_foreach(schemes, i, scheme)
    {
        PlotStyle style = plot_style(1, i);
        // what chooses its own steps is black, as in the picture of compare
        style.colour =
            isfinite(html_number_of(json_array_get(json_object_get(scheme, "points"), 0), "step_s"))
                ? style.colour
                : "#333333";
        DrawLine *line = draw_add(&drawing, html_text_of(scheme, "scheme"), style);
        json_array_foreach(json_object_get(scheme, "points"), k, point)
        {
            if (is_drawn(point)) {
                draw_point(&drawing, line, html_number_of(point, "wall_median_s") * UNITS_MS,
                           html_number_of(point, "error_max"));
            }
        }
    }
    text_append(html, "<section>\n<h2>Speed against error</h2>\n");
    draw_end(&drawing, html);
    text_append(html, "</section>\n");
}

static void append_orders(const json_t *schemes, Text *html)
{
    static const char *const HEADS[] = {"scheme", "order", "from step", "to step", "points"};
    html_table_begin("Observed order of the error in the step", 5, HEADS, html);
    size_t i;
    json_t *scheme;
    json_array_foreach(schemes, i, scheme)
    {
        const json_t *order = json_object_get(scheme, "order");
        if (!isfinite(html_number_of(order, "order"))) {
            continue;
        }
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", html_text_of(scheme, "scheme"), html);
        html_cell_number_of(order, "order", "%.2g", html);
        html_cell_units_of(order, "from_step_s", "s", html);
        html_cell_units_of(order, "to_step_s", "s", html);
        html_cell_number_of(order, "points", "%.0f", html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
}

static void append_points(const json_t *schemes, Text *html)
{
    static const char *const HEADS[] = {"scheme", "step",      "error",   "wall time",
                                        "steps",  "frontier?", "~why not"};
    text_append(html, "<details><summary>Every scheme at every step</summary>\n");
    html_table_begin("Every point of the comparison", 7, HEADS, html);
    size_t i;
    size_t k;
    json_t *scheme;
    json_t *point;
    json_array_foreach(schemes, i, scheme)
    {
        json_array_foreach(json_object_get(scheme, "points"), k, point)
        {
            text_append(html, "<tr>");
            html_words("th scope=\"row\"", html_text_of(scheme, "scheme"), html);
            cell_step(point, html);
            html_cell_number_of(point, "error_max", "%.2e", html);
            html_cell_units_of(point, "wall_median_s", "s", html);
            html_cell_number_of(point, "steps", "%.0f", html);
            html_words("td", html_flag_of(point, "on_frontier") ? "yes" : "", html);
            html_words("td class=\"words\"", html_text_of(point, "message"), html);
            text_append(html, "</tr>\n");
        }
    }
    html_table_end(html);
    text_append(html, "</details>\n");
}

static void report_compare_write(const json_t *result, Text *html)
{
    const json_t *schemes = json_object_get(result, "schemes");
    append_answer(result, html);
    append_picture(result, html);
    text_append(html, "<section>\n<h2>Schemes</h2>\n");
    append_orders(schemes, html);
    append_points(schemes, html);
    text_append(html, "</section>\n");
}

const ResultKind REPORT_COMPARE = {
    .command = "compare", .key = "left_out_finest_step_s", .write = report_compare_write};
