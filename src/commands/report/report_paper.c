// Writes the paper's figures from its tables, recomputed: each beside what the paper says of it and
// what physics gives instead.
#include "commands/report/report_draw.h"
#include "commands/report/report_html.h"
#include "commands/report/report_result.h"
#include "measure/estimate.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// One of Figures 2 to 4, which show Tables I to III over the speed of the crank.
typedef struct Figure {
    const char *title;
    const char *y_title;
    const char *says;    // the paper of it
    const char *physics; // key of what physics gives instead; NULL: there is nothing to compare
    double scale;        // from SI to the unit of the table
} Figure;

static const Figure FIGURES[] = {
    {"Figure 2: crank speed and tangential force", "force, N",
     "Table I shows the estimated maximum tangential force for different input speeds.", "force_N",
     1.0},
    {"Figure 3: crank speed and penalty parameter", "penalty parameter, N",
     "The penalty parameter is varying linearly with the speed of the drive link.", NULL, 1.0},
    {"Figure 4: crank speed and mutual approach", "approach, um",
     "A polynomial trend of the mutual approach is observed.", "johnson_approach_m", UNITS_UM},
};
enum { FIGURE_COUNT = sizeof FIGURES / sizeof *FIGURES };

static const char *const PINS[] = {"crank-coupler", "coupler-follower"};

static void add_cells(Drawing *drawing, const json_t *rows, const char *pin, const char *key,
                      double scale, DrawLine *line)
{
    size_t i;
    json_t *row;
    json_array_foreach(rows, i, row)
    {
        if (strcmp(html_text_of(row, "pin"), pin) == 0) {
            draw_point(drawing, line, html_number_of(row, "rpm"), scale * html_number_of(row, key));
        }
    }
}

// d ln y / d ln x from the first point of a line to its last.
static double power_of(const DrawLine *line)
{
    const DrawPoint *points = line->points;
    return line->count < 2 ? NAN
                           : log(points[line->count - 1].y / points[0].y) /
                                 log(points[line->count - 1].x / points[0].x);
}

static void figure_lines(const Figure *figure, const json_t *table, const json_t *physics,
                         Drawing *drawing, Text *words)
{
    for (size_t i = 0; i < 2; i++) {
        static const char *const NAMES[] = {"crank-coupler, printed", "coupler-follower, printed"};
        static const char *const AGAIN[] = {"crank-coupler, recomputed",
                                            "coupler-follower, recomputed"};
        static const char *const REAL[] = {"crank-coupler, what physics gives",
                                           "coupler-follower, what physics gives"};
        DrawLine *line = draw_add(drawing, NAMES[i], plot_style(1, i));
        line->is_dots = true;
        add_cells(drawing, json_object_get(table, "cells"), PINS[i], "printed", 1.0, line);
        line = draw_add(drawing, AGAIN[i], plot_style(1, i));
        line->is_bare = true;
        add_cells(drawing, json_object_get(table, "cells"), PINS[i], "value", 1.0, line);
        text_append(words, "%s goes with the power %.3g of the speed.\n", PINS[i], power_of(line));
        if (figure->physics != NULL) {
            line = draw_add(drawing, REAL[i], plot_style(2, i));
            line->is_bare = true;
            add_cells(drawing, json_object_get(physics, "pins"), PINS[i], figure->physics,
                      figure->scale, line);
        }
    }
}

// A figure: what the paper says of it, how it was made here, sentences about it, and the picture.
static void write_figure(const char *says, const char *made_by, Text *words, Drawing *drawing,
                         Text *html)
{
    text_append(html, "<section>\n");
    html_words("h2", drawing->title, html);
    text_append(html, "<p>The paper says: <i>%s</i> ", says);
    if (made_by != NULL) {
        text_append(html, "Made here by ");
        html_words("code", made_by, html);
    } else {
        text_append(html, "Here:");
    }
    text_append(html, "</p>\n");
    html_list(words->data, html);
    draw_end(drawing, html);
    text_append(html, "</section>\n");
    text_finish(words);
}

static void append_figure(const Figure *figure, const json_t *table, const json_t *physics,
                          Text *html)
{
    Drawing drawing = {.title = figure->title,
                       .x_title = "speed of the crank, rpm",
                       .y_title = figure->y_title,
                       .is_x_log = true,
                       .is_y_log = true,
                       .level = NAN};
    Text words;
    text_init(&words);
    figure_lines(figure, table, physics, &drawing, &words);
    text_append(&words, "%.0f of %.0f cells of %s come out as printed.\n",
                html_number_of(table, "cells_as_printed"), html_number_of(table, "cell_count"),
                html_text_of(table, "name"));
    write_figure(figure->says, NULL, &words, &drawing, html);
}

// Figures 5 to 8, which show coupler and follower over the angle of the crank.

typedef struct CurveFigure {
    const char *title;
    const char *row; // of Tables VII and VIII
    const char *says;
    const char *keys[2]; // of coupler and follower
    const char *y_title;
    bool has_play; // the paper speaks of a beginning and of bands
} CurveFigure;

