// Draws one column of a study over another as SVG.
//
// Where x takes a few values that runs share, as on a grid, the median of each is a point of a
// line, and the band about it holds nine runs of ten. Else each run is a dot.
#include "commands/study/study_plot.h"
#include "base/sorted.h"
#include "base/text.h"
#include "commands/study/study_label.h"
#include "write/plot.h"
#include "write/units.h"

#include <assert.h>
#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The points of the picture.

enum { FIRST_ROOM = 1024 };

typedef struct Gathering {
    StudyPoints *points;
    size_t room;
    size_t x;
    size_t y;
    bool has_y;
    bool has_by;
} Gathering;

static double study_plot_number_of(const Layout *layout, const Record *record, size_t column)
{
    return column < layout->setting_count ? record->settings[column].number
                                          : record->results[column - layout->setting_count];
}

static size_t study_plot_group_of(const StudyPoints *points, const Layout *layout,
                                  const Record *record)
{
    const Cell *value = &record->settings[points->by];
    const bool is_word = layout->settings[points->by].kind == COLUMN_WORD;
    for (size_t i = 0; i < points->group_count; i++) {
        if (is_word ? strcmp(value->word, points->groups[i].word) == 0
                    : value->number == points->groups[i].number) {
            return i;
        }
    }
    return points->group_count;
}

static bool study_plot_take_row(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)err;
    Gathering *gathering = context;
    StudyPoints *points = gathering->points;
    const StudyPoint point = {
        .x = study_plot_number_of(layout, record, gathering->x),
        .y = gathering->has_y ? study_plot_number_of(layout, record, gathering->y) : 0.0,
        .group = gathering->has_by ? study_plot_group_of(points, layout, record) : 0,
    };
    const bool is_point = record->outcome == RUN_OUTCOME_OK && isfinite(point.x) &&
                          isfinite(point.y) && point.group < points->group_count;
    if (!is_point) {
        points->left_out++;
        return true;
    }
    if (points->count == gathering->room) {
        gathering->room = gathering->room == 0 ? FIRST_ROOM : 2 * gathering->room;
        points->points = realloc(points->points, gathering->room * sizeof *points->points);
        assert(points->points != NULL);
    }
    points->points[points->count++] = point;
    return true;
}

static int compare_points(const void *a, const void *b)
{
    const StudyPoint *left = a;
    const StudyPoint *right = b;
    if (left->group != right->group) {
        return left->group < right->group ? -1 : 1;
    }
    const int by_x = sorted_compare(&left->x, &right->x);
    return by_x != 0 ? by_x : sorted_compare(&left->y, &right->y);
}

static size_t count_x(const StudyPoints *points)
{
    double *x = malloc((points->count + 1) * sizeof *x);
    assert(x != NULL);
    for (size_t i = 0; i < points->count; i++) {
        x[i] = points->points[i].x;
    }
    sorted_make(x, points->count);
    size_t count = 0;
    for (size_t i = 0; i < points->count; i++) {
        count += i == 0 || x[i] != x[i - 1] ? 1 : 0;
    }
    free(x);
    return count;
}

static void study_plot_put_in_order(StudyPoints *points)
{
    qsort(points->points, points->count, sizeof *points->points, compare_points);
    size_t i = 0;
    for (size_t group = 0; group < points->group_count; group++) {
        points->first[group] = i;
        while (i < points->count && points->points[i].group == group) {
            i++;
        }
    }
    points->first[points->group_count] = i;
    points->x_count = count_x(points);
}

typedef enum Wanted {
    NUMBER,  // a column of settings or results, not of words
    SETTING, // a column of settings alone
} Wanted;

// Finds a column by name. Fails with ERR_USAGE, naming the one that may have been meant.
static bool study_plot_find_column(const Layout *layout, const char *name, Wanted wanted,
                                   size_t *column, Err *err)
{
    const char *names[RECORD_SETTING_MAX + RECORD_RESULT_MAX];
    const size_t all = layout->setting_count + layout->result_count;
    const size_t count = wanted == SETTING ? layout->setting_count : all;
    for (size_t i = 0; i < count; i++) {
        names[i] = store_column_at(layout, i)->name;
    }
    *column = store_column(layout, name);
    if (*column >= count) {
        const char *nearest = text_nearest(name, names, count);
        return err_set(err, ERR_USAGE, "the study has no %s '%s'%s%s%s",
                       wanted == SETTING ? "setting" : "column", name,
                       nearest == NULL ? "" : "; did you mean '", nearest == NULL ? "" : nearest,
                       nearest == NULL ? "" : "'?");
    }
    return wanted == SETTING || store_column_at(layout, *column)->kind != COLUMN_WORD ||
           err_set(err, ERR_USAGE, "the column %s holds words, and numbers are wanted", name);
}

