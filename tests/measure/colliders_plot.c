// What do the colliders' errors look like, over the number of facets and over the time they take?
#include "colliders.h"

#include "write/plot.h"
#include "write/units.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

static const double PICTURE_WIDTH = 900.0; // pixels, as all that follow
static const double PICTURE_HEIGHT = 560.0;
static const double PANEL_LEFT = 84.0;
static const double PANEL_TOP = 84.0;
static const double PANEL_WIDTH = 560.0;
static const double PANEL_HEIGHT = 410.0;
static const double LEGEND_LEFT = 668.0;
static const double LEGEND_ROW = 24.0;

enum { KIND_COUNT = 2 * ODE_COLLIDER_COUNT };

// The x axis of one of the two pictures.
typedef struct Shown {
    const char *title;
    const char *note;
    const char *x_title;
    double (*of)(const ColliderPoint *point);
} Shown;

static double facets_of(const ColliderPoint *point)
{
    return (double)point->facets;
}

static double time_of(const ColliderPoint *point)
{
    return point->processor_s * UNITS_MS;
}

// Colour by collider; a broken line for inscribed polygons.
static PlotStyle style_of(int kind)
{
    PlotStyle style = plot_style(1, (size_t)(kind / 2));
    style.width = 1.8;
    style.dash = kind % 2 == 0 ? NULL : "6 4";
    return style;
}

static int kind_of(const ColliderPoint *point)
{
    return 2 * (int)point->collider + (point->polygon == ODE_INSCRIBED ? 1 : 0);
}

static void choose_axes(const ColliderPoints *points, const Shown *shown, PlotPanel *panel)
{
    double low_x = INFINITY, high_x = 0.0, low_y = INFINITY, high_y = 0.0;
    for (size_t i = 0; i < points->count; i++) {
        const ColliderPoint *point = &points->points[i];
        low_x = fmin(low_x, shown->of(point));
        high_x = fmax(high_x, shown->of(point));
        low_y = fmin(low_y, point->error);
        high_y = fmax(high_y, point->error);
    }
    axis_round_log(&low_x, &high_x);
    axis_round_log(&low_y, &high_y);
    panel->x = (Axis){.title = shown->x_title, .scale = AXIS_LOG, .low = low_x, .high = high_x};
    panel->y = (Axis){.title = "largest error of omega, relative",
                      .scale = AXIS_LOG,
                      .low = low_y,
                      .high = high_y};
}

static bool draw_kind(const ColliderPoints *points, int kind, const Shown *shown,
                      const PlotPanel *panel)
{
    double x[COLLIDERS_POINT_MAX];
    double y[COLLIDERS_POINT_MAX];
    size_t count = 0;
    for (size_t i = 0; i < points->count; i++) {
        if (kind_of(&points->points[i]) == kind) {
            x[count] = shown->of(&points->points[i]);
            y[count++] = points->points[i].error;
        }
    }
    const PlotStyle style = style_of(kind);
    plot_line(panel, count, x, y, style);
    for (size_t i = 0; i < count; i++) {
        plot_spot(panel->svg, plot_x(panel, x[i]), plot_y(panel, y[i]), 3.8,
                  kind % 2 == 0 ? style.colour : "#fff", style.colour, 1.4);
    }
    return count > 0;
}

static void draw(const ColliderPoints *points, const Shown *shown, Text *svg)
{
    plot_begin(svg, PICTURE_WIDTH, PICTURE_HEIGHT, shown->title);
    plot_text(svg, PANEL_LEFT, 32.0, "start", "title", shown->title);
    plot_text(svg, PANEL_LEFT, 54.0, "start", "note", shown->note);
    PlotPanel panel = {.svg = svg,
                       .title = "",
                       .left = PANEL_LEFT,
                       .top = PANEL_TOP,
                       .width = PANEL_WIDTH,
                       .height = PANEL_HEIGHT};
    choose_axes(points, shown, &panel);
    plot_fine_grid(&panel);
    plot_enter(&panel);
    bool is_drawn[KIND_COUNT];
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        is_drawn[kind] = draw_kind(points, kind, shown, &panel);
    }
    plot_leave(&panel);
    double y = PANEL_TOP + 12.0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        if (is_drawn[kind]) {
            char words[64];
            snprintf(words, sizeof words, "%s%s", OPTIONS_ODE_COLLIDERS[kind / 2],
                     kind % 2 == 0 ? "" : ", inscribed");
            plot_sample(svg, LEGEND_LEFT, y - 4.0, style_of(kind));
            plot_text(svg, LEGEND_LEFT + 38.0, y, "start", "", words);
            y += LEGEND_ROW;
        }
    }
    plot_end(svg);
}

void colliders_plot_facets(const ColliderPoints *points, Text *svg)
{
    const Shown shown = {
        "Error of a run over the number of facets",
        "the paper's mechanism, 14.5 um of play, one revolution, staggered midpoint, step 1 us",
        "facets of the hole",
        facets_of,
    };
    draw(points, &shown, svg);
}

void colliders_plot_cost(const ColliderPoints *points, Text *svg)
{
    const Shown shown = {
        "Cost against error of all colliders",
        "the paper's mechanism, 14.5 um of play, one revolution, staggered midpoint, steps 10 to "
        "0.5 us",
        "processor time of a revolution, ms",
        time_of,
    };
    draw(points, &shown, svg);
}