#define OMEGA_KEYS                                                                                 \
    {                                                                                              \
        "coupler_omega_rad_s", "follower_omega_rad_s"                                              \
    }
static const CurveFigure CURVES[] = {
    {"Figure 5: velocity without play", "Ideal Stack-up",
     "0.33 % and 0.15 % variation in angular velocity of coupler and follower, due to the change "
     "in "
     "the link dimensions.",
     OMEGA_KEYS, "angular velocity, rad/s", false},
    {"Figure 6: velocity with play, restitution model", "Stack-up, POISSON",
     "Increase in angular velocity of coupler and follower is observed at the initial stage of "
     "motion. Small spikes are observed between the crank angle 120 to 130 deg and 290 to 300 deg.",
     OMEGA_KEYS, "angular velocity, rad/s", true},
    {"Figure 7: velocity with play, impact model", "Stack-up, IMPACT",
     "The angular velocity of coupler and follower with the impact model.", OMEGA_KEYS,
     "angular velocity, rad/s", true},
    {"Figure 8: acceleration without play",
     "Ideal Stack-up",
     "Angular acceleration of coupler and follower for the ideal stack-up mechanism.",
     {"coupler_alpha_rad_s2", "follower_alpha_rad_s2"},
     "angular acceleration, rad/s^2",
     false},
};
enum { CURVE_COUNT = sizeof CURVES / sizeof *CURVES };

// The paper's bands and its beginning, degrees of the crank.
typedef struct Band {
    const char *name;
    double from;
    double to;
} Band;
static const Band BANDS[] = {
    {"in the first 10 deg", 0.0, 10.0},
    {"from 120 to 130 deg", 120.0, 130.0},
    {"from 290 to 300 deg", 290.0, 300.0},
    {"anywhere", 0.0, 360.0},
};
static const char *const CURVE_BODIES[] = {"coupler", "follower"};

static const json_t *row_named(const json_t *result, const char *name)
{
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(result, "extremes"), i, row)
    {
        if (strcmp(html_text_of(row, "row"), name) == 0) {
            return row;
        }
    }
    return NULL;
}

static double number_at(const json_t *curve, const char *key, size_t index)
{
    return json_number_value(json_array_get(json_object_get(curve, key), index));
}

// The largest difference of two curves between two angles of the crank.
static double band_difference(const json_t *curve, const json_t *ideal, const char *key,
                              const Band *band)
{
    double largest = 0.0;
    const size_t count = json_array_size(json_object_get(curve, key));
    for (size_t i = 0; i < count && i < json_array_size(json_object_get(ideal, key)); i++) {
        const double at = number_at(curve, "crank_deg", i);
        const double off = fabs(number_at(curve, key, i) - number_at(ideal, key, i));
        largest = at >= band->from && at <= band->to ? fmax(largest, off) : largest;
    }
    return largest;
}

// How far both bodies are from the same linkage without play, band by band.
static void say_bands(const CurveFigure *figure, const json_t *result, const json_t *curve,
                      Text *words)
{
    const json_t *ideal = json_object_get(row_named(result, "Ideal Nominal"), "curve");
    for (size_t i = 0; json_is_object(ideal) && i < sizeof BANDS / sizeof *BANDS; i++) {
        text_append(words,
                    "Off the ideal velocity by at most %.3g rad/s (coupler) and %.3g rad/s "
                    "(follower) %s.\n",
                    band_difference(curve, ideal, figure->keys[0], &BANDS[i]),
                    band_difference(curve, ideal, figure->keys[1], &BANDS[i]), BANDS[i].name);
    }
}

// How far the extremes are from those of the linkage at its nominal lengths, in percent.
static void say_variation(const CurveFigure *figure, const json_t *result, const json_t *row,
                          Text *words)
{
    const json_t *nominal = json_object_get(row_named(result, "Ideal Nominal"), "recomputed");
    for (int i = 0; json_is_object(nominal) && i < 2; i++) {
        char key[64];
        const bool is_speed = strstr(figure->keys[i], "omega") != NULL;
        snprintf(
            key, sizeof key, "%s_%s", CURVE_BODIES[i],
            NUMBERS[is_speed ? NUMBER_BODY_OMEGA_MAX : NUMBER_BODY_ALPHA_MAX].keys[NUMBER_PUSHED]);
        const double ours = html_number_of(json_object_get(row, "recomputed"), key);
        const double printed = html_number_of(json_object_get(row, "printed"), key);
        text_append(words,
                    "Largest of the %s: %.6g, printed %.6g; %.2g %% from that of the nominal "
                    "lengths.\n",
                    CURVE_BODIES[i], ours, printed,
                    100.0 * fabs(ours / html_number_of(nominal, key) - 1.0));
    }
}

