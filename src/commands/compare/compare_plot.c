// Draws speed against error as SVG.
//
// Both axes are logarithmic. Colour shows stepping and map, solid or dashed line the solver, full
// or hollow dots the collider. What is faster and more accurate than all else lies on the wide
// pale line. Other engines have a
// colour each, and a line for each of their ways. The axes are those of engines: a solver far below
// their edge is an arrow there.
#include "commands/compare/compare.h"
#include "commands/compare/compare_style.h"
#include "write/plot.h"
#include "write/units.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PICTURE_WIDTH = 1000.0; // pixels, as all that follow
static const double PICTURE_HEIGHT = 706.0;
static const double PANEL_LEFT = 84.0;
static const double PANEL_TOP = 100.0;
static const double PANEL_WIDTH = 620.0;
static const double PANEL_HEIGHT = 550.0;
static const double LEGEND_LEFT = 728.0;
static const double LEGEND_ROW = 38.0;
static const double LEGEND_ROW_DENSE = 19.0;
enum { LEGEND_ROOMY = 12 }; // schemes up to which an entry has two lines

static const PlotStyle FRONTIER = {"#f0c419", 9.0, 0.5, NULL};

static double at_x(const PlotPanel *panel, double time_s)
{
    return plot_x(panel, time_s * UNITS_MS);
}

static bool is_drawn(const LadderPoint *point)
{
    return !point->is_failed && isfinite(point->wall_median_s) && point->error > 0.0;
}

static PlotStyle compare_plot_style_of(const Scheme *scheme)
{
    const EngineDriver *driver = scheme->driver;
    if (driver != NULL) {
        size_t way = 0;
        while (way + 1 < driver->way_count && driver->ways[way] != scheme->way) {
            way++;
        }
        return compare_style_of_engine(driver->name, way, driver->way_count);
    }
    return scheme_has_step(scheme)
               ? compare_style_of_ode(scheme->name, scheme->solver, scheme->stepping, scheme->map)
               : compare_style_of_others();
}

static void compare_plot_draw_dot(Text *svg, double x, double y, double radius,
                                  const Scheme *scheme)
{
    const PlotStyle style = compare_plot_style_of(scheme);
    const bool is_hollow = scheme->collider != ODE_COLLIDER_PIN_HOLE;
    plot_spot(svg, x, y, radius, is_hollow ? "#fff" : style.colour,
              is_hollow ? style.colour : "#fff", 1.4);
}

// The axes hold every point of ODE, and the time of all others.
static void compare_plot_choose_axes(const Ladder *ladder, PlotPanel *panel)
{
    double low_x = INFINITY, high_x = 0.0, low_y = INFINITY, high_y = 0.0;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (!is_drawn(point)) {
            continue;
        }
        low_x = fmin(low_x, point->wall_median_s * UNITS_MS);
        high_x = fmax(high_x, point->wall_median_s * UNITS_MS);
        if (ladder->schemes[point->scheme].backend == BACKEND_ODE ||
            ladder->schemes[point->scheme].driver != NULL) {
            low_y = fmin(low_y, point->error);
            high_y = fmax(high_y, point->error);
        }
    }
    if (!(high_y > 0.0)) {
        // nothing of ODE is there to be drawn
        low_x = fmin(low_x, 1.0), high_x = fmax(high_x, 10.0), low_y = 1e-5, high_y = 1.0;
    }
    axis_round_log(&low_x, &high_x);
    axis_round_log(&low_y, &high_y);
    panel->x = (Axis){
        .title = "wall time of the run, ms", .scale = AXIS_LOG, .low = low_x, .high = high_x};
    panel->y =
        (Axis){.title = ladder->truth.is_limited ? "largest error within the horizon, relative"
                                                 : "largest error, relative",
               .scale = AXIS_LOG,
               .low = low_y,
               .high = high_y};
}

// Where an error is not a number of its own.
static void compare_plot_draw_band(const PlotPanel *panel, const LadderTruth *truth)
{
    const double limit = ERROR_CLEAR_OF_TRUTH * truth->uncertainty;
    if (!(limit > panel->y.low)) {
        return;
    }
    plot_below(panel, fmax(plot_y(panel, limit), panel->top), "#999");
    plot_text(panel->svg, panel->left + 8.0, panel->top + panel->height - 8.0, "start", "note",
              "limited by the truth: below ten times its own uncertainty");
}

