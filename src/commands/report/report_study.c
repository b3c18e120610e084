// Writes a page of a study from its store.
#include "commands/report/report_study.h"
#include "base/memory.h"
#include "base/sorted.h"
#include "base/zeroed.h"
#include "casefile/input.h"
#include "commands/report/report_draw.h"
#include "commands/report/report_html.h"
#include "commands/report/report_pack.h"
#include "commands/report/report_result.h"
#include "commands/report/report_shell.h"
#include "commands/report/report_svg.h"
#include "commands/study/store.h"
#include "commands/study/study.h"
#include "commands/study/study_label.h"
#include "commands/study/study_plot.h"
#include "write/json_value.h"
#include "write/units.h"
#include "write/xml.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    SHOWN_MOST = 4,   // results that pictures are drawn of
    KEYS_MOST = 2,    // of numbers, that they are drawn over
    GROUPS_MOST = 8,  // colours of a picture: values of a word
    REASONS_MOST = 8, // of runs that failed
    CELLS_MOST = 40,  // of a map, each way; more values are put into BINS
    BINS = 24,
    SECTIONS_MOST = 6 // columns of a body, see commands/study/metrics.c
};

bool study_page_is_store(const char *path)
{
    static const char OPENING[] = "SQLite format 3";
    char head[sizeof OPENING];
    const size_t size = result_read_head(path, head, sizeof head);
    return size == sizeof head && memcmp(head, OPENING, sizeof head) == 0;
}

bool study_page_is_study(const char *path)
{
    return study_path_is_study(path) && input_is_study(path);
}

// What is drawn of a store.
typedef struct Choice {
    const Layout *layout;
    const Spec *spec;       // of the study file; NULL where there is none
    size_t keys[KEYS_MOST]; // columns of numbers that vary
    bool is_few[KEYS_MOST]; // whether a colour can stand for each of its values
    size_t key_count;
    size_t word; // the first column of words with few values
    bool has_word;
    size_t shown[SHOWN_MOST]; // columns of results
    size_t shown_count;
} Choice;

enum { TITLE_SIZE = STUDY_LABEL_SIZE + CASEFILE_UNIT_SIZE + 4 };

// What a column is, with a capital letter, and with its unit where it is asked for.
static void column_title(const Choice *choice, size_t column, bool has_unit, char title[TITLE_SIZE])
{
    const StudyLabel label = study_label(choice->layout, choice->spec, column);
    snprintf(title, TITLE_SIZE, "%s%s%s", label.words,
             has_unit && label.unit[0] != '\0' ? ", " : "", has_unit ? label.unit : "");
    title[0] = (char)toupper((unsigned char)title[0]);
}

// A value as people read it: in the unit of the study file, or SI with a prefix.
static void append_value(const StudyLabel *label, double value, Text *text)
{
    if (label->per_si != 1.0 || label->unit[0] == '\0') {
        text_append(text, "%.5g%s%s", value * label->per_si, label->unit[0] != '\0' ? " " : "",
                    label->unit);
    } else {
        units_append(text, value, label->unit);
    }
}

static bool ends_in(const char *name, const char *ending)
{
    const size_t length = strlen(name);
    const size_t tail = strlen(ending);
    return length >= tail && strcmp(name + length - tail, ending) == 0;
}

static bool choose_keys(Store *store, Choice *choice, Err *err)
{
    Cell values[GROUPS_MOST];
    for (size_t i = 0; i < choice->layout->setting_count; i++) {
        size_t count = 0;
        if (!store_values(store, i, GROUPS_MOST, values, &count, err)) {
            return false;
        }
        const bool is_word = choice->layout->settings[i].kind == COLUMN_WORD;
        if (count < 2) {
            continue;
        }
        if (!is_word && choice->key_count < KEYS_MOST) {
            choice->is_few[choice->key_count] = count <= GROUPS_MOST;
            choice->keys[choice->key_count++] = i;
        } else if (is_word && !choice->has_word && count <= GROUPS_MOST) {
            choice->word = i;
            choice->has_word = true;
        }
    }
    return true;
}