static bool study_plot_find_groups(Store *store, const char *by, StudyPoints *points, Err *err)
{
    points->group_count = 1;
    if (by == NULL) {
        return true;
    }
    return study_plot_find_column(store_layout(store), by, SETTING, &points->by, err) &&
           store_values(store, points->by, STUDY_GROUP_MAX, points->groups, &points->group_count,
                        err) &&
           (points->group_count <= STUDY_GROUP_MAX ||
            err_set(err, ERR_USAGE, "%s has more than %d values, too many to tell apart", by,
                    STUDY_GROUP_MAX));
}

bool study_points_read(Store *store, const char *x, const char *y, const char *by,
                       StudyPoints *points, Err *err)
{
    const Layout *layout = store_layout(store);
    *points = (StudyPoints){0};
    Gathering gathering = {.points = points, .has_y = y != NULL, .has_by = by != NULL};
    bool is_read = study_plot_find_column(layout, x, NUMBER, &gathering.x, err) &&
                   (y == NULL || study_plot_find_column(layout, y, NUMBER, &gathering.y, err)) &&
                   study_plot_find_groups(store, by, points, err) &&
                   store_each(store, study_plot_take_row, &gathering, err);
    if (is_read && points->count == 0) {
        is_read = err_set(err, ERR_USAGE, "no run of the study has a number in %s%s%s", x,
                          y == NULL ? "" : " and in ", y == NULL ? "" : y);
    }
    if (!is_read) {
        study_points_finish(points);
        return false;
    }
    study_plot_put_in_order(points);
    return true;
}

void study_points_finish(StudyPoints *points)
{
    free(points->points);
    *points = (StudyPoints){0};
}

// The points from a number on that share its x and its group: the number of the first that does
// not.
static size_t study_points_pile(const StudyPoints *points, size_t first)
{
    const StudyPoint *point = &points->points[first];
    size_t end = first + 1;
    while (end < points->count && points->points[end].group == point->group &&
           points->points[end].x == point->x) {
        end++;
    }
    return end;
}

// How many digits tell the values of the groups apart.
static int group_digits(const StudyPoints *points, double per_si)
{
    for (int digits = 4; digits < 9; digits++) {
        bool is_told = true;
        for (size_t i = 1; i < points->group_count && is_told; i++) {
            char words[2][32];
            for (size_t k = 0; k < 2; k++) {
                snprintf(words[k], sizeof words[k], "%.*g", digits,
                         per_si * points->groups[i - k].number);
            }
            is_told = strcmp(words[0], words[1]) != 0;
        }
        if (is_told) {
            return digits;
        }
    }
    return 9;
}

// The value that a group has in its column, with its unit.
static void study_points_group_name(const StudyPoints *points, const Layout *layout,
                                    const StudyLabel *label, size_t group,
                                    char words[RECORD_WORD_SIZE])
{
    if (layout->settings[points->by].kind == COLUMN_WORD) {
        text_copy(words, RECORD_WORD_SIZE, points->groups[group].word);
    } else {
        snprintf(words, RECORD_WORD_SIZE, "%.*g%s%s", group_digits(points, label->per_si),
                 label->per_si * points->groups[group].number, label->unit[0] != '\0' ? " " : "",
                 label->unit);
    }
}

// The histogram of a column.
//
// Bars of one width on the scale of the axis, their number twice the cubic root of that of the
// runs (Rice's rule); of whole numbers that are few, one bar each.

enum { BAR_LEAST = 8, BAR_MOST = 60 };

typedef struct Bars {
    size_t count;
    double low; // on the scale of the axis: the value, or its logarithm
    double width;
    bool is_log;
    double shares[STUDY_GROUP_MAX][BAR_MOST]; // percent of the group
} Bars;

static double study_plot_scaled(const Bars *bars, double value)
{
    return bars->is_log ? log10(value) : value;
}