static int compare_times(const void *a, const void *b)
{
    const LadderPoint *left = *(const LadderPoint *const *)a;
    const LadderPoint *right = *(const LadderPoint *const *)b;
    return (left->wall_median_s > right->wall_median_s) -
           (left->wall_median_s < right->wall_median_s);
}

// The points of the frontier, fast to slow; their count. The list has room for all points.
static size_t list_frontier(const Ladder *ladder, const LadderPoint **list)
{
    size_t count = 0;
    for (size_t i = 0; i < ladder->point_count; i++) {
        if (ladder->points[i].is_on_frontier && is_drawn(&ladder->points[i])) {
            list[count++] = &ladder->points[i];
        }
    }
    qsort(list, count, sizeof *list, compare_times);
    return count;
}

// A stair: up to the next point of the frontier, or for ever, the error to be had is that of the
// faster one.
static void draw_frontier(const PlotPanel *panel, const LadderPoint *const *list, size_t count)
{
    const PlotStyle style = FRONTIER;
    text_append(panel->svg,
                "<path fill=\"none\" stroke=\"%s\" stroke-width=\"%g\" stroke-opacity=\"%g\" "
                "stroke-linejoin=\"round\" stroke-linecap=\"round\" d=\"",
                style.colour, style.width, style.opacity);
    for (size_t i = 0; i < count; i++) {
        const double x = at_x(panel, list[i]->wall_median_s);
        const double y = plot_y(panel, list[i]->error);
        text_append(panel->svg, i == 0 ? "M%.1f %.1f" : "H%.1fV%.1f", x, y);
    }
    text_append(panel->svg, count > 0 ? "H%.1f\"/>\n" : "\"/>\n", panel->left + panel->width);
}

// The step beside each point of the frontier that has a given one, unless it would lie on the one
// before.
static void label_frontier(const PlotPanel *panel, const LadderPoint *const *list, size_t count)
{
    double last_x = -INFINITY;
    double last_y = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double x = at_x(panel, list[i]->wall_median_s) - 9.0;
        const double bottom = panel->top + panel->height - 5.0;
        const double y = fmin(plot_y(panel, list[i]->error) + 15.0, bottom);
        const bool is_on_last = fabs(x - last_x) < 40.0 && fabs(y - last_y) < 14.0;
        if (is_on_last || !(list[i]->step_s > 0.0)) {
            continue;
        }
        char words[32];
        snprintf(words, sizeof words, "%.3g us", list[i]->step_s * UNITS_US);
        plot_text(panel->svg, x, y, "end", "note", words);
        last_x = x;
        last_y = y;
    }
}

static void draw_scheme(const PlotPanel *panel, const Ladder *ladder, size_t scheme)
{
    double x[LADDER_STEP_MAX];
    double y[LADDER_STEP_MAX];
    size_t count = 0;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->scheme == scheme && is_drawn(point)) {
            x[count] = point->wall_median_s * UNITS_MS;
            y[count++] = point->error;
        }
    }
    plot_line(panel, count, x, y, compare_plot_style_of(&ladder->schemes[scheme]));
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        if (point->scheme == scheme && is_drawn(point)) {
            compare_plot_draw_dot(panel->svg, at_x(panel, point->wall_median_s),
                                  plot_y(panel, point->error), point->is_on_frontier ? 5.2 : 3.8,
                                  &ladder->schemes[scheme]);
        }
    }
}

// A solver that chooses its own steps: a diamond, or an arrow on the lower edge.
static void draw_other(const PlotPanel *panel, const LadderPoint *point)
{
    const double x = at_x(panel, point->wall_median_s);
    const double edge = panel->top + panel->height;
    const bool is_below = point->error < panel->y.low;
    const double y = is_below ? edge - 40.0 : plot_y(panel, point->error);
    text_append(panel->svg, "<path fill=\"#333\" d=\"M%.1f %.1fl6 6l-6 6l-6 -6z\"/>\n", x, y - 6.0);
    if (is_below) {
        text_append(panel->svg,
                    "<path stroke=\"#333\" fill=\"none\" stroke-width=\"1.4\" "
                    "d=\"M%.1f %.1fV%.1fm-4 -7l4 7l4 -7\"/>\n",
                    x, y, edge - 4.0);
    }
    char words[SCHEME_NAME_SIZE + 32];
    snprintf(words, sizeof words, "%s, %.1g", point->name, point->error);
    const bool is_right = x > panel->left + 0.7 * panel->width;
    plot_text(panel->svg, is_right ? x - 11.0 : x + 11.0, y + 4.0, is_right ? "end" : "start", "",
              words);
}

