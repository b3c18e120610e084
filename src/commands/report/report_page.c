// Writes the page of a run: what is said of it in words and tables.
#include "commands/report/report_page.h"
#include "commands/report/report_data.h"
#include "commands/report/report_html.h"
#include "commands/report/report_numbers.h"
#include "commands/report/report_shell.h"
#include "commands/report/report_svg.h"
#include "commands/run/run_overview.h"
#include "write/assumed.h"
#include "write/json_value.h"
#include "write/settings_json.h"
#include "write/settled.h"
#include "write/units.h"
#include "write/xml.h"

#include <stdio.h>
#include <string.h>

// The answer.

static void answer_row(const OverviewRow *row, bool has_crank, Text *html)
{
    text_append(html, "<tr>");
    html_words("th scope=\"row\"", row->name, html);
    html_cell_units(row->largest, row->unit, html);
    html_cell_number(has_crank ? "%.1f deg" : "%.4g ms",
                     has_crank ? units_wrapped_deg(row->crank_rad) : row->time_s * UNITS_MS, html);
    html_cell_number("%.3g", row->ratio, html);
    html_cell_number("%.3g", row->impacts, html);
    html_cell_number("%.1f %%", row->contact * UNITS_PERCENT, html);
    html_cell_units(row->deepest, row->depth, html);
    text_append(html, "</tr>\n");
}

enum { JOINTS_MOST = 10, BODIES_MOST = 6 }; // rows of a large mechanism

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

// A row of a motion that does not repeat.
static void spread_row(const OverviewRow *row, Text *html)
{
    text_append(html, "<tr>");
    html_words("th scope=\"row\"", row->name, html);
    for (OverviewCell cell = 0; cell < OVERVIEW_CELL_COUNT; cell++) {
        Text words;
        text_init(&words);
        run_overview_cell(row, cell, &words);
        html_words("td", words.data, html);
        text_finish(&words);
    }
    text_append(html, "</tr>\n");
}

static void write_row(const Overview *overview, const OverviewRow *row, bool has_crank, Text *html)
{
    if (run_overview_is_random(overview)) {
        spread_row(row, html);
    } else {
        answer_row(row, has_crank, html);
    }
}

static void overview_head(const Overview *overview, bool has_crank, Text *html)
{
    const bool is_random = run_overview_is_random(overview);
    text_append(html,
                "<div class=\"wide\"><table class=\"numbers\">\n<caption>%sargest angular "
                "acceleration of each body, ",
                overview->joint_count > 0 ? "Largest force of each joint with play, l" : "L");
    if (is_random) {
        text_append(html, "of %zu %s of the settled motion", overview->motion->counted,
                    has_crank ? "revolutions" : "periods");
    } else {
        text_append(html, "by ");
        xml_append(overview->run->backend, html);
    }
    text_append(html,
                "</caption>\n<thead><tr><th scope=\"col\">joint, body</th>%s"
                "<th scope=\"col\">x ideal</th><th scope=\"col\">impacts%s</th>"
                "<th scope=\"col\">contact</th><th scope=\"col\">deepest</th></tr></thead>\n"
                "<tbody>\n",
                is_random ? "<th scope=\"col\">95 %</th><th scope=\"col\">+- %</th>"
                            "<th scope=\"col\">median</th><th scope=\"col\">most</th>"
                          : "<th scope=\"col\">largest</th><th scope=\"col\">at</th>",
                has_crank ? " a turn" : "");
}

// The table of the first screen, with more of its rows.
static void append_overview(const RunReport *report, Text *html)
{
    Overview overview = run_overview_make(report);
    const bool has_crank = drive_is_steady(&report->scenario->linkage.driver);
    const size_t joints = least(overview.joint_count, JOINTS_MOST);
    const size_t bodies = least(overview.body_count, BODIES_MOST);
    if (joints + bodies > 0) {
        overview_head(&overview, has_crank, html);
        for (size_t i = 0; i < joints; i++) {
            write_row(&overview, &overview.joints[i], has_crank, html);
        }
        for (size_t i = 0; i < bodies; i++) {
            write_row(&overview, &overview.bodies[i], has_crank, html);
        }
        for (size_t i = 0; i < overview.drive_count; i++) {
            write_row(&overview, &overview.drives[i], has_crank, html);
        }
        text_append(html, "</tbody></table></div>\n");
    }
    const size_t more = overview.joint_count - joints + overview.body_count - bodies;
    if (more > 0) {
        text_append(html, "<p>%zu more joints and bodies are in the tables at the end.</p>\n",
                    more);
    }
    if (joints > 0) {
        text_append(html,
                    "<p class=\"note\"><i>x ideal</i>: over the same mechanism with ideal joints. "
                    "<i>contact</i>: the share of the time. <i>deepest</i>: how far the pin is "
                    "pressed into its hole.</p>\n");
    }
    run_overview_free(&overview);
}

