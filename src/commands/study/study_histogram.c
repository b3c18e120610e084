// How often does each value occur?
//
// Bars of one width on the scale of the axis, their number twice the cubic root of that of the
// runs (Rice's rule); of whole numbers that are few, one bar each.
#include "commands/study/study_histogram.h"

#include "write/units.h"

#include <math.h>
#include <stdio.h>

enum { BAR_LEAST = 8, BAR_MOST = 60 };

typedef struct Bars {
    size_t count;
    double low; // on the scale of the axis: the value, or its logarithm
    double width;
    bool is_log;
    double shares[STUDY_GROUP_MAX][BAR_MOST]; // percent of the group
} Bars;

static double scaled(const Bars *bars, double value)
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
        low = fmin(low, scaled(bars, points->points[i].x));
        high = fmax(high, scaled(bars, points->points[i].x));
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
            const double place = (scaled(bars, points->points[i].x) - bars->low) / bars->width;
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

// The points of one group are in the order of x.
static void draw_quantile(const PlotPanel *panel, const StudyPoints *points, double share,
                          const char *name)
{
    static const PlotStyle STYLE = {"#555555", 1.2, 1.0, "5 4"};
    const double rank = fmax(1.0, ceil(share * (double)points->count));
    const double value = points->points[(size_t)rank - 1].x;
    const double x[] = {value, value};
    const double y[] = {panel->y.low, panel->y.high};
    char words[64];
    plot_line(panel, 2, x, y, STYLE);
    snprintf(words, sizeof words, "%s %.4g", name, value);
    // one label above the other, for they may stand close together
    plot_text(panel->svg, plot_x(panel, value) + 4.0, panel->top + 16.0 + 32.0 * fabs(share - 0.5),
              "start", "note", words);
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
    panel->y = (Axis){.title = "share of the runs, %", .high = most};
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