// Results that people ask for first, and then those that vary most.
static bool choose_results(Store *store, Choice *choice, Err *err)
{
    // how the columns end, and below which size one is nothing but rounding
    static const struct {
        const char *ending;
        double least;
    } WANTED[] = {{"_settled_force_N", 0.0},   {"_force_max_N", 0.0}, {"settled_growth", 0.0},
                  {"alpha_peak_rad_s2", 1e-6}, {"error_max", 0.0},    {"_penetration_max_m", 0.0},
                  {"_omega_max_rad_s", 1e-6}};
    const size_t first = choice->layout->setting_count;
    StoreSpread chosen[SHOWN_MOST];
    for (size_t k = 0; k < sizeof WANTED / sizeof *WANTED; k++) {
        for (size_t i = 0; i < choice->layout->result_count; i++) {
            StoreSpread spread;
            if (choice->shown_count == SHOWN_MOST ||
                !ends_in(choice->layout->results[i].name, WANTED[k].ending)) {
                continue;
            }
            if (!store_spread(store, first + i, &spread, err)) {
                return false;
            }
            // a motion that repeats each revolution has one largest force
            bool is_told = false;
            for (size_t n = 0; n < choice->shown_count; n++) {
                is_told = is_told || store_spreads_alike(&chosen[n], &spread);
            }
            if (!is_told && spread.count > 1 && spread.most > spread.least &&
                fmax(fabs(spread.most), fabs(spread.least)) > WANTED[k].least) {
                chosen[choice->shown_count] = spread;
                choice->shown[choice->shown_count++] = first + i;
            }
        }
    }
    return true;
}

// The answer: what came of the runs.

static void append_count(const StoreCount *count, Text *html)
{
    const bool is_good = count->outcomes[RUN_OUTCOME_OK] == count->rows;
    text_append(html,
                "<section>\n<h2>The answer</h2>\n<p>%" PRIu64 " of %" PRIu64
                " runs are over%s; they took %.3g s in all.</p>\n",
                count->rows, count->run_count, is_good ? ", and all went well" : "", count->wall_s);
    if (is_good) {
        return;
    }
    static const char *const HEADS[] = {"outcome", "runs"};
    html_table_begin("What became of the runs", 2, HEADS, html);
    for (int i = 0; i < RUN_OUTCOME_COUNT; i++) {
        if (count->outcomes[i] > 0) {
            text_append(html, "<tr>");
            html_words("th scope=\"row\"", RUN_OUTCOME_WORDS[i], html);
            text_append(html, "<td>%" PRIu64 "</td></tr>\n", count->outcomes[i]);
        }
    }
    html_table_end(html);
}

static bool append_reasons(Store *store, Text *html, Err *err)
{
    static const char *const HEADS[] = {"outcome", "runs", "such as run", "~why"};
    StoreReason reasons[REASONS_MOST];
    size_t count = 0;
    if (!store_reasons(store, REASONS_MOST, reasons, &count, err)) {
        return false;
    }
    if (count > 0) {
        html_cards_begin("Why runs have no result", 4, HEADS, html);
    }
    for (size_t i = 0; i < count; i++) {
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", RUN_OUTCOME_WORDS[reasons[i].outcome], html);
        text_append(html,
                    "<td data-head=\"runs\">%" PRIu64 "</td><td data-head=\"such as run\">%" PRIu64
                    "</td>",
                    reasons[i].count, reasons[i].example);
        html_cell_headed(HEADS[3], reasons[i].reason, html);
        text_append(html, "</tr>\n");
    }
    if (count > 0) {
        html_table_end(html);
    }
    return true;
}

static void append_spread_cell(const StudyLabel *label, double value, Text *html)
{
    Text words;
    text_init(&words);
    if (label == NULL) {
        text_append(&words, "%.4g", value);
    } else {
        append_value(label, value, &words);
    }
    html_words("td", words.data, html);
    text_finish(&words);
}

// A row of the distribution of a column of numbers; nothing of one that has none. Values have the
// units of a label or, where that is NULL, SI without a word.
static bool spread_row(Store *store, size_t column, const char *name, const StudyLabel *label,
                       Text *html, Err *err)
{
    StoreSpread spread;
    if (!store_spread(store, column, &spread, err)) {
        return false;
    }
    if (spread.count > 0) {
        const double values[] = {spread.least, spread.low, spread.median, spread.high, spread.most};
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", name, html);
        text_append(html, "<td>%" PRIu64 "</td>", spread.count);
        for (size_t k = 0; k < 5; k++) {
            append_spread_cell(label, values[k], html);
        }
        text_append(html, "</tr>\n");
    }
    return true;
}

