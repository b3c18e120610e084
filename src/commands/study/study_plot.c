// What does one column of a study look like over another?
//
// Where x takes a few values that runs share, as on a grid, the median of each is a point of a
// line, and the band about it holds nine runs of ten. Else each run is a dot.
#include "commands/study/study_plot.h"

#include "commands/study/study_histogram.h"
#include "commands/study/study_points.h"
#include "write/plot.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double PICTURE_WIDTH = 1000.0; // pixels, as all that follow
static const double PICTURE_HEIGHT = 640.0;
static const double PANEL_LEFT = 84.0;
static const double PANEL_TOP = 84.0;
static const double PANEL_WIDTH = 640.0;
static const double PANEL_WIDTH_ALONE = 880.0; // without a legend
static const double PANEL_HEIGHT = 500.0;
static const double LEGEND_LEFT = 748.0;
static const double LEGEND_ROW = 36.0;
static const double DOT_CELL = 1.0; // dots nearer than that to each other are one

static const double LOG_SPAN = 30.0; // from that ratio on an axis is logarithmic
enum {
    LINE_X_MAX = 200, // values of x that a line may have
    LINE_SHARE = 2,   // runs that share each of them, on average
    BAND_RUNS = 5,    // runs at one x that have a band
    MANY_DOTS = 2000, // dots from which on they are small
};

static PlotStyle style_of(size_t group)
{
    PlotStyle style = plot_style(1, group);
    style.width = 1.8;
    // the palette has six colours
    style.dash = group < 6 ? NULL : "6 4";
    return style;
}

static void choose_axis(const char *title, double low, double high, Axis *axis)
{
    *axis = (Axis){.title = title, .low = low, .high = high};
    if (low > 0.0 && high > LOG_SPAN * low) {
        axis->scale = AXIS_LOG;
        axis_round_log(&axis->low, &axis->high);
    } else {
        axis_round(&axis->low, &axis->high);
    }
}

static void choose_axes(const StudyPoints *points, const StudyPlot *plot, PlotPanel *panel)
{
    double low_x = INFINITY, high_x = -INFINITY, low_y = INFINITY, high_y = -INFINITY;
    for (size_t i = 0; i < points->count; i++) {
        low_x = fmin(low_x, points->points[i].x);
        high_x = fmax(high_x, points->points[i].x);
        low_y = fmin(low_y, points->points[i].y);
        high_y = fmax(high_y, points->points[i].y);
    }
    choose_axis(plot->x, low_x, high_x, &panel->x);
    if (plot->y != NULL) {
        choose_axis(plot->y, low_y, high_y, &panel->y);
    }
}

// A value of rank ceil(share * count) among those of a pile, which are in order.
static double quantile(const StudyPoints *points, size_t first, size_t end, double share)
{
    const double rank = fmax(1.0, ceil(share * (double)(end - first)));
    return points->points[first + (size_t)rank - 1].y;
}

static void draw_band(const PlotPanel *panel, const StudyPoints *points, size_t group)
{
    Text back;
    text_init(&back);
    text_append(panel->svg, "<path fill=\"%s\" fill-opacity=\"0.16\" d=\"", style_of(group).colour);
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

static void draw_dot(const PlotPanel *panel, double x, double y, double radius, double opacity,
                     const char *colour)
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
    plot_line(panel, count, x, y, style_of(group));
    for (size_t i = 0; i < count; i++) {
        draw_dot(panel, plot_x(panel, x[i]), plot_y(panel, y[i]), 3.0, 1.0, style_of(group).colour);
    }
}

// What lies on a dot already cannot be seen, so that a picture of a million runs stays a picture.
static void draw_dots(const PlotPanel *panel, const StudyPoints *points, size_t group)
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
            draw_dot(panel, x, y, is_many ? 1.4 : 2.6, is_many ? 0.5 : 0.7, style_of(group).colour);
        }
    }
    free(is_taken);
}