static double edge(const Bars *bars, size_t i)
{
    const double value = bars->low + bars->width * (double)i;
    return bars->is_log ? pow(10.0, value) : value;
}

static void choose_bars(const StudyPoints *points, const Column *column, const Axis *axis,
                        Bars *bars)
{
    bars->is_log = axis->scale == AXIS_LOG;
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < points->count; i++) {
        low = fmin(low, study_plot_scaled(bars, points->points[i].x));
        high = fmax(high, study_plot_scaled(bars, points->points[i].x));
    }
    const bool is_whole =
        column->kind == COLUMN_WHOLE && !bars->is_log && high - low < BAR_MOST - 1;
    const double wanted = ceil(2.0 * cbrt((double)points->count));
    bars->count = is_whole             ? (size_t)(high - low) + 1
                  : wanted < BAR_LEAST ? BAR_LEAST
                  : wanted > BAR_MOST  ? BAR_MOST
                                       : (size_t)wanted;
    if (is_whole || !(high > low)) {
        bars->low = low - 0.5;
        bars->width = 1.0;
        bars->count = is_whole ? bars->count : 1;
    } else {
        bars->low = low;
        bars->width = (high - low) / (double)bars->count;
    }
}

static void fill_bars(const StudyPoints *points, Bars *bars)
{
    for (size_t group = 0; group < points->group_count; group++) {
        const size_t runs = points->first[group + 1] - points->first[group];
        for (size_t i = points->first[group]; i < points->first[group + 1]; i++) {
            const double place =
                (study_plot_scaled(bars, points->points[i].x) - bars->low) / bars->width;
            const size_t bar =
                place < (double)bars->count ? (size_t)fmax(place, 0.0) : bars->count - 1;
            bars->shares[group][bar] += UNITS_PERCENT / (double)runs;
        }
    }
}

// One outline about the bars of a group, filled so faintly that groups show through each other.
static void draw_outline(const PlotPanel *panel, const Bars *bars, size_t group, PlotStyle style)
{
    text_append(panel->svg,
                "<path fill=\"%s\" fill-opacity=\"0.16\" stroke=\"%s\" stroke-width=\"%g\" "
                "d=\"M%.1f %.1f",
                style.colour, style.colour, style.width, plot_x(panel, edge(bars, 0)),
                plot_y(panel, 0.0));
    for (size_t i = 0; i < bars->count; i++) {
        text_append(panel->svg, "V%.1fH%.1f", plot_y(panel, bars->shares[group][i]),
                    plot_x(panel, edge(bars, i + 1)));
    }
    text_append(panel->svg, "V%.1f\"/>\n", plot_y(panel, 0.0));
}

static const double NOTE_CHARACTER = 7.5; // pixels, at the most of the labels below
static const double NOTE_MARGIN = 4.0;    // pixels, between a line and its label

// The points of one group are in the order of x.
static void draw_quantile(const PlotPanel *panel, const StudyPoints *points, double share,
                          const char *name)
{
    static const PlotStyle STYLE = {"#555555", 1.2, 1.0, "5 4"};
    const SortedPlace place = sorted_place(points->count, share);
    const StudyPoint *below = &points->points[place.below];
    const StudyPoint *above = place.beyond > 0.0 ? below + 1 : below;
    const double value = sorted_between(below->x, above->x, place.beyond);
    const double x[] = {value, value};
    const double y[] = {panel->y.low, panel->y.high};
    char words[64];
    plot_line(panel, 2, x, y, STYLE);
    snprintf(words, sizeof words, "%s %.4g", name, value);
    // one label above the other, for they may stand close together, and all within the panel
    const double at = plot_x(panel, value);
    const double room = NOTE_CHARACTER * (double)strlen(words) + NOTE_MARGIN;
    const bool is_last = at > panel->left + panel->width - room;
    plot_text(panel->svg, at + (is_last ? -NOTE_MARGIN : NOTE_MARGIN),
              panel->top + 16.0 + 32.0 * fabs(share - 0.5), is_last ? "end" : "start", "note",
              words);
}