static const char *const SPREAD_HEADS[] = {"number", "runs", "least", "5 %",
                                           "median", "95 %", "most"};

// What was varied, from where to where.
static bool append_varied(Store *store, const Choice *choice, Text *html, Err *err)
{
    bool is_read = true;
    if (choice->key_count == 0) {
        return true;
    }
    static const char *const HEADS[] = {"key", "from", "to"};
    html_table_begin("What was varied", 3, HEADS, html);
    for (size_t i = 0; i < choice->key_count && is_read; i++) {
        char title[TITLE_SIZE];
        StoreSpread spread;
        const StudyLabel label = study_label(choice->layout, choice->spec, choice->keys[i]);
        column_title(choice, choice->keys[i], false, title);
        is_read = store_spread(store, choice->keys[i], &spread, err);
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", title, html);
        append_spread_cell(&label, is_read ? spread.least : NAN, html);
        append_spread_cell(&label, is_read ? spread.most : NAN, html);
        text_append(html, "</tr>\n");
    }
    html_table_end(html);
    return is_read;
}

// Of the results that pictures are drawn of.
static bool append_main_spreads(Store *store, const Choice *choice, Text *html, Err *err)
{
    bool is_read = append_varied(store, choice, html, err);
    html_table_begin("The main results over all runs that went well", 7, SPREAD_HEADS, html);
    for (size_t i = 0; i < choice->shown_count && is_read; i++) {
        char title[TITLE_SIZE];
        const StudyLabel label = study_label(choice->layout, choice->spec, choice->shown[i]);
        column_title(choice, choice->shown[i], false, title);
        is_read = spread_row(store, choice->shown[i], title, &label, html, err);
    }
    html_table_end(html);
    text_append(html, "</section>\n");
    return is_read;
}

static bool append_all_spreads(Store *store, const Layout *layout, Text *html, Err *err)
{
    bool is_read = true;
    text_append(html,
                "<section>\n<h2>All results</h2>\n<details><summary>The distribution of every "
                "number</summary>\n");
    html_table_begin(
        "Every setting and result that is a number, by the names of 'jointplay study export', in "
        "SI units",
        7, SPREAD_HEADS, html);
    const size_t count = layout->setting_count + layout->result_count;
    for (size_t i = 0; i < count && is_read; i++) {
        const Column *column = store_column_at(layout, i);
        if (column->kind != COLUMN_WORD) {
            is_read = spread_row(store, i, column->name, NULL, html, err);
        }
    }
    html_table_end(html);
    text_append(html, "</details>\n</section>\n");
    return is_read;
}

// Pictures of one result: over a key, or how often its values occur.
static bool append_plot(Store *store, const Choice *choice, const StudyPlot *plot, Text *html,
                        Err *err)
{
    Text svg;
    text_init(&svg);
    Err own = {ERR_NONE, ""};
    const bool is_drawn = study_plot_write(store, plot, choice->spec, &svg, &own);
    if (is_drawn) {
        svg_embed(svg.data, plot->title, html);
    }
    text_finish(&svg);
    // a picture that has nothing to show is left out
    return is_drawn || own.kind != ERR_FILE || err_set(err, ERR_FILE, "%s", own.text);
}

// Maps of a result over two keys.

typedef struct Cells {
    const Choice *choice;
    size_t column; // of the result
    size_t count;
    double *values[3]; // of both keys and the result; owned
} Cells;

static double value_of(const Layout *layout, const Record *record, size_t column)
{
    return column < layout->setting_count ? record->settings[column].number
                                          : record->results[column - layout->setting_count];
}

