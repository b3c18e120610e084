// Writes what a comparison of ODE's schemes, and of other engines, found: the cheapest setting of
// each error, speed against error, and every point.
#include "commands/compare/compare_style.h"
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

static const json_t *engines_of(const json_t *result)
{
    return json_object_get(result, "engines");
}

// Of each error the cheapest setting of ODE.
static void append_settings(const json_t *result, Text *html)
{
    static const char *const HEADS[] = {"error at most", "cheapest scheme", "step", "its error",
                                        "wall time"};
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
}

// One cell: "26.1 ms: kernel, 25.0 us", "none".
static void append_way(const json_t *row, Text *html)
{
    const char *scheme = html_text_of(row, "scheme");
    // of ODE's the map or the stepping, of an engine's its way; auto/1e-3 is no path
    const bool is_path = isfinite(html_number_of(row, "step_s")) && strchr(scheme, '/') != NULL;
    const char *way = is_path ? strrchr(scheme, '/') + 1 : scheme;
    Text words;
    text_init(&words);
    if (scheme[0] == '\0') {
        text_append(&words, "none");
    } else {
        units_append(&words, html_number_of(row, "wall_median_s"), "s");
        text_append(&words, ": %s", way);
        if (is_path) {
            text_append(&words, ", ");
            append_step(html_number_of(row, "step_s"), &words);
        }
    }
    html_words("td", words.data, html);
    text_finish(&words);
}

enum { ERROR_MOST = 12, ERROR_WORDS = 32 };

// Begins a table with a column for each error that the first backend has a row of.
static void begin_ways(const json_t *rows, Text *html)
{
    char words[ERROR_MOST][ERROR_WORDS];
    const char *heads[ERROR_MOST + 1] = {"wall time at an error of"};
    const char *first = html_text_of(json_array_get(rows, 0), "backend");
    size_t count = 0;
    size_t i;
    json_t *row;
    json_array_foreach(rows, i, row)
    {
        if (count < ERROR_MOST && strcmp(html_text_of(row, "backend"), first) == 0) {
            snprintf(words[count], ERROR_WORDS, "%.0e", html_number_of(row, "error_at_most"));
            heads[count + 1] = words[count];
            count++;
        }
    }
    html_table_begin("The cheapest way of each engine, and its step", count + 1, heads, html);
}

// Of each engine, ODE among them, the cheapest way to each error.
static void append_ways(const json_t *result, Text *html)
{
    const json_t *rows = json_object_get(result, "cheapest_of_backends");
    const char *backend = "";
    begin_ways(rows, html);
    size_t i;
    json_t *row;
    json_array_foreach(rows, i, row)
    {
        const char *own = html_text_of(row, "backend");
        if (strcmp(own, backend) != 0) {
            text_append(html, backend[0] != '\0' ? "</tr>\n<tr>" : "<tr>");
            html_words("th scope=\"row\"", own, html);
        }
        append_way(row, html);
        backend = own;
    }
    text_append(html, "</tr>\n");
    html_table_end(html);
}

