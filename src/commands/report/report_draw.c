// Draws lines with dots as SVG inside a page.
#include "commands/report/report_draw.h"
#include "base/memory.h"
#include "base/zeroed.h"
#include "commands/report/report_svg.h"

#include <math.h>
#include <stdlib.h>

// pixels
static const double WIDTH = 1000.0;
static const double HEIGHT = 460.0;
static const double LEFT = 90.0;
static const double TOP = 50.0;
static const double PANEL_WIDTH = 640.0;
static const double PANEL_HEIGHT = 350.0;
static const double LEGEND_LEFT = 756.0;
static const double LEGEND_ROW = 20.0;

DrawLine *draw_add(Drawing *drawing, const char *name, PlotStyle style)
{
    drawing->lines = memory_grown(drawing->lines, drawing->count + 1, sizeof *drawing->lines);
    DrawLine *line = &drawing->lines[drawing->count++];
    *line = (DrawLine){.name = name, .style = style};
    return line;
}

void draw_point(const Drawing *drawing, DrawLine *line, double x, double y)
{
    if (isfinite(x) && isfinite(y) && (x > 0.0 || !drawing->is_x_log) &&
        (y > 0.0 || !drawing->is_y_log)) {
        line->points = memory_grown(line->points, line->count + 1, sizeof *line->points);
        line->points[line->count++] = (DrawPoint){x, y};
    }
}

static void widen(double value, double *low, double *high)
{
    *low = fmin(*low, value);
    *high = fmax(*high, value);
}

static Axis axis_of(const char *title, bool is_log, double low, double high)
{
    if (is_log) {
        axis_round_log(&low, &high);
    } else {
        axis_round(&low, &high);
    }
    return (Axis){
        .title = title, .scale = is_log ? AXIS_LOG : AXIS_LINEAR, .low = low, .high = high};
}

// Returns false where there is nothing to draw.
static bool choose_axes(const Drawing *drawing, PlotPanel *panel)
{
    double low_x = INFINITY, high_x = -INFINITY, low_y = INFINITY, high_y = -INFINITY;
    for (size_t i = 0; i < drawing->count; i++) {
        for (size_t k = 0; k < drawing->lines[i].count; k++) {
            widen(drawing->lines[i].points[k].x, &low_x, &high_x);
            widen(drawing->lines[i].points[k].y, &low_y, &high_y);
        }
    }
    if (!(low_x <= high_x)) {
        return false;
    }
    if (isfinite(drawing->level)) {
        widen(drawing->level, &low_y, &high_y);
    }
    panel->x = axis_of(drawing->x_title, drawing->is_x_log, low_x, high_x);
    panel->y = axis_of(drawing->y_title, drawing->is_y_log, low_y, high_y);
    return true;
}

static void draw_line(const PlotPanel *panel, const DrawLine *line)
{
    double *x = zeroed(line->count, sizeof *x);
    double *y = zeroed(line->count, sizeof *y);
    for (size_t i = 0; i < line->count; i++) {
        x[i] = line->points[i].x;
        y[i] = line->points[i].y;
    }
    if (!line->is_dots) {
        plot_line(panel, line->count, x, y, line->style);
    }
    for (size_t i = 0; i < line->count && !line->is_bare; i++) {
        plot_spot(panel->svg, plot_x(panel, x[i]), plot_y(panel, y[i]), 3.2, line->style.colour,
                  "#fff", 1.0);
    }
    free(x);
    free(y);
}

// As high as the legend is long.
static double picture_height(const Drawing *drawing)
{
    double rows = isfinite(drawing->level) ? 1.0 : 0.0;
    for (size_t i = 0; i < drawing->count; i++) {
        rows += drawing->lines[i].count > 0 ? 1.0 : 0.0;
    }
    return fmax(HEIGHT, TOP + (rows + 1.0) * LEGEND_ROW);
}

static void draw_legend(const Drawing *drawing, Text *svg)
{
    double y = TOP + 8.0;
    for (size_t i = 0; i < drawing->count; i++) {
        if (drawing->lines[i].count > 0) {
            plot_sample(svg, LEGEND_LEFT, y - 4.0, drawing->lines[i].style);
            plot_text(svg, LEGEND_LEFT + 38.0, y, "start", "", drawing->lines[i].name);
            y += LEGEND_ROW;
        }
    }
    if (isfinite(drawing->level)) {
        plot_sample(svg, LEGEND_LEFT, y - 4.0, (PlotStyle){"#222", 1.2, 1.0, "2 3"});
        plot_text(svg, LEGEND_LEFT + 38.0, y, "start", "", drawing->level_name);
    }
}

static void draw_panel(const Drawing *drawing, const PlotPanel *panel)
{
    plot_fine_grid(panel);
    plot_enter(panel);
    if (isfinite(drawing->level)) {
        const double x[] = {panel->x.low, panel->x.high};
        const double y[] = {drawing->level, drawing->level};
        plot_line(panel, 2, x, y, (PlotStyle){"#222", 1.2, 1.0, "2 3"});
    }
    for (size_t i = 0; i < drawing->count; i++) {
        draw_line(panel, &drawing->lines[i]);
    }
    plot_leave(panel);
}

void draw_end(Drawing *drawing, Text *html)
{
    Text svg;
    text_init(&svg);
    PlotPanel panel = {.svg = &svg,
                       .title = "",
                       .left = LEFT,
                       .top = TOP,
                       .width = PANEL_WIDTH,
                       .height = PANEL_HEIGHT + picture_height(drawing) - HEIGHT};
    if (choose_axes(drawing, &panel)) {
        plot_begin(&svg, WIDTH, picture_height(drawing), drawing->title);
        plot_text(&svg, LEFT, 30.0, "start", "title", drawing->title);
        draw_panel(drawing, &panel);
        draw_legend(drawing, &svg);
        plot_end(&svg);
        svg_embed(svg.data, drawing->title, html);
    }
    for (size_t i = 0; i < drawing->count; i++) {
        free(drawing->lines[i].points);
    }
    free(drawing->lines);
    *drawing = (Drawing){0};
    text_finish(&svg);
}
