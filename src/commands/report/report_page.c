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

enum { JOINTS_MOST = 10, BODIES_MOST = 6 }; // rows of a large mechanism

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

// The columns of the first screen.
typedef struct PageColumns {
    size_t count;
    OverviewColumn columns[OVERVIEW_COLUMN_MAX];
} PageColumns;

static void write_rows(const char *kind, const OverviewRow *rows, size_t row_count,
                       const PageColumns *of, Text *html)
{
    for (size_t i = 0; i < row_count; i++) {
        Text name;
        text_init(&name);
        text_append(&name, "%s%s", kind, rows[i].name);
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", name.data, html);
        text_finish(&name);
        for (size_t k = 0; k < of->count; k++) {
            Text words;
            text_init(&words);
            run_overview_cell(&rows[i], of->columns[k].quantity, &words);
            html_cell_headed(of->columns[k].page_title, words.data != NULL ? words.data : "", html);
            text_finish(&words);
        }
        text_append(html, "</tr>\n");
    }
}

static void overview_head(const Overview *overview, bool has_crank, const PageColumns *of,
                          Text *html)
{
    const bool is_random = run_overview_is_random(overview);
    text_append(html, HTML_WIDE "<table class=\"numbers cards\">\n<caption>Largest %s, ",
                overview->joint_count + overview->ideal_count + overview->bushing_count == 0
                    ? "angular acceleration of each body"
                : overview->body_count > 0
                    ? "force of each joint and angular acceleration of each body"
                    : "force of each joint");
    if (is_random) {
        text_append(html, "of %zu %s of the settled motion", overview->motion->counted,
                    has_crank ? "revolutions" : "periods");
    } else {
        text_append(html, "by ");
        xml_append(overview->run->backend, html);
    }
    text_append(html, "</caption>\n<thead><tr><th scope=\"col\">joint, body</th>");
    for (size_t i = 0; i < of->count; i++) {
        html_words("th scope=\"col\"", of->columns[i].page_title, html);
    }
    text_append(html, "</tr></thead>\n<tbody>\n");
}

static void append_legend(bool has_ratios, Text *html)
{
    text_append(html,
                "<p class=\"note\">%s<i>contact</i>: the share of the time. <i>deepest</i>: how "
                "far the two sides are pressed into each other.</p>\n",
                has_ratios ? "<i>x ideal</i>: times the value with ideal joints. " : "");
}

static bool has_column(const OverviewColumn *columns, size_t count, OverviewQuantity quantity)
{
    bool has = false;
    for (size_t i = 0; i < count; i++) {
        has |= columns[i].quantity == quantity;
    }
    return has;
}

// The table of the first screen, with more of its rows.
static void append_overview(const RunReport *report, Text *html)
{
    Overview overview = run_overview_make(report);
    const bool has_crank = drive_is_steady(&report->scenario->linkage.driver);
    const size_t joints = least(overview.joint_count, JOINTS_MOST);
    const size_t ideals =
        run_overview_has_ideal(&overview) ? least(overview.ideal_count, JOINTS_MOST) : 0;
    const size_t bodies = least(overview.body_count, BODIES_MOST);
    const size_t bushings = least(overview.bushing_count, JOINTS_MOST);
    bool has_ratios = false;
    if (joints + ideals + bushings + bodies > 0) {
        PageColumns of;
        of.count = run_overview_columns(&overview, has_crank, of.columns);
        has_ratios = has_column(of.columns, of.count, OVERVIEW_RATIO);
        overview_head(&overview, has_crank, &of, html);
        write_rows("", overview.joints, joints, &of, html);
        write_rows("", overview.ideal_joints, ideals, &of, html);
        write_rows("", overview.bushings, bushings, &of, html);
        write_rows("", overview.bodies, bodies, &of, html);
        write_rows(run_overview_drive_kind(&overview), overview.drives, overview.drive_count, &of,
                   html);
        text_append(html, "</tbody></table></div>\n");
    }
    const size_t ideals_left =
        run_overview_has_ideal(&overview) ? overview.ideal_count - ideals : 0;
    const size_t more = overview.joint_count - joints + ideals_left + overview.bushing_count -
                        bushings + overview.body_count - bodies;
    if (more > 0) {
        text_append(html, "<p>%zu more %s in the tables at the end.</p>\n", more,
                    more > 1 ? "joints and bodies are" : "joint or body is");
    }
    if (joints > 0) {
        append_legend(has_ratios, html);
    }
    run_overview_free(&overview);
}

static void append_run_answer(const RunReport *report, Text *html)
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

static void append_run_value(const json_t *value, Text *words)
{
    if (json_is_string(value)) {
        text_append(words, "%s", json_string_value(value));
    } else if (json_is_real(value)) {
        text_append_number(words, json_real_value(value));
    } else {
        json_value_write(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(10), words);
    }
}

static void append_run_settings(const json_t *all, Text *html)
{
    const json_t *units = json_object_get(all, "setting_units");
    text_append(html,
                "<details><summary>All settings, in SI units</summary>\n" HTML_WIDE "<table>\n");
    const char *key;
    json_t *value;
    json_object_foreach(json_object_get(all, "settings"), key, value)
    {
        const char *unit = json_string_value(json_object_get(units, key));
        Text words;
        text_init(&words);
        append_run_value(value, &words);
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
                      "page again:</p>\n<pre " HTML_SCROLLS ">");
    xml_append(page->command, html);
    text_append(html, "</pre>\n<table>\n");
    html_pair("case", scenario_path(scenario), html);
    json_object_foreach(json_object_get(all, "tool"), key, value)
    {
        html_pair(strcmp(key, "version") == 0 ? "jointplay" : key, json_string_value(value), html);
    }
    text_append(html, "</table>\n");
    append_run_settings(all, html);
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
                      "class=\"wide\"><pre " HTML_SCROLLS ">");
    xml_append(tables.data, html);
    text_append(html, "</pre></div></details>\n</section>\n");
    text_finish(&tables);
}

// The picture, for readers without script.

static void append_run_picture(const RunReport *report, Text *html)
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
    append_run_picture(report, &picture);
    report_data_write(report, page->command, picture.length, &data);
    shell_begin(&shell, html);
    append_run_answer(report, html);
    text_append(html, "<div id=\"live\" hidden></div>\n%s", picture.data);
    report_numbers_write(report, html);
    append_making(page, html);
    append_tables(report, html);
    shell_end(&shell, data.data, html);
    text_finish(&picture);
    text_finish(&data);
    shell_finish(&shell);
}
