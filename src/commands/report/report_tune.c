// Writes what a search for a setting found: the setting, what the others cost, every trial, and
// constants for other programs.
#include "commands/compare/compare_style.h"
#include "commands/report/report_draw.h"
#include "commands/report/report_html.h"
#include "commands/report/report_result.h"
#include "write/units.h"
#include "write/xml.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void append_setting(const json_t *setting, const char *before, Text *words)
{
    text_append(words, "%s%s", before, html_text_of(setting, "scheme"));
    if (isfinite(html_number_of(setting, "step_s"))) {
        text_append(words, ", step ");
        units_append(words, html_number_of(setting, "step_s"), "s");
    }
    text_append(words, ": error %.3g, %.0f world steps, ", html_number_of(setting, "error_max"),
                html_number_of(setting, "steps"));
    const double median_s = html_number_of(setting, "processor_median_s");
    units_append(words, isfinite(median_s) ? median_s : html_number_of(setting, "processor_s"),
                 "s");
    text_append(words, " of the processor.\n");
}

static void append_sentences(const json_t *result, Text *html)
{
    const json_t *cheapest = json_object_get(result, "cheapest");
    const json_t *own = json_object_get(result, "own_loop");
    const json_t *reference = json_object_get(result, "reference");
    Text words;
    text_init(&words);
    text_append(&words, "Asked for: an error of the %s of at most %.3g.\n",
                html_text_of(result, "error_of"), html_number_of(result, "error_asked"));
    if (json_is_object(cheapest)) {
        append_setting(cheapest, "The cheapest: ", &words);
    } else {
        text_append(&words, "No setting that was tried meets it.\n");
    }
    if (json_is_object(own)) {
        append_setting(own, "A loop of one's own with unmodified ODE: ", &words);
    }
    if (json_is_object(reference)) {
        text_append(&words,
                    "The reference alone, in place of ODE: at a tolerance of %.3g, error %.3g, ",
                    html_number_of(reference, "tolerance"), html_number_of(reference, "error_max"));
        units_append(&words, html_number_of(reference, "processor_median_s"), "s");
        text_append(&words, ".\n");
    }
    html_list(words.data, html);
    text_finish(&words);
}

static void append_keys(const json_t *setting, Text *html)
{
    const char *key;
    json_t *value;
    if (!json_is_object(setting)) {
        return;
    }
    text_append(html, "<p>In a case:</p>\n<table>\n");
    json_object_foreach(json_object_get(setting, "keys"), key, value)
    {
        const char *words = json_string_value(value);
        html_pair(key, words != NULL ? words : "", html);
    }
    text_append(html, "</table>\n<p>This command runs it:</p>\n<pre class=\"command\">");
    xml_append(html_text_of(setting, "command"), html);
    text_append(html, "</pre>\n");
}

static void append_schemes(const json_t *result, Text *html)
{
    static const char *const HEADS[] = {"scheme", "step", "error", "processor", "meets it?"};
    html_table_begin("The cheapest setting of each scheme, or where none meets the error the one "
                     "with the least",
                     5, HEADS, html);
    size_t i;
    json_t *scheme;
    json_array_foreach(json_object_get(result, "schemes"), i, scheme)
    {
        const json_t *best = json_object_get(scheme, "best");
        const json_t *shown = json_is_object(best) ? best : json_object_get(scheme, "least");
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", html_text_of(scheme, "scheme"), html);
        html_cell_units_of(shown, "step_s", "s", html);
        html_cell_number_of(shown, "error_max", "%.2e", html);
        html_cell_units_of(shown, "processor_s", "s", html);
        html_words("td", html_flag_of(shown, "meets") ? "yes" : "no", html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
}

// What stands for a scheme that shares its colour with another.
static DrawShape shape_of(const char *scheme, bool is_quick)
{
    const bool is_plain = strstr(scheme, "/plain") != NULL;
    const DrawShape direct = is_plain ? DRAW_DOT : DRAW_SQUARE;
    const DrawShape quick = is_plain ? DRAW_DIAMOND : DRAW_TRIANGLE;
    return strchr(scheme, '/') == NULL ? DRAW_WEDGE : is_quick ? quick : direct;
}

static void append_tune_picture(const json_t *result, Text *html)
{
    Drawing drawing = {.title = "Every setting that was tried",
                       .x_title = "processor time, ms",
                       .y_title = "largest error, relative",
                       .is_x_log = true,
                       .is_y_log = true,
                       .level = html_number_of(result, "error_asked"),
                       .level_name = "the error that is asked for"};
    size_t i;
    size_t k;
    json_t *scheme;
    json_t *trial;
    json_array_foreach(json_object_get(result, "schemes"), i, scheme)
    {
        const char *name = html_text_of(scheme, "scheme");
        DrawLine *line = draw_add(&drawing, name, compare_style_of_scheme(name));
        line->is_dots = true;
        line->shape = shape_of(name, line->style.dash != NULL);
        json_array_foreach(json_object_get(result, "trials"), k, trial)
        {
            if (strcmp(html_text_of(trial, "scheme"), name) == 0) {
                draw_point(&drawing, line, html_number_of(trial, "processor_s") * UNITS_MS,
                           html_number_of(trial, "error_max"));
            }
        }
    }
    draw_end(&drawing, html);
}

static void append_code(const char *title, const char *code, Text *html)
{
    if (code[0] == '\0') {
        return;
    }
    text_append(html, "<details>");
    html_words("summary", title, html);
    text_append(html, "<pre " HTML_SCROLLS ">");
    xml_append(code, html);
    text_append(html, "</pre></details>\n");
}

static void report_tune_write(const json_t *result, Text *html)
{
    text_append(html, "<section>\n<h2>The answer</h2>\n");
    append_sentences(result, html);
    append_keys(json_object_get(result, "cheapest"), html);
    text_append(html, "</section>\n<section>\n<h2>What was tried</h2>\n");
    append_schemes(result, html);
    append_tune_picture(result, html);
    text_append(html, "</section>\n<section>\n<h2>For other programs</h2>\n");
    append_code("Lines for a loop of one's own with ODE",
                html_text_of(json_object_get(result, "own_loop"), "lines"), html);
    append_code("For Gazebo (SDF)", html_text_of(json_object_get(result, "gazebo"), "sdf"), html);
    append_code("For MuJoCo (MJCF)", html_text_of(json_object_get(result, "mujoco"), "mjcf"), html);
    text_append(html, "</section>\n");
}

const ResultKind REPORT_TUNE = {
    .command = "tune", .key = "error_asked", .write = report_tune_write};