static void append_engines(const json_t *result, Text *html)
{
    static const char *const HEADS[] = {"backend", "~engine", "version", "precision"};
    if (json_array_size(engines_of(result)) == 0) {
        return;
    }
    html_table_begin("The other engines", 4, HEADS, html);
    size_t i;
    json_t *engine;
    json_array_foreach(engines_of(result), i, engine)
    {
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", html_text_of(engine, "name"), html);
        html_words("td class=\"words\"", html_text_of(engine, "engine"), html);
        html_cell_text_of(engine, "version", html);
        html_cell_text_of(engine, "precision", html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
}

static void append_compare_answer(const json_t *result, Text *html)
{
    text_append(html, "<section>\n<h2>The answer</h2>\n");
    (json_array_size(engines_of(result)) > 0 ? append_ways : append_settings)(result, html);
    Text words;
    text_init(&words);
    append_truth(result, &words);
    html_list(words.data, html);
    text_finish(&words);
    append_engines(result, html);
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

// The points that no other setting beats in both time and error; the reference is none.
static void draw_frontier(const json_t *schemes, Drawing *drawing)
{
    DrawLine *frontier =
        draw_add(drawing, "frontier: nothing beside the reference is faster and better",
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

// The style of a way of another engine, NAME/WAY.
static PlotStyle style_of_way(const json_t *engine, const char *scheme)
{
    const json_t *ways = json_object_get(engine, "ways");
    const char *slash = strchr(scheme, '/');
    size_t i;
    size_t number = 0;
    json_t *way;
    json_array_foreach(ways, i, way)
    {
        number = slash != NULL && strcmp(json_string_value(way), slash + 1) == 0 ? i : number;
    }
    return compare_style_of_engine(html_text_of(engine, "name"), number, json_array_size(ways));
}

static PlotStyle style_of(const json_t *result, const json_t *scheme)
{
    const char *name = html_text_of(scheme, "scheme");
    size_t i;
    json_t *engine;
    json_array_foreach(engines_of(result), i, engine)
    {
        if (strcmp(html_text_of(engine, "name"), html_text_of(scheme, "backend")) == 0) {
            return style_of_way(engine, name);
        }
    }
    const json_t *first = json_array_get(json_object_get(scheme, "points"), 0);
    if (!isfinite(html_number_of(first, "step_s"))) {
        return compare_style_of_others();
    }
    return compare_style_of_scheme(name);
}

static const char REFERENCE_COLOUR[] = "#0072b2"; // as in the pages of runs

static void append_compare_picture(const json_t *result, Text *html)
{
    Drawing drawing = {.title = json_array_size(engines_of(result)) > 0
                                    ? "Error against wall time"
                                    : "Error of ODE against wall time",
                       .x_title = "wall time of the run, ms",
                       .y_title = "largest error, relative",
                       .is_x_log = true,
                       .is_y_log = true,
                       .level = NAN};
    const json_t *schemes = json_object_get(result, "schemes");
    draw_frontier(schemes, &drawing);
    size_t i;
    size_t k;
    unsigned autos = 0;
    json_t *scheme;
    json_t *point;
    json_array_foreach(schemes, i, scheme)
    {
        const char *name = html_text_of(scheme, "scheme");
        DrawLine *line = draw_add(&drawing, name, style_of(result, scheme));
        if (strcmp(name, "reference") == 0) {
            line->shape = DRAW_RING;
            line->style.colour = REFERENCE_COLOUR;
        } else if (strncmp(name, "auto/", strlen("auto/")) == 0) {
            line->shape = DRAW_SQUARE + autos++ % (DRAW_RING - DRAW_SQUARE);
        }
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

static bool has_order(const json_t *scheme)
{
    return isfinite(html_number_of(json_object_get(scheme, "order"), "order"));
}

static bool has_any_order(const json_t *schemes)
{
    bool has = false;
    size_t i;
    json_t *scheme;
    json_array_foreach(schemes, i, scheme)
    {
        has = has || has_order(scheme);
    }
    return has;
}

static void append_scheme_orders(const json_t *schemes, Text *html)
{
    static const char *const HEADS[] = {"scheme", "order", "from step", "to step", "points"};
    if (!has_any_order(schemes)) {
        text_append(html, "<p class=\"note\">No order of the error in the step: none falls alike "
                          "over three steps in a row.</p>\n");
        return;
    }
    html_table_begin("Observed order of the error in the step", 5, HEADS, html);
    size_t i;
    json_t *scheme;
    json_array_foreach(schemes, i, scheme)
    {
        const json_t *order = json_object_get(scheme, "order");
        if (!has_order(scheme)) {
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
    append_compare_answer(result, html);
    append_compare_picture(result, html);
    text_append(html, "<section>\n<h2>Schemes</h2>\n");
    append_scheme_orders(schemes, html);
    append_points(schemes, html);
    text_append(html, "</section>\n");
}

const ResultKind REPORT_COMPARE = {
    .command = "compare", .key = "left_out_finest_step_s", .write = report_compare_write};