static void append_curves(const CurveFigure *figure, const json_t *result, Text *html)
{
    const json_t *row = row_named(result, figure->row);
    const json_t *curve = json_object_get(row, "curve");
    if (!json_is_object(curve)) {
        return; // of a run that failed, as the table below says
    }
    Drawing drawing = {.title = figure->title,
                       .x_title = "crank turned, deg",
                       .y_title = figure->y_title,
                       .level = NAN};
    for (size_t i = 0; i < 2; i++) {
        DrawLine *line = draw_add(&drawing, CURVE_BODIES[i], plot_style(1, i));
        line->is_bare = true;
        for (size_t k = 0; k < json_array_size(json_object_get(curve, "crank_deg")); k++) {
            draw_point(&drawing, line, number_at(curve, "crank_deg", k),
                       number_at(curve, figure->keys[i], k));
        }
    }
    Text words;
    text_init(&words);
    if (figure->has_play) {
        say_bands(figure, result, curve, &words);
    } else {
        say_variation(figure, result, row, &words);
    }
    write_figure(figure->says, html_text_of(row, "label"), &words, &drawing, html);
}

// Tables VII and VIII, the extremes of these curves.

static void extreme_row(const json_t *row, const char *which, const char *key, Text *html)
{
    text_append(html, "<tr>");
    html_words("th scope=\"row\"", html_text_of(row, "row"), html);
    html_words("td", which, html);
    for (size_t i = 0; i < PRINTED_QUANTITY_COUNT; i++) {
        char column[PRINTED_WORDS_SIZE];
        printed_column_key(i, column);
        html_cell_number_of(json_object_get(row, key), column, "%.6g", html);
    }
    text_append(html, "</tr>\n");
}

static void append_extremes(const json_t *result, Text *html)
{
    enum { BEFORE = 2 };
    char titles[PRINTED_QUANTITY_COUNT][PRINTED_WORDS_SIZE];
    const char *heads[BEFORE + PRINTED_QUANTITY_COUNT] = {"case", "which"};
    for (size_t k = 0; k < PRINTED_QUANTITY_COUNT; k++) {
        printed_column_title(k, titles[k]);
        heads[BEFORE + k] = titles[k];
    }
    text_append(html,
                "<section>\n<h2>Tables VII and VIII: the extremes</h2>\n<p>The curves with the "
                "paper's bands and the forces beside them are in the pages of <code>jointplay "
                "report cases/paper/stackup-poisson.yaml</code> and "
                "<code>stackup-impact.yaml</code>.</p>\n");
    html_table_begin("Tables VII and VIII, rad/s and rad/s^2", BEFORE + PRINTED_QUANTITY_COUNT,
                     heads, html);
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(result, "extremes"), i, row)
    {
        extreme_row(row, "printed", "printed", html);
        extreme_row(row, "recomputed", "recomputed", html);
    }
    html_table_end(html);
    text_append(html, "</section>\n");
}

static void append_paper_answer(const json_t *result, Text *html)
{
    const json_t *physics = json_object_get(result, "physics");
    Text words;
    text_init(&words);
    text_append(&words, "%.0f of %.0f cells of Tables I to III come out as they are printed.\n",
                html_number_of(result, "cells_as_printed"), html_number_of(result, "cell_count"));
    text_append(&words, "At 1000 rpm the pin bears ");
    units_append(&words, html_number_of(physics, "real_force_N"), "N");
    text_append(&words, ", and not the ");
    units_append(&words, html_number_of(physics, "paper_force_N"), "N");
    text_append(&words, " of Table I.\n");
    text_append(html, "<section>\n<h2>The answer</h2>\n");
    html_list(words.data, html);
    text_append(html, "</section>\n");
    text_finish(&words);
}

static void append_typos(const json_t *result, Text *html)
{
    static const char *const HEADS[] = {"where", "~printed", "~read as", "~because"};
    text_append(html, "<section>\n<h2>How it was read</h2>\n");
    html_cards_begin("Places of the paper that need a reading", 4, HEADS, html);
    size_t i;
    json_t *typo;
    json_array_foreach(json_object_get(result, "typos"), i, typo)
    {
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", html_text_of(typo, "where"), html);
        html_cell_headed(HEADS[1], html_text_of(typo, "printed"), html);
        html_cell_headed(HEADS[2], html_text_of(typo, "reading"), html);
        html_cell_headed(HEADS[3], html_text_of(typo, "evidence"), html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
    text_append(html, "</section>\n");
}

static void report_paper_write(const json_t *result, Text *html)
{
    append_paper_answer(result, html);
    for (size_t i = 0; i < FIGURE_COUNT; i++) {
        append_figure(&FIGURES[i], json_array_get(json_object_get(result, "tables"), i),
                      json_object_get(result, "physics"), html);
    }
    for (size_t i = 0; i < CURVE_COUNT; i++) {
        append_curves(&CURVES[i], result, html);
    }
    append_extremes(result, html);
    append_typos(result, html);
}

const ResultKind REPORT_PAPER = {.command = "paper", .key = "typos", .write = report_paper_write};