void study_histogram_draw(const StudyPoints *points, const Column *column, PlotPanel *panel,
                          PlotStyle (*style_of)(size_t group))
{
    Bars bars = {0};
    choose_bars(points, column, &panel->x, &bars);
    fill_bars(points, &bars);
    double most = 0.0;
    for (size_t group = 0; group < points->group_count; group++) {
        for (size_t i = 0; i < bars.count; i++) {
            most = fmax(most, bars.shares[group][i]);
        }
    }
    // room above the bars for what is written there
    panel->y = (Axis){.title = "share of the runs, %", .high = 1.1 * most};
    axis_round(&panel->y.low, &panel->y.high);
    panel->y.low = 0.0;
    // the outer bars are whole, even where all values are one
    panel->x.low = fmin(panel->x.low, edge(&bars, 0));
    panel->x.high = fmax(panel->x.high, edge(&bars, bars.count));
    plot_enter(panel);
    for (size_t group = 0; group < points->group_count; group++) {
        draw_outline(panel, &bars, group, style_of(group));
    }
    if (points->group_count == 1) {
        draw_quantile(panel, points, 0.05, "5 %:");
        draw_quantile(panel, points, 0.5, "median");
        draw_quantile(panel, points, 0.95, "95 %:");
    }
    plot_leave(panel);
}

// Where the parts of a picture stand, pixels.
typedef struct Frame {
    double width;
    double height;
    double left; // of the panel, as the next
    double top;
    double panel_width;
    double panel_height;
    double legend_left;
    double legend_top;
} Frame;

static const Frame WIDE = {1000.0, 640.0, 84.0, 84.0, 640.0, 500.0, 748.0, 90.0};
static const double WIDE_ALONE = 880.0; // width of the panel without a legend
// the legend of a small one stands below
static const Frame SMALL = {560.0, 440.0, 84.0, 64.0, 456.0, 320.0, 84.0, 452.0};
static const double LEGEND_ROW = 36.0;
static const double SMALL_ROW = 22.0;
enum { LEGEND_LETTERS = 28 };       // of its title that fit on a line
static const double DOT_CELL = 1.0; // dots nearer than that to each other are one

static const double LOG_SPAN = 30.0; // from that ratio on an axis is logarithmic
enum {
    LINE_X_MAX = 200, // values of x that a line may have
    LINE_SHARE = 2,   // runs that share each of them, on average
    BAND_RUNS = 5,    // runs at one x that have a band
    MANY_DOTS = 2000, // dots from which on they are small
};

static PlotStyle study_plot_style_of(size_t group)
{
    PlotStyle style = plot_style(1, group);
    style.width = 1.8;
    // the palette has six colours
    style.dash = group < 6 ? NULL : "6 4";
    return style;
}

// What the picture says of its columns, and the words on its axes.
typedef struct PlotWords {
    StudyLabel x;
    StudyLabel y;
    StudyLabel by;
    char x_title[STUDY_LABEL_SIZE + CASEFILE_UNIT_SIZE + 4];
    char y_title[STUDY_LABEL_SIZE + CASEFILE_UNIT_SIZE + 4];
} PlotWords;

static StudyLabel find_label(const Layout *layout, const Spec *spec, const char *name)
{
    return name != NULL ? study_label(layout, spec, store_column(layout, name))
                        : (StudyLabel){.per_si = 1.0};
}

static void write_title(const StudyLabel *label, char *title, size_t size)
{
    snprintf(title, size, "%s%s%s", label->words, label->unit[0] != '\0' ? ", " : "", label->unit);
}

// Of a plot whose columns are there.
static void find_words(const Layout *layout, const Spec *spec, const StudyPlot *plot,
                       PlotWords *words)
{
    words->x = find_label(layout, spec, plot->x);
    words->y = find_label(layout, spec, plot->y);
    words->by = find_label(layout, spec, plot->by);
}

// Sizes of the largest value of an axis in SI that need no prefix.
static const double PLAIN_LEAST = 0.1;
static const double PLAIN_MOST = 1e4;

// Gives the unit of a result a prefix where its values are small or large. A unit of the study file
// stays as it is, and so do those that begin with a prefix.
static void give_prefix(StudyLabel *label, double largest)
{
    const bool is_plain = largest >= PLAIN_LEAST && largest < PLAIN_MOST;
    if (label->unit[0] == '\0' || label->unit[0] == 'k' || label->per_si != 1.0 || is_plain) {
        return;
    }
    char unit[CASEFILE_UNIT_SIZE];
    snprintf(unit, sizeof unit, "%s", label->unit);
    const char *prefix = units_prefix(largest, &label->per_si);
    snprintf(label->unit, sizeof label->unit, "%s%s", prefix, unit);
}