static bool take_cell(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)err;
    Cells *cells = context;
    const size_t columns[3] = {cells->choice->keys[0], cells->choice->keys[1], cells->column};
    double values[3];
    for (size_t i = 0; i < 3; i++) {
        values[i] = value_of(layout, record, columns[i]);
        if (record->outcome != RUN_OUTCOME_OK || !isfinite(values[i])) {
            return true;
        }
    }
    for (size_t i = 0; i < 3; i++) {
        cells->values[i] =
            memory_grown(cells->values[i], cells->count + 1, sizeof *cells->values[i]);
        cells->values[i][cells->count] = values[i];
    }
    cells->count++;
    return true;
}

static int compare_numbers(const void *a, const void *b)
{
    const double left = *(const double *)a;
    const double right = *(const double *)b;
    return (left > right) - (left < right);
}

// The steps of one side of a map: each value where there are few, else equal parts.
typedef struct Side {
    bool is_binned;
    bool is_log;
    size_t count;
    double values[CELLS_MOST]; // of each step; of bins their lower ends
    double low;
    double high;
} Side;

static Side side_of(const double *values, size_t count)
{
    Side side = {0};
    double *sorted = zeroed(count, sizeof *sorted);
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare_numbers);
    side.low = sorted[0];
    side.high = sorted[count - 1];
    side.is_log = side.low > 0.0 && side.high > 30.0 * side.low;
    size_t different = 0;
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || sorted[i] != sorted[i - 1]) {
            if (different < CELLS_MOST) {
                side.values[different] = sorted[i];
            }
            different++;
        }
    }
    side.is_binned = different > CELLS_MOST;
    side.count = side.is_binned ? BINS : different;
    for (size_t i = 0; i < side.count && side.is_binned; i++) {
        const double share = (double)i / BINS;
        side.values[i] = side.is_log ? side.low * pow(side.high / side.low, share)
                                     : side.low + share * (side.high - side.low);
    }
    free(sorted);
    return side;
}

static size_t step_of(const Side *side, double value)
{
    size_t step = 0;
    while (step + 1 < side->count && value >= side->values[step + 1]) {
        step++;
    }
    return step;
}

// A part of the palette viridis as #rrggbb, dark for little.
static void heat_colour(double share, char colour[8])
{
    static const double STOPS[5][3] = {{68.0, 1.0, 84.0},
                                       {59.0, 82.0, 139.0},
                                       {33.0, 145.0, 140.0},
                                       {94.0, 201.0, 98.0},
                                       {253.0, 231.0, 37.0}};
    const double at = 4.0 * fmax(0.0, fmin(1.0, share));
    const int first = at < 3.0 ? (int)at : 3;
    int mixed[3];
    for (int i = 0; i < 3; i++) {
        mixed[i] =
            (int)lround(STOPS[first][i] + (at - first) * (STOPS[first + 1][i] - STOPS[first][i]));
    }
    snprintf(colour, 8, "#%02x%02x%02x", mixed[0] & 0xff, mixed[1] & 0xff, mixed[2] & 0xff);
}

static const double MAP_LEFT = 84.0; // pixels, as all that follow
static const double MAP_TOP = 64.0;
static const double MAP_WIDTH = 336.0;
static const double MAP_HEIGHT = 320.0;
static const double MAP_PICTURE = 440.0;
static const double MAP_PICTURE_WIDTH = 560.0;
static const double MAP_SCALE_LEFT = 434.0;

static void append_rect(double x, double y, double width, double height, const char *colour,
                        const char *title, Text *svg)
{
    text_append(svg,
                "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"><title>", x,
                y, width, height, colour);
    xml_append(title, svg);
    text_append(svg, "</title></rect>\n");
}

// How many digits tell the values of a side apart.
static int side_digits(const Side *side, double per_si)
{
    for (int digits = 3; digits < 9; digits++) {
        bool is_told = true;
        for (size_t i = 1; i < side->count && is_told; i++) {
            char words[2][32];
            for (size_t k = 0; k < 2; k++) {
                snprintf(words[k], sizeof words[k], "%.*g", digits, per_si * side->values[i - k]);
            }
            is_told = strcmp(words[0], words[1]) != 0;
        }
        if (is_told) {
            return digits;
        }
    }
    return 9;
}