static void append_answer(const RunReport *report, Text *html)
{
    text_append(html, "<section id=\"answer\">\n<h2>The answer</h2>\n");
    Text louder;
    text_init(&louder);
    settled_louder(report->scenario, "below", &louder);
    html_list(louder.data, html);
    text_finish(&louder);
    append_overview(report, html);
    Text sentences;
    text_init(&sentences);
    run_overview_sentences(report, &sentences);
    html_list(sentences.data, html);
    text_finish(&sentences);
    text_append(html, "</section>\n");
}

// How it was made.

static void append_value(const json_t *value, Text *words)
{
    if (json_is_string(value)) {
        text_append(words, "%s", json_string_value(value));
    } else if (json_is_real(value)) {
        text_append_number(words, json_real_value(value));
    } else {
        json_value_write(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(10), words);
    }
}

static void append_settings(const json_t *all, Text *html)
{
    const json_t *units = json_object_get(all, "setting_units");
    text_append(html, "<details><summary>All settings, in SI units</summary>\n"
                      "<div class=\"wide\"><table>\n");
    const char *key;
    json_t *value;
    json_object_foreach(json_object_get(all, "settings"), key, value)
    {
        const char *unit = json_string_value(json_object_get(units, key));
        Text words;
        text_init(&words);
        append_value(value, &words);
        text_append(&words, "%s%s", unit != NULL ? " " : "", unit != NULL ? unit : "");
        html_pair(key, words.data, html);
        text_finish(&words);
    }
    text_append(html, "</table></div></details>\n");
}

static void append_making(const ReportPage *page, Text *html)
{
    const Scenario *scenario = page->report->scenario;
    json_t *all = json_object();
    settings_json_begin(all, scenario);
    assumed_json(all, scenario);
    const json_t *assumed = json_object_get(all, "assumed");
    const char *key;
    json_t *value;
    if (json_object_size(assumed) > 0) {
        text_append(html, "<section id=\"assumed\">\n<h2>What was assumed</h2>\n<p>The case does "
                          "not say these; the numbers depend on them.</p>\n<table>\n");
        json_object_foreach(json_object_get(all, "assumed"), key, value)
        {
            html_pair(key, json_string_value(value), html);
        }
        text_append(html, "</table>\n</section>\n");
    }
    text_append(html, "<section id=\"made\">\n<h2>How it was made</h2>\n<p>This command makes this "
                      "page again:</p>\n<pre>");
    xml_append(page->command, html);
    text_append(html, "</pre>\n<table>\n");
    html_pair("case", scenario_path(scenario), html);
    json_object_foreach(json_object_get(all, "tool"), key, value)
    {
        html_pair(strcmp(key, "version") == 0 ? "jointplay" : key, json_string_value(value), html);
    }
    text_append(html, "</table>\n");
    append_settings(all, html);
    text_append(html, "</section>\n");
    json_decref(all);
}

static void append_tables(const RunReport *report, Text *html)
{
    Text tables;
    text_init(&tables);
    run_text_write(report, &STYLE_PLAIN, &tables);
    text_append(html, "<section id=\"tables\">\n<h2>All tables</h2>\n<details><summary>What "
                      "<code>jointplay run --full --wide</code> prints</summary>\n<div "
                      "class=\"wide\"><pre>");
    xml_append(tables.data, html);
    text_append(html, "</pre></div></details>\n</section>\n");
    text_finish(&tables);
}

// The picture, for readers without script.

static void append_picture(const RunReport *report, Text *html)
{
    Text svg;
    text_init(&svg);
    plot_run_write(report, &svg);
    text_append(html, "<section id=\"picture\">\n<h2>Motion and forces</h2>\n<p>With script this "
                      "page shows the mechanism moving, and plots that can be zoomed.</p>\n");
    svg_embed(svg.data, "Motion of the bodies and forces in the joints", html);
    text_append(html, "</section>\n");
    text_finish(&svg);
}

void report_page_write(const ReportPage *page, Text *html)
{
    const RunReport *report = page->report;
    const char *path = scenario_path(report->scenario);
    const char *title = report->scenario->title;
    Shell shell = shell_create(SHELL_RUN, title[0] != '\0' ? title : path, path);
    Text data;
    text_init(&data);
    Text picture;
    text_init(&picture);
    append_picture(report, &picture);
    report_data_write(report, page->command, picture.length, &data);
    shell_begin(&shell, html);
    append_answer(report, html);
    text_append(html, "<div id=\"live\" hidden></div>\n%s", picture.data);
    report_numbers_write(report, html);
    append_making(page, html);
    append_tables(report, html);
    shell_end(&shell, data.data, html);
    text_finish(&picture);
    text_finish(&data);
    shell_finish(&shell);
}