static size_t compare_plot_count_failed(const Ladder *ladder, size_t scheme)
{
    size_t failed = 0;
    for (size_t i = 0; i < ladder->point_count; i++) {
        const LadderPoint *point = &ladder->points[i];
        failed += point->scheme == scheme && point->is_failed && !point->is_left_out ? 1 : 0;
    }
    return failed;
}

static void compare_plot_draw_legend(const Ladder *ladder, Text *svg)
{
    const bool is_roomy = ladder->scheme_count <= LEGEND_ROOMY;
    double y = PANEL_TOP + 6.0;
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        const Scheme *scheme = &ladder->schemes[i];
        if (!scheme_has_step(scheme)) {
            continue;
        }
        plot_sample(svg, LEGEND_LEFT, y - 4.0, compare_plot_style_of(scheme));
        compare_plot_draw_dot(svg, LEGEND_LEFT + 15.0, y - 4.0, 3.8, scheme);
        plot_text(svg, LEGEND_LEFT + 38.0, y, "start", "", scheme->name);
        char words[96];
        const Order *order = &ladder->orders[i];
        const size_t failed = compare_plot_count_failed(ladder, i);
        int length = order->is_known ? snprintf(words, sizeof words, "order %.2f", order->order)
                                     : snprintf(words, sizeof words, "no order");
        if (failed > 0) {
            snprintf(words + length, sizeof words - (size_t)length, ", %zu failed", failed);
        }
        if (is_roomy) {
            plot_text(svg, LEGEND_LEFT + 38.0, y + 15.0, "start", "note", words);
        }
        y += is_roomy ? LEGEND_ROW : LEGEND_ROW_DENSE;
    }
    plot_sample(svg, LEGEND_LEFT, y, FRONTIER);
    plot_text(svg, LEGEND_LEFT + 38.0, y + 4.0, "start", "", "frontier, with its steps");
}

static void compare_plot_draw_head(const CompareReport *report, Text *svg)
{
    const Ladder *ladder = report->ladder;
    const LadderTruth *truth = &ladder->truth;
    char words[512];
    plot_text(svg, PANEL_LEFT, 34.0, "start", "title", report->scenario->title);
    const bool is_certified = truth->message[0] == '\0';
    int length = is_certified ? snprintf(words, sizeof words, "truth: %s, to %.1g", truth->backend,
                                         truth->uncertainty)
                              : snprintf(words, sizeof words,
                                         "truth: %s, which could not be certified", truth->backend);
    if (truth->is_limited && is_certified) {
        length += snprintf(words + length, sizeof words - (size_t)length,
                           ", up to its horizon at %.4g ms of %.4g", truth->horizon_s * UNITS_MS,
                           scenario_duration(report->scenario) * UNITS_MS);
    }
    snprintf(words + length, sizeof words - (size_t)length, "; medians of %zu runs on %s",
             ladder->repeats, report->machine);
    plot_text(svg, PANEL_LEFT, 56.0, "start", "note", words);
}

void compare_plot_write(const void *of, Text *svg)
{
    const CompareReport *report = of;
    const Ladder *ladder = report->ladder;
    plot_begin(svg, PICTURE_WIDTH, PICTURE_HEIGHT, report->scenario->title);
    compare_plot_draw_head(report, svg);
    PlotPanel panel = {.svg = svg,
                       .title = "Speed against error",
                       .left = PANEL_LEFT,
                       .top = PANEL_TOP,
                       .width = PANEL_WIDTH,
                       .height = PANEL_HEIGHT};
    compare_plot_choose_axes(ladder, &panel);
    plot_fine_grid(&panel);
    plot_enter(&panel);
    compare_plot_draw_band(&panel, &ladder->truth);
    const LadderPoint **frontier = calloc(ladder->point_count + 1, sizeof(const LadderPoint *));
    const size_t count = frontier == NULL ? 0 : list_frontier(ladder, frontier);
    draw_frontier(&panel, frontier, count);
    for (size_t i = 0; i < ladder->scheme_count; i++) {
        if (scheme_has_step(&ladder->schemes[i])) {
            draw_scheme(&panel, ladder, i);
        }
    }
    for (size_t i = 0; i < ladder->point_count; i++) {
        if (ladder->points[i].step_s == 0.0 && is_drawn(&ladder->points[i])) {
            draw_other(&panel, &ladder->points[i]);
        }
    }
    label_frontier(&panel, frontier, count);
    free(frontier);
    plot_leave(&panel);
    compare_plot_draw_legend(ladder, svg);
    plot_end(svg);
}