// Some of the values of a side beside their steps, in the unit of its key.
static void append_ticks(const Side *side, const StudyLabel *label, bool is_x, Text *svg)
{
    const size_t stride = 1 + (side->count - 1) / (is_x ? 6 : 8);
    const int digits = side_digits(side, label->per_si);
    for (size_t i = 0; i < side->count; i += stride) {
        char words[32];
        snprintf(words, sizeof words, "%.*g", digits, label->per_si * side->values[i]);
        const double at = ((double)i + 0.5) / (double)side->count;
        if (is_x) {
            plot_text(svg, MAP_LEFT + at * MAP_WIDTH, MAP_TOP + MAP_HEIGHT + 18.0, "middle", "",
                      words);
        } else {
            plot_text(svg, MAP_LEFT - 8.0, MAP_TOP + (1.0 - at) * MAP_HEIGHT + 4.0, "end", "",
                      words);
        }
    }
}

// The colours from the least median to the largest.
static void append_scale(const StudyLabel *label, double low, double high, bool is_log, Text *svg)
{
    enum { PARTS = 40 };
    for (int i = 0; i < PARTS; i++) {
        char colour[8];
        heat_colour((double)i / (PARTS - 1), colour);
        append_rect(MAP_SCALE_LEFT, MAP_TOP + MAP_HEIGHT * (1.0 - (double)(i + 1) / PARTS), 24.0,
                    MAP_HEIGHT / PARTS + 0.5, colour, "", svg);
    }
    const double ends[] = {high, low};
    for (int i = 0; i < 2; i++) {
        Text words;
        text_init(&words);
        append_value(label, ends[i], &words);
        plot_text(svg, MAP_SCALE_LEFT + 30.0, MAP_TOP + (i == 0 ? 10.0 : MAP_HEIGHT), "start", "",
                  words.data);
        text_finish(&words);
    }
    plot_text(svg, MAP_SCALE_LEFT, MAP_TOP + MAP_HEIGHT + 18.0, "start", "note",
              is_log ? "logarithmic" : "");
}

// The median of each cell; NaN of an empty one. Owned by the caller.
static double *cell_medians(const Cells *cells, const Side *x, const Side *y)
{
    double *medians = zeroed(x->count * y->count, sizeof *medians);
    double *here = zeroed(cells->count, sizeof *here);
    for (size_t cell = 0; cell < x->count * y->count; cell++) {
        size_t count = 0;
        for (size_t i = 0; i < cells->count; i++) {
            if (step_of(x, cells->values[0][i]) == cell % x->count &&
                step_of(y, cells->values[1][i]) == cell / x->count) {
                here[count++] = cells->values[2][i];
            }
        }
        qsort(here, count, sizeof *here, compare_numbers);
        medians[cell] = count > 0 ? sorted_median(here, count) : NAN;
    }
    free(here);
    return medians;
}

static void draw_cells(const StudyLabel labels[3], const double *medians, const Side *x,
                       const Side *y, Text *svg)
{
    double low = INFINITY;
    double high = -INFINITY;
    for (size_t i = 0; i < x->count * y->count; i++) {
        low = isfinite(medians[i]) ? fmin(low, medians[i]) : low;
        high = isfinite(medians[i]) ? fmax(high, medians[i]) : high;
    }
    const bool is_log = low > 0.0 && high > 30.0 * low;
    const double width = MAP_WIDTH / (double)x->count;
    const double height = MAP_HEIGHT / (double)y->count;
    for (size_t i = 0; i < x->count * y->count; i++) {
        if (!isfinite(medians[i])) {
            continue;
        }
        const double share = !(high > low) ? 0.5
                             : is_log      ? log(medians[i] / low) / log(high / low)
                                           : (medians[i] - low) / (high - low);
        char colour[8];
        Text words;
        text_init(&words);
        heat_colour(share, colour);
        append_value(&labels[2], medians[i], &words);
        text_append(&words, " at ");
        append_value(&labels[0], x->values[i % x->count], &words);
        text_append(&words, ", ");
        append_value(&labels[1], y->values[i / x->count], &words);
        append_rect(MAP_LEFT + (double)(i % x->count) * width,
                    MAP_TOP + MAP_HEIGHT - (double)(i / x->count + 1) * height, width + 0.3,
                    height + 0.3, colour, words.data, svg);
        text_finish(&words);
    }
    append_scale(&labels[2], low, high, is_log, svg);
}