// From SI to the units that are shown.
static void convert(PlotWords *words, StudyPoints *points)
{
    double largest_x = 0.0;
    double largest_y = 0.0;
    for (size_t i = 0; i < points->count; i++) {
        largest_x = fmax(largest_x, fabs(points->points[i].x));
        largest_y = fmax(largest_y, fabs(points->points[i].y));
    }
    give_prefix(&words->x, largest_x);
    give_prefix(&words->y, largest_y);
    write_title(&words->x, words->x_title, sizeof words->x_title);
    write_title(&words->y, words->y_title, sizeof words->y_title);
    for (size_t i = 0; i < points->count; i++) {
        points->points[i].x *= words->x.per_si;
        points->points[i].y *= words->y.per_si;
    }
}

static void study_plot_choose_axis(const StudyLabel *label, const char *title, double low,
                                   double high, Axis *axis)
{
    *axis = (Axis){.title = title, .low = low, .high = high};
    const bool is_wide = high > LOG_SPAN * low;
    if (low > 0.0 && (label->is_log || (is_wide && !label->is_linear))) {
        axis->scale = AXIS_LOG;
        axis_round_log(&axis->low, &axis->high);
    } else {
        axis_round(&axis->low, &axis->high);
    }
}

static void study_plot_choose_axes(const StudyPoints *points, const PlotWords *words, bool has_y,
                                   PlotPanel *panel)
{
    double low_x = INFINITY, high_x = -INFINITY, low_y = INFINITY, high_y = -INFINITY;
    for (size_t i = 0; i < points->count; i++) {
        low_x = fmin(low_x, points->points[i].x);
        high_x = fmax(high_x, points->points[i].x);
        low_y = fmin(low_y, points->points[i].y);
        high_y = fmax(high_y, points->points[i].y);
    }
    study_plot_choose_axis(&words->x, words->x_title, low_x, high_x, &panel->x);
    if (has_y) {
        study_plot_choose_axis(&words->y, words->y_title, low_y, high_y, &panel->y);
    }
}

// A quantile of a pile, whose points are in order.
static double quantile(const StudyPoints *points, size_t first, size_t end, double share)
{
    const SortedPlace place = sorted_place(end - first, share);
    const StudyPoint *below = &points->points[first + place.below];
    const StudyPoint *above = place.beyond > 0.0 ? below + 1 : below;
    return sorted_between(below->y, above->y, place.beyond);
}

static void study_plot_draw_band(const PlotPanel *panel, const StudyPoints *points, size_t group)
{
    Text back;
    text_init(&back);
    text_append(panel->svg, "<path fill=\"%s\" fill-opacity=\"0.16\" d=\"",
                study_plot_style_of(group).colour);
    size_t drawn = 0;
    for (size_t i = points->first[group], end; i < points->first[group + 1]; i = end) {
        end = study_points_pile(points, i);
        if (end - i < BAND_RUNS) {
            continue;
        }
        const double x = plot_x(panel, points->points[i].x);
        text_append(panel->svg, "%c%.1f %.1f", drawn++ == 0 ? 'M' : 'L', x,
                    plot_y(panel, quantile(points, i, end, 0.95)));
        // the way back along the lower edge, its points written from the last to the first
        Text longer;
        text_init(&longer);
        text_append(&longer, "L%.1f %.1f%s", x, plot_y(panel, quantile(points, i, end, 0.05)),
                    back.data);
        text_finish(&back);
        back = longer;
    }
    text_append(panel->svg, "%s%s\"/>\n", back.data, drawn > 0 ? "z" : "");
    text_finish(&back);
}

static void study_plot_draw_dot(const PlotPanel *panel, double x, double y, double radius,
                                double opacity, const char *colour)
{
    text_append(panel->svg,
                "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\" fill-opacity=\"%g\"/>\n", x,
                y, radius, colour, opacity);
}

static void draw_line(const PlotPanel *panel, const StudyPoints *points, size_t group)
{
    double x[LINE_X_MAX];
    double y[LINE_X_MAX];
    size_t count = 0;
    for (size_t i = points->first[group], end; i < points->first[group + 1]; i = end) {
        end = study_points_pile(points, i);
        x[count] = points->points[i].x;
        y[count++] = quantile(points, i, end, 0.5);
    }
    plot_line(panel, count, x, y, study_plot_style_of(group));
    for (size_t i = 0; i < count; i++) {
        study_plot_draw_dot(panel, plot_x(panel, x[i]), plot_y(panel, y[i]), 3.0, 1.0,
                            study_plot_style_of(group).colour);
    }
}

