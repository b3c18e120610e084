// Draws lines with dots as SVG inside a page.
#include "commands/report/report_draw.h"
#include "base/memory.h"
#include "base/zeroed.h"
#include "commands/report/report_svg.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// pixels: as wide as a phone can show so that words can be read, the legend below
static const double WIDTH = 560.0;
static const double LEFT = 84.0;
static const double TOP = 46.0;
static const double PANEL_WIDTH = 456.0;
static const double PANEL_HEIGHT = 330.0;
static const double LEGEND_TOP = 442.0; // of its first row
static const double LEGEND_ROW = 20.0;
static const double SHAPE = 4.2; // half the size of a mark
// letters of a name, so that two entries of the legend stand in a row
enum { NAME_SHORT = 28 };

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

// Within less than a decade a logarithmic axis has no ticks that help.
static Axis axis_of(const char *title, bool wants_log, double low, double high)
{
    const bool is_log = wants_log && high >= 10.0 * low;
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

// What stands at a point.
static void draw_shape(Text *svg, double x, double y, const DrawLine *line)
{
    static const char *const PATHS[] = {
        [DRAW_SQUARE] = "M%.1f %.1fm-1 -1h2v2h-2z",
        [DRAW_DIAMOND] = "M%.1f %.1fm0 -1.4l1.4 1.4l-1.4 1.4l-1.4 -1.4z",
        [DRAW_TRIANGLE] = "M%.1f %.1fm0 -1.3l1.2 2.2h-2.4z",
        [DRAW_WEDGE] = "M%.1f %.1fm0 1.3l1.2 -2.2h-2.4z",
    };
    if (line->shape == DRAW_DOT) {
        plot_spot(svg, x, y, 3.2, line->style.colour, "#fff", 1.0);
    } else if (line->shape == DRAW_RING) {
        plot_spot(svg, x, y, 5.0, "#fff", line->style.colour, 2.4);
    } else {
        text_append(svg, "<g transform=\"translate(%.1f %.1f) scale(%g)\"><path d=\"", x, y, SHAPE);
        text_append(svg, PATHS[line->shape], 0.0, 0.0);
        text_append(svg, "\" fill=\"%s\"/></g>\n", line->style.colour);
    }
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
        draw_shape(panel->svg, plot_x(panel, x[i]), plot_y(panel, y[i]), line);
    }
    free(x);
    free(y);
}

// How many entries of the legend stand in a row.
static size_t legend_columns(const Drawing *drawing)
{
    bool is_short = !isfinite(drawing->level) || strlen(drawing->level_name) <= NAME_SHORT;
    for (size_t i = 0; i < drawing->count; i++) {
        is_short = is_short && strlen(drawing->lines[i].name) <= NAME_SHORT;
    }
    return is_short ? 2 : 1;
}

// As high as the legend is long.
static double picture_height(const Drawing *drawing)
{
    size_t entries = isfinite(drawing->level) ? 1 : 0;
    for (size_t i = 0; i < drawing->count; i++) {
        entries += drawing->lines[i].count > 0 ? 1 : 0;
    }
    const size_t columns = legend_columns(drawing);
    return LEGEND_TOP + LEGEND_ROW * (double)((entries + columns - 1) / columns);
}

// As its line is drawn: with what stands at its points, and without a stroke where it has one
// point.
static void draw_entry(Text *svg, double x, double y, const DrawLine *line)
{
    if (!line->is_dots && (line->count > 1 || line->is_bare)) {
        plot_sample(svg, x, y - 4.0, line->style);
    }
    if (!line->is_bare) {
        draw_shape(svg, x + 15.0, y - 4.0, line);
    }
    plot_text(svg, x + 38.0, y, "start", "", line->name);
}

static void draw_legend(const Drawing *drawing, Text *svg)
{
    const DrawLine level = {.name = drawing->level_name,
                            .style = {"#222", 1.2, 1.0, "2 3"},
                            .is_bare = true,
                            .count = isfinite(drawing->level) ? 2 : 0};
    const size_t columns = legend_columns(drawing);
    size_t entry = 0;
    for (size_t i = 0; i <= drawing->count; i++) {
        const DrawLine *line = i < drawing->count ? &drawing->lines[i] : &level;
        if (line->count > 0) {
            draw_entry(svg, LEFT + PANEL_WIDTH / (double)columns * (double)(entry % columns),
                       LEGEND_TOP + LEGEND_ROW * (double)(entry / columns), line);
            entry++;
        }
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
                       .height = PANEL_HEIGHT};
    if (choose_axes(drawing, &panel)) {
        plot_begin(&svg, WIDTH, picture_height(drawing), drawing->title);
        plot_text(&svg, LEFT, 30.0, "start", "title", drawing->title);
        draw_panel(drawing, &panel);
        draw_legend(drawing, &svg);
        plot_end(&svg);
        text_append(html, "<div class=\"pictures\">\n");
        svg_embed(svg.data, drawing->title, html);
        text_append(html, "</div>\n");
    }
    for (size_t i = 0; i < drawing->count; i++) {
        free(drawing->lines[i].points);
    }
    free(drawing->lines);
    *drawing = (Drawing){0};
    text_finish(&svg);
}