static void draw_map(const Cells *cells, Text *html)
{
    const Choice *choice = cells->choice;
    const size_t columns[] = {choice->keys[0], choice->keys[1], cells->column};
    StudyLabel labels[3];
    char titles[3][TITLE_SIZE];
    for (size_t i = 0; i < 3; i++) {
        labels[i] = study_label(choice->layout, choice->spec, columns[i]);
        column_title(choice, columns[i], true, titles[i]);
    }
    const Side x = side_of(cells->values[0], cells->count);
    const Side y = side_of(cells->values[1], cells->count);
    double *medians = cell_medians(cells, &x, &y);
    static const char title[] = "Median over both keys";
    Text svg;
    text_init(&svg);
    plot_begin(&svg, MAP_PICTURE_WIDTH, MAP_PICTURE, title);
    plot_text(&svg, MAP_LEFT, 26.0, "start", "title", title);
    draw_cells(labels, medians, &x, &y, &svg);
    append_ticks(&x, &labels[0], true, &svg);
    append_ticks(&y, &labels[1], false, &svg);
    plot_text(&svg, MAP_LEFT + MAP_WIDTH, MAP_TOP + MAP_HEIGHT + 38.0, "end", "note", titles[0]);
    plot_text(&svg, MAP_LEFT, MAP_TOP - 10.0, "start", "note", titles[1]);
    plot_end(&svg);
    svg_embed(svg.data, title, html);
    text_finish(&svg);
    free(medians);
}

static bool append_map(Store *store, const Choice *choice, size_t column, Text *html, Err *err)
{
    Cells cells = {.choice = choice, .column = column};
    const bool is_read = store_each(store, take_cell, &cells, err);
    if (is_read && cells.count > 1) {
        draw_map(&cells, html);
    }
    for (size_t i = 0; i < 3; i++) {
        free(cells.values[i]);
    }
    return is_read;
}

// A result over one of the keys.
static bool append_over(Store *store, const Choice *choice, size_t column, size_t number,
                        Text *html, Err *err)
{
    const Layout *layout = choice->layout;
    // runs of other values of the other key are told apart where there are few
    const size_t other = 1 - number;
    const bool is_told = other < choice->key_count && choice->is_few[other];
    char title[TITLE_SIZE + 8];
    const StudyLabel label = study_label(layout, choice->spec, choice->keys[number]);
    snprintf(title, sizeof title, "Over the %s", label.words);
    const StudyPlot plot = {
        .title = title,
        .x = layout->settings[choice->keys[number]].name,
        .y = store_column_at(layout, column)->name,
        .by = choice->has_word ? layout->settings[choice->word].name
              : is_told        ? layout->settings[choice->keys[other]].name
                               : NULL,
        .is_small = true,
    };
    return append_plot(store, choice, &plot, html, err);
}

static bool append_result(Store *store, const Choice *choice, size_t column, Text *html, Err *err)
{
    const Layout *layout = choice->layout;
    char title[TITLE_SIZE];
    column_title(choice, column, false, title);
    text_append(html, "<section>\n");
    html_words("h2", title, html);
    text_append(html, "<div class=\"pictures\">\n");
    bool is_drawn = true;
    for (size_t i = 0; i < choice->key_count && is_drawn; i++) {
        is_drawn = append_over(store, choice, column, i, html, err);
    }
    const StudyPlot often = {
        .title = "How often its values occur",
        .x = store_column_at(layout, column)->name,
        .by = choice->has_word ? layout->settings[choice->word].name : NULL,
        .is_small = true,
    };
    is_drawn = is_drawn && append_plot(store, choice, &often, html, err);
    if (is_drawn && choice->key_count == KEYS_MOST) {
        is_drawn = append_map(store, choice, column, html, err);
    }
    text_append(html, "</div>\n</section>\n");
    return is_drawn;
}

// The bifurcation picture: the state once a revolution over the key that is swept.

// how the columns end that have the last section of a body
static const char SECTION_RAD[] = "_section_1_rad_s";
static const char SECTION_M[] = "_section_1_m_s";

typedef struct SweptSections {
    size_t key;
    double per_si;
    size_t body; // column of its first section
    Drawing *drawing;
    DrawLine *line;
} SweptSections;