// What lies on a dot already cannot be seen, so that a picture of a million runs stays a picture.
static void study_plot_draw_dots(const PlotPanel *panel, const StudyPoints *points, size_t group)
{
    const size_t columns = (size_t)(panel->width / DOT_CELL) + 1;
    const size_t rows = (size_t)(panel->height / DOT_CELL) + 1;
    char *is_taken = calloc(columns * rows, 1);
    assert(is_taken != NULL);
    const bool is_many = points->count > MANY_DOTS;
    for (size_t i = points->first[group]; i < points->first[group + 1]; i++) {
        const double x = plot_x(panel, points->points[i].x);
        const double y = plot_y(panel, points->points[i].y);
        const size_t column = (size_t)fmax(0.0, (x - panel->left) / DOT_CELL);
        const size_t row = (size_t)fmax(0.0, (y - panel->top) / DOT_CELL);
        char *cell = column < columns && row < rows ? &is_taken[row * columns + column] : NULL;
        if (cell != NULL && !*cell) {
            *cell = 1;
            study_plot_draw_dot(panel, x, y, is_many ? 1.4 : 2.6, is_many ? 0.5 : 0.7,
                                study_plot_style_of(group).colour);
        }
    }
    free(is_taken);
}

// What the groups are of, in two lines where one is too short for it; returns where the last
// stands.
static double draw_legend_title(const PlotPanel *panel, const Frame *frame, const char *words)
{
    const char *rest = strstr(words, " of ");
    double y = frame->legend_top;
    if (strlen(words) <= LEGEND_LETTERS || rest == NULL || frame->legend_left == frame->left) {
        plot_text(panel->svg, frame->legend_left, y, "start", "panel", words);
        return y;
    }
    char first[STUDY_LABEL_SIZE];
    snprintf(first, sizeof first, "%.*s", (int)(rest - words), words);
    plot_text(panel->svg, frame->legend_left, y, "start", "panel", first);
    y += 18.0;
    plot_text(panel->svg, frame->legend_left, y, "start", "panel", rest + 1);
    return y;
}

// One below the other with how many runs each has, or in a small picture two in a row.
static void study_plot_draw_legend(const PlotPanel *panel, const Frame *frame,
                                   const StudyPoints *points, const StudyLabel *label,
                                   const Layout *layout)
{
    const bool is_small = frame->legend_left == frame->left;
    double y = draw_legend_title(panel, frame, label->words);
    for (size_t group = 0; group < points->group_count; group++) {
        char words[RECORD_WORD_SIZE];
        const bool is_second = is_small && group % 2 == 1;
        const double x = frame->legend_left + (is_second ? 0.5 * frame->panel_width : 0.0);
        y += is_second ? 0.0 : is_small ? SMALL_ROW : group == 0 ? 26.0 : LEGEND_ROW;
        study_points_group_name(points, layout, label, group, words);
        plot_sample(panel->svg, x, y - 4.0, study_plot_style_of(group));
        study_plot_draw_dot(panel, x + 15.0, y - 4.0, 3.4, 1.0, study_plot_style_of(group).colour);
        plot_text(panel->svg, x + 38.0, y, "start", "", words);
        if (!is_small) {
            snprintf(words, sizeof words, "%zu runs",
                     points->first[group + 1] - points->first[group]);
            plot_text(panel->svg, x + 38.0, y + 15.0, "start", "note", words);
        }
    }
}

// Where the parts stand, with room for the legend.
static Frame choose_frame(const StudyPlot *plot, size_t group_count)
{
    Frame frame = plot->is_small ? SMALL : WIDE;
    if (plot->by == NULL && !plot->is_small) {
        frame.panel_width = WIDE_ALONE;
    }
    if (plot->by != NULL && plot->is_small) {
        frame.height += SMALL_ROW * (double)(1 + (group_count + 1) / 2) + 8.0;
    }
    return frame;
}

