// Writes what a map found: the longest valid step of each map of ODE, and what ODE delivers at each
// step beside what was asked for.
#include "commands/report/report_draw.h"
#include "commands/report/report_html.h"
#include "commands/report/report_result.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// A step in the unit that the verdicts beside it and the screen of map have.
static void cell_step(const json_t *object, const char *key, Text *html)
{
    html_cell_number("%.3g us", UNITS_US * html_number_of(object, key), html);
}

enum { MAPS_MOST = 16 };

// The maps of a contact, in the order of their first rows.
static size_t list_maps(const json_t *contact, const char *maps[MAPS_MOST])
{
    size_t count = 0;
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(contact, "rows"), i, row)
    {
        const char *map = html_text_of(row, "map");
        size_t k = 0;
        while (k < count && strcmp(maps[k], map) != 0) {
            k++;
        }
        if (k == count && count < MAPS_MOST) {
            maps[count++] = map;
        }
    }
    return count;
}

static void answer_row(const json_t *contact, const json_t *names, Text *html)
{
    const json_t *longest = json_object_get(contact, "longest_valid_step_s");
    const char *key;
    json_t *unused;
    text_append(html, "<tr>");
    html_words("th scope=\"row\"", html_text_of(contact, "joint"), html);
    html_cell_number("%.3g", html_number_of(json_object_get(contact, "asked"), "restitution"),
                     html);
    json_object_foreach((json_t *)names, key, unused)
    {
        cell_step(longest, key, html);
    }
    html_words("td", "any", html);
    text_append(html, "</tr>\n");
}

static void append_map_answer(const json_t *result, Text *html)
{
    const json_t *contacts = json_object_get(result, "contacts");
    const json_t *names = json_object_get(json_array_get(contacts, 0), "longest_valid_step_s");
    const char *heads[MAPS_MOST + 3] = {"joint", "restitution asked"};
    size_t count = 2;
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)names, key, value)
    {
        if (count < MAPS_MOST + 2) {
            heads[count++] = key;
        }
    }
    heads[count++] = "impulse";
    char caption[160];
    snprintf(caption, sizeof caption,
             "The longest step at which each map gives the law's impact to %.3g %%",
             html_number_of(result, "valid_share") * UNITS_PERCENT);
    text_append(html, "<section>\n<h2>The answer</h2>\n");
    html_table_begin(caption, count, heads, html);
    size_t i;
    json_t *contact;
    json_array_foreach(contacts, i, contact)
    {
        answer_row(contact, names, html);
    }
    html_table_end(html);
    text_append(html, "<p class=\"note\">The map <i>impulse</i> integrates the contact within the "
                      "step, and is valid at any.</p>\n</section>\n");
}

// A number of the impact that ODE delivers, the mean over where in a step it begins.
static double mean_of(const json_t *row, const char *key)
{
    return html_number_of(json_object_get(json_object_get(row, "delivered"), key), "mean");
}

// One number of the impact that ODE delivers, over the step, a line for each map.
static void append_map_picture(const json_t *contact, const char *key, const char *title,
                               const char *y_title, bool is_log, Text *html)
{
    char words[256];
    snprintf(words, sizeof words, "%s: %.150s", title, html_text_of(contact, "joint"));
    const char *maps[MAPS_MOST];
    const size_t count = list_maps(contact, maps);
    Drawing drawing = {.title = words,
                       .x_title = "step, us",
                       .y_title = y_title,
                       .is_x_log = true,
                       .is_y_log = is_log,
                       .level = html_number_of(json_object_get(contact, "asked"), key),
                       .level_name = "asked for"};
    for (size_t k = 0; k < count; k++) {
        DrawLine *line = draw_add(&drawing, maps[k], plot_style(1, k));
        size_t i;
        json_t *row;
        json_array_foreach(json_object_get(contact, "rows"), i, row)
        {
            if (strcmp(html_text_of(row, "map"), maps[k]) == 0) {
                draw_point(&drawing, line, html_number_of(row, "step_s") * UNITS_US,
                           mean_of(row, key));
            }
        }
    }
    draw_end(&drawing, html);
}

static void append_rows(const json_t *contact, Text *html)
{
    static const char *const HEADS[] = {"map",         "step",       "ERP",     "CFM, m/(N s)",
                                        "restitution", "peak force", "~verdict"};
    char caption[256];
    snprintf(caption, sizeof caption, "%.150s: constants, and what ODE delivers with them",
             html_text_of(contact, "joint"));
    html_table_begin(caption, 7, HEADS, html);
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(contact, "rows"), i, row)
    {
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", html_text_of(row, "map"), html);
        cell_step(row, "step_s", html);
        html_cell_number_of(row, "erp", "%.4g", html);
        html_cell_number_of(row, "cfm_m_N_s", "%.4g", html);
        html_cell_number("%.3g", mean_of(row, "restitution"), html);
        html_cell_units(mean_of(row, "force_max_N"), "N", html);
        const char *verdict = html_text_of(row, "words");
        html_words("td class=\"words\"",
                   verdict[0] != '\0' ? verdict : html_text_of(row, "verdict"), html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
}

static void report_map_write(const json_t *result, Text *html)
{
    append_map_answer(result, html);
    size_t i;
    json_t *contact;
    json_array_foreach(json_object_get(result, "contacts"), i, contact)
    {
        text_append(html, "<section>\n");
        html_words("h2", html_text_of(contact, "joint"), html);
        text_append(html, "<div class=\"pictures\">\n");
        append_map_picture(contact, "restitution", "Restitution that ODE delivers", "restitution",
                           false, html);
        append_map_picture(contact, "force_max_N", "Peak force that ODE delivers", "force, N", true,
                           html);
        text_append(html, "</div>\n");
        append_rows(contact, html);
        text_append(html, "</section>\n");
    }
}

const ResultKind REPORT_MAP = {.command = "map", .key = "contacts", .write = report_map_write};