static bool take_sections(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)err;
    const SweptSections *sweep = context;
    for (size_t k = 0; k < SECTIONS_MOST && record->outcome == RUN_OUTCOME_OK; k++) {
        draw_point(sweep->drawing, sweep->line, sweep->per_si * record->settings[sweep->key].number,
                   value_of(layout, record, sweep->body + k));
    }
    return true;
}

// The first section column of the body whose sections differ most; false where there are none.
static bool find_sections(Store *store, const Layout *layout, size_t *found, bool *is_there,
                          Err *err)
{
    double most = 0.0;
    *is_there = false;
    for (size_t i = 0; i < layout->result_count; i++) {
        StoreSpread spread;
        const size_t column = layout->setting_count + i;
        if (!ends_in(layout->results[i].name, SECTION_RAD) &&
            !ends_in(layout->results[i].name, SECTION_M)) {
            continue;
        }
        if (!store_spread(store, column, &spread, err)) {
            return false;
        }
        // over the size, so that speeds and angular speeds compare
        const double size = fmax(fabs(spread.least), fabs(spread.most));
        const double share = size > 0.0 ? (spread.most - spread.least) / size : 0.0;
        if (spread.count > 1 && share > most) {
            most = share;
            *found = column;
            *is_there = true;
        }
    }
    return true;
}

static bool append_bifurcation(Store *store, const Choice *choice, Text *html, Err *err)
{
    size_t column = 0;
    bool is_there = false;
    if (choice->key_count == 0) {
        return true;
    }
    if (!find_sections(store, choice->layout, &column, &is_there, err)) {
        return false;
    }
    if (!is_there) {
        return true;
    }
    // the key of many values is the one that is swept
    const size_t swept = choice->keys[choice->key_count == KEYS_MOST && choice->is_few[0] ? 1 : 0];
    char body[RECORD_NAME_SIZE];
    const char *name = store_column_at(choice->layout, column)->name;
    const bool is_slide = ends_in(name, SECTION_M);
    snprintf(body, sizeof body, "%.*s",
             (int)(strlen(name) - strlen(is_slide ? SECTION_M : SECTION_RAD)), name);
    char title[2 * RECORD_NAME_SIZE];
    snprintf(title, sizeof title, "%s once a revolution, at one crank angle", body);
    char x_title[TITLE_SIZE];
    column_title(choice, swept, true, x_title);
    Drawing drawing = {.title = title,
                       .x_title = x_title,
                       .y_title = is_slide ? "velocity, m/s" : "angular velocity, rad/s",
                       .level = NAN};
    DrawLine *line = draw_add(&drawing, "the last revolutions", plot_style(1, 0));
    line->is_dots = true;
    const double per_si = study_label(choice->layout, choice->spec, swept).per_si;
    const SweptSections sweep = {swept, per_si, column, &drawing, line};
    text_append(html, "<section>\n<h2>Bifurcation</h2>\n<p>The velocity at the end of each "
                      "of the last revolutions of a run, up to six. Where a motion repeats every "
                      "revolution the dots of a value fall on one; where its period doubles, on "
                      "two.</p>\n");
    const bool is_read = store_each(store, take_sections, (void *)&sweep, err);
    draw_end(&drawing, html);
    text_append(html, "</section>\n");
    return is_read;
}

// The page.

static bool append_contents(Store *store, const Spec *spec, Text *html, Err *err)
{
    Choice choice = {.layout = store_layout(store), .spec = spec};
    StoreCount count;
    if (!store_count(store, &count, err) || !choose_keys(store, &choice, err) ||
        !choose_results(store, &choice, err)) {
        return false;
    }
    append_count(&count, html);
    bool is_written =
        append_reasons(store, html, err) && append_main_spreads(store, &choice, html, err);
    for (size_t i = 0; i < choice.shown_count && is_written; i++) {
        is_written = append_result(store, &choice, choice.shown[i], html, err);
    }
    return is_written && append_bifurcation(store, &choice, html, err) &&
           append_all_spreads(store, choice.layout, html, err);
}