static void draw_legend(const PlotPanel *panel, const StudyPoints *points, const StudyPlot *plot,
                        const Layout *layout)
{
    double y = PANEL_TOP + 6.0;
    if (plot->by == NULL) {
        return;
    }
    plot_text(panel->svg, LEGEND_LEFT, y, "start", "panel", plot->by);
    for (size_t group = 0; group < points->group_count; group++) {
        char words[RECORD_WORD_SIZE];
        y += group == 0 ? 26.0 : LEGEND_ROW;
        study_points_group_name(points, layout, group, words);
        plot_sample(panel->svg, LEGEND_LEFT, y - 4.0, style_of(group));
        draw_dot(panel, LEGEND_LEFT + 15.0, y - 4.0, 3.4, 1.0, style_of(group).colour);
        plot_text(panel->svg, LEGEND_LEFT + 38.0, y, "start", "", words);
        snprintf(words, sizeof words, "%zu runs", points->first[group + 1] - points->first[group]);
        plot_text(panel->svg, LEGEND_LEFT + 38.0, y + 15.0, "start", "note", words);
    }
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

static void draw_head(const StudyPoints *points, const StudyPlot *plot, const char *what, Text *svg)
{
    char words[3 * RECORD_NAME_SIZE];
    if (plot->y == NULL) {
        snprintf(words, sizeof words, "%s", plot->x);
    } else {
        snprintf(words, sizeof words, "%s over %s", plot->y, plot->x);
    }
    plot_text(svg, PANEL_LEFT, 34.0, "start", "title", plot->title != NULL ? plot->title : words);
    int length = snprintf(words, sizeof words, "%zu runs%s", points->count, what);
    if (points->left_out > 0) {
        snprintf(words + length, sizeof words - (size_t)length,
                 "; %" PRIu64 " without a result left out", points->left_out);
    }
    plot_text(svg, PANEL_LEFT, 56.0, "start", "note", words);
}

static void draw_points(const PlotPanel *panel, const StudyPoints *points, bool is_line)
{
    plot_fine_grid(panel);
    plot_enter(panel);
    for (size_t group = 0; group < points->group_count && is_line; group++) {
        draw_band(panel, points, group);
    }
    for (size_t group = 0; group < points->group_count; group++) {
        if (is_line) {
            draw_line(panel, points, group);
        } else {
            draw_dots(panel, points, group);
        }
    }
    plot_leave(panel);
}

bool study_plot_write(Store *store, const StudyPlot *plot, Text *svg, Err *err)
{
    StudyPoints points;
    if (!study_points_read(store, plot->x, plot->y, plot->by, &points, err)) {
        return false;
    }
    const bool is_line =
        points.x_count <= LINE_X_MAX && points.count >= LINE_SHARE * points.x_count;
    const char *const what = plot->y == NULL     ? ""
                             : !is_line          ? ", a dot each"
                             : has_band(&points) ? ": median, and the band that nine of ten lie in"
                                                 : ": median";
    plot_begin(svg, PICTURE_WIDTH, PICTURE_HEIGHT, plot->title != NULL ? plot->title : plot->x);
    draw_head(&points, plot, what, svg);
    PlotPanel panel = {.svg = svg,
                       .title = "",
                       .left = PANEL_LEFT,
                       .top = PANEL_TOP,
                       .width = plot->by == NULL ? PANEL_WIDTH_ALONE : PANEL_WIDTH,
                       .height = PANEL_HEIGHT};
    choose_axes(&points, plot, &panel);
    if (plot->y == NULL) {
        study_histogram_draw(
            &points,
            store_column_at(store_layout(store), store_column(store_layout(store), plot->x)),
            &panel, style_of);
    } else {
        draw_points(&panel, &points, is_line);
    }
    draw_legend(&panel, &points, plot, store_layout(store));
    plot_end(svg);
    study_points_finish(&points);
    return true;
}