static bool has_band(const StudyPoints *points)
{
    for (size_t i = 0, end; i < points->count; i = end) {
        end = study_points_pile(points, i);
        if (end - i >= BAND_RUNS) {
            return true;
        }
    }
    return false;
}

enum { HEAD_LETTERS = 84 }; // that fit on its line

// The title that is given, or that of the study, or what is drawn: in words, or where these are too
// many by the names of the columns.
static void find_head(const StudyPlot *plot, const PlotWords *words, const Spec *spec, char *head,
                      size_t size)
{
    const char *title = plot->title != NULL                      ? plot->title
                        : spec != NULL && spec->title[0] != '\0' ? spec->title
                                                                 : NULL;
    const size_t letters = strlen(words->x.words) + strlen(words->y.words) + strlen(" over ");
    const bool is_long = letters > HEAD_LETTERS;
    const char *x = is_long ? plot->x : words->x.words;
    const char *y = is_long ? plot->y : words->y.words;
    if (title != NULL || plot->y == NULL) {
        snprintf(head, size, "%s", title != NULL ? title : x);
    } else {
        snprintf(head, size, "%s over %s", y, x);
    }
    if (title == NULL && !is_long) {
        head[0] = (char)toupper((unsigned char)head[0]);
    }
}

static void study_plot_draw_head(const Frame *frame, const StudyPoints *points, const char *head,
                                 const char *what, Text *svg)
{
    char words[3 * RECORD_NAME_SIZE];
    plot_text(svg, frame->left, frame->top - 50.0 + (frame->top < 80.0 ? 12.0 : 0.0), "start",
              "title", head);
    const int length = snprintf(words, sizeof words, "%zu runs%s", points->count, what);
    if (points->left_out > 0) {
        snprintf(words + length, sizeof words - (size_t)length,
                 "; %" PRIu64 " without a result left out", points->left_out);
    }
    plot_text(svg, frame->left, frame->top - (frame->top < 80.0 ? 18.0 : 28.0), "start", "note",
              words);
}

static void draw_points(const PlotPanel *panel, const StudyPoints *points, bool is_line)
{
    plot_fine_grid(panel);
    plot_enter(panel);
    for (size_t group = 0; group < points->group_count && is_line; group++) {
        study_plot_draw_band(panel, points, group);
    }
    for (size_t group = 0; group < points->group_count; group++) {
        if (is_line) {
            draw_line(panel, points, group);
        } else {
            study_plot_draw_dots(panel, points, group);
        }
    }
    plot_leave(panel);
}

// What the points of a picture are, as its head says.
static const char *describe_points(const StudyPoints *points, const StudyPlot *plot, bool is_line)
{
    return plot->y == NULL    ? ""
           : !is_line         ? ", a dot each"
           : has_band(points) ? ": median, and the band that nine of ten lie in"
                              : ": median";
}

bool study_plot_write(Store *store, const StudyPlot *plot, const Spec *spec, Text *svg, Err *err)
{
    StudyPoints points;
    if (!study_points_read(store, plot->x, plot->y, plot->by, &points, err)) {
        return false;
    }
    const Layout *layout = store_layout(store);
    const bool is_line =
        points.x_count <= LINE_X_MAX && points.count >= LINE_SHARE * points.x_count;
    PlotWords words;
    find_words(layout, spec, plot, &words);
    convert(&words, &points);
    char head[2 * STUDY_LABEL_SIZE + SPEC_TEXT_SIZE];
    find_head(plot, &words, spec, head, sizeof head);
    const Frame frame = choose_frame(plot, points.group_count);
    plot_begin(svg, frame.width, frame.height, head);
    study_plot_draw_head(&frame, &points, head, describe_points(&points, plot, is_line), svg);
    PlotPanel panel = {.svg = svg,
                       .title = "",
                       .left = frame.left,
                       .top = frame.top,
                       .width = frame.panel_width,
                       .height = frame.panel_height};
    study_plot_choose_axes(&points, &words, plot->y != NULL, &panel);
    if (plot->y == NULL) {
        study_histogram_draw(&points, store_column_at(layout, store_column(layout, plot->x)),
                             &panel, study_plot_style_of);
    } else {
        draw_points(&panel, &points, is_line);
    }
    if (plot->by != NULL) {
        study_plot_draw_legend(&panel, &frame, &points, &words.by, layout);
    }
    plot_end(svg);
    study_points_finish(&points);
    return true;
}