// What the page carries: what the answer counts.
static bool append_store_data(Store *store, const char *path, Text *data, Err *err)
{
    StoreCount count;
    if (!store_count(store, &count, err)) {
        return false;
    }
    json_t *object = json_object();
    json_t *outcomes = json_object();
    for (int i = 0; i < RUN_OUTCOME_COUNT; i++) {
        json_object_set_new(outcomes, RUN_OUTCOME_WORDS[i],
                            json_integer((json_int_t)count.outcomes[i]));
    }
    json_t *result = json_object();
    json_object_set_new(result, "store", json_value_text(path));
    json_object_set_new(result, "runs", json_integer((json_int_t)count.run_count));
    json_object_set_new(result, "done", json_integer((json_int_t)count.rows));
    json_object_set_new(result, "outcomes", outcomes);
    json_object_set_new(object, "stem", json_string("study"));
    json_object_set_new(object, "runs", json_array());
    json_object_set_new(object, "results", result);
    Text json;
    text_init(&json);
    Pack pack = {0};
    json_value_write(object, JSON_COMPACT, &json);
    pack_write(&pack, json.data, data);
    pack_finish(&pack);
    text_finish(&json);
    json_decref(object);
    return true;
}

// The study file of a store, where one of its name is beside it and says the same; else NULL.
static Spec *find_spec(Store *store, const char *path)
{
    static const char ENDING[] = ".sqlite";
    const size_t stem = strlen(path) - (ends_in(path, ENDING) ? strlen(ENDING) : 0);
    char name[FILE_PATH_SIZE];
    char print[32];
    Err unread = {ERR_NONE, ""};
    if (snprintf(name, sizeof name, "%.*s.yaml", (int)stem, path) >= (int)sizeof name ||
        access(name, R_OK) != 0) {
        return NULL;
    }
    Spec *spec = spec_open(name, &unread);
    const char *own = store_key(store, "study");
    snprintf(print, sizeof print, "%016" PRIx64, spec != NULL ? spec->print : 0);
    if (spec != NULL && (own == NULL || strcmp(own, print) != 0)) {
        spec_close(spec);
        return NULL;
    }
    return spec;
}

// Its title, or the name of the store.
static void study_title(const Spec *spec, const char *path, char title[SPEC_TEXT_SIZE])
{
    const char *slash = strrchr(path, '/');
    if (spec != NULL && spec->title[0] != '\0') {
        snprintf(title, SPEC_TEXT_SIZE, "%s", spec->title);
    } else {
        snprintf(title, SPEC_TEXT_SIZE, "Study %.200s", slash != NULL ? slash + 1 : path);
    }
}

static bool append_store_page(Store *store, const char *path, const Spec *spec, const char *command,
                              Text *html, Err *err)
{
    char title[SPEC_TEXT_SIZE];
    char note[2 * FILE_PATH_SIZE + 8];
    study_title(spec, path, title);
    snprintf(note, sizeof note, "%s%s%s", spec != NULL ? spec->path : "",
             spec != NULL ? ", kept in " : "", path);
    Shell shell = shell_create(SHELL_RESULT, title, note);
    Text data;
    text_init(&data);
    shell_begin(&shell, html);
    const bool is_written =
        append_contents(store, spec, html, err) && append_store_data(store, path, &data, err);
    result_made_write(NULL, command, html);
    shell_end(&shell, data.data, html);
    text_finish(&data);
    shell_finish(&shell);
    return is_written;
}

bool study_page_write(const char *word, const char *command, Text *html, Err *err)
{
    char path[FILE_PATH_SIZE];
    const bool is_store = study_page_is_store(word);
    if (!is_store && !study_path_find(word, path, err)) {
        return false;
    }
    Spec *spec = is_store ? NULL : spec_open(word, err);
    Store *store = is_store || spec != NULL ? store_view(is_store ? word : path, err) : NULL;
    if (store == NULL) {
        spec_close(spec);
        return false;
    }
    spec = spec != NULL ? spec : find_spec(store, word);
    const bool is_written =
        append_store_page(store, is_store ? word : path, spec, command, html, err);
    Err closing = {ERR_NONE, ""};
    const bool is_closed = store_close(store, is_written ? err : &closing);
    spec_close(spec);
    return is_closed && is_written;
}
