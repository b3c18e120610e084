// Draws the errors of each map over the step as SVG.
#include "commands/map/map.h"
#include "write/plot.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>

// The error of each map at each step.
//
// The largest errors, wherever the steps fall, relative to what the law asks: left of the
// restitution, right of the peak force. Lines are predicted, dots delivered; what is valid lies in
// the pale band.

static const double PICTURE_WIDTH = 1000.0; // pixels, as all that follow
static const double HEAD_HEIGHT = 96.0;
static const double ROW_HEIGHT = 380.0;
static const double PANEL_LEFT = 84.0;
static const double PANEL_WIDTH = 390.0;
static const double PANEL_HEIGHT = 280.0;
static const double PANEL_DISTANCE = 484.0;
static const double LEGEND_DISTANCE = 130.0;

enum {
    CURVE_POINTS = 100,
    PICTURE_CONTACTS = 8, // more would be a poster
};

// of the axis of errors; what is smaller lies on its lower edge
static const double ERROR_LEAST = 1e-5;
static const double ERROR_MOST = 2.0;

// One of the two quantities that are drawn.
typedef struct Shown {
    const char *title;
    double (*of)(const ImpactFigures *figures, const MapImpact *asked);
} Shown;

static double largest_error(const ImpactSpread *spread, double asked)
{
    return fmax(fabs(spread->least - asked), fabs(spread->most - asked)) / asked;
}

static double restitution_of(const ImpactFigures *figures, const MapImpact *asked)
{
    return largest_error(&figures->restitution, asked->restitution);
}

static double peak_of(const ImpactFigures *figures, const MapImpact *asked)
{
    return largest_error(&figures->force_max, asked->force_max);
}

static PlotStyle map_plot_style_of(OdeMap map)
{
    PlotStyle style = plot_style(1, (size_t)map);
    style.width = 1.8;
    return style;
}

// The axis of steps, from the finest to the coarsest.
static Axis step_axis(const MappingSettings *settings)
{
    double low = settings->steps[settings->step_count - 1] * UNITS_US;
    double high = settings->steps[0] * UNITS_US;
    axis_round_log(&low, &high);
    return (Axis){.title = "step, us", .scale = AXIS_LOG, .low = low, .high = high};
}

static void map_plot_draw_band(const PlotPanel *panel)
{
    const double top = plot_y(panel, MAPPING_VALID_SHARE);
    plot_below(panel, top, "#f0c419");
    plot_text(panel->svg, panel->left + 8.0, top + 16.0, "start", "note", "valid");
}

static void draw_curve(const PlotPanel *panel, const MappingContact *contact, OdeMap map,
                       const Shown *shown)
{
    double x[CURVE_POINTS];
    double y[CURVE_POINTS];
    size_t count = 0;
    for (int i = 0; i < CURVE_POINTS; i++) {
        const double share = (double)i / (CURVE_POINTS - 1);
        const double step_us = panel->x.low * pow(panel->x.high / panel->x.low, share);
        const ImpactFigures figures = mapping_predict(contact, map, step_us / UNITS_US);
        const double error = shown->of(&figures, &contact->asked);
        if (figures.is_ended && error > 0.0) {
            x[count] = step_us;
            y[count++] = error;
        }
    }
    plot_line(panel, count, x, y, map_plot_style_of(map));
}

static void map_plot_draw_dots(const MappingReport *report, const PlotPanel *panel,
                               const MappingContact *contact, const Shown *shown)
{
    for (size_t i = 0; i < contact->row_count; i++) {
        const MappingRow *row = &report->mapping->rows[contact->first_row + i];
        if (row->delivered.is_measured) {
            const double error = shown->of(&row->delivered.figures, &contact->asked);
            plot_spot(panel->svg, plot_x(panel, row->step_s * UNITS_US),
                      plot_y(panel, fmin(fmax(error, ERROR_LEAST), ERROR_MOST)), 3.6,
                      map_plot_style_of(row->map).colour, "#fff", 1.0);
        }
    }
}

static void draw_panel(const MappingReport *report, const MappingContact *contact, double left,
                       double top, const Shown *shown, Text *svg)
{
    const MappingSettings *settings = &report->mapping->settings;
    const bool is_poisson = mapping_report_is_poisson(report);
    PlotPanel panel = {
        .svg = svg,
        .title = "",
        .left = left,
        .top = top,
        .width = PANEL_WIDTH,
        .height = PANEL_HEIGHT,
        .x = step_axis(settings),
        .y = {.title = shown->title, .scale = AXIS_LOG, .low = ERROR_LEAST, .high = ERROR_MOST},
    };
    plot_fine_grid(&panel);
    plot_enter(&panel);
    map_plot_draw_band(&panel);
    const size_t map_count = is_poisson ? 1 : settings->map_count;
    for (size_t i = 0; i < map_count; i++) {
        draw_curve(&panel, contact, is_poisson ? ODE_MAP_TEXTBOOK : settings->maps[i], shown);
    }
    map_plot_draw_dots(report, &panel, contact, shown);
    plot_leave(&panel);
}

static void draw_contact(const MappingReport *report, size_t number, Text *svg)
{
    const MappingContact *contact = &report->mapping->contacts[number];
    const double top = HEAD_HEIGHT + ROW_HEIGHT * (double)number + 30.0;
    char law[MAPPING_REPORT_LAW_SIZE];
    char words[LINKAGE_NAME_SIZE + 256];
    mapping_report_law(contact, law);
    const JointUnits *units = mapping_report_units(contact);
    snprintf(words, sizeof words, "%s, %s: %.4g %s at %.4g %s, asked: restitution %.3g",
             mapping_report_joint(contact)->name, law, contact->impact.mass, units->mass,
             contact->impact.speed, units->rate, contact->asked.restitution);
    plot_text(svg, PANEL_LEFT, top - 14.0, "start", "", words);
    if (contact->lack[0] != '\0') {
        plot_text(svg, PANEL_LEFT, top + 14.0, "start", "note", "not mapped: see the tables");
        return;
    }
    const Shown restitution = {"largest error of restitution, relative", restitution_of};
    draw_panel(report, contact, PANEL_LEFT, top, &restitution, svg);
    if (!mapping_report_is_poisson(report)) {
        const Shown peak = {"largest error of the peak force, relative", peak_of};
        draw_panel(report, contact, PANEL_LEFT + PANEL_DISTANCE, top, &peak, svg);
    }
}

static void map_plot_draw_legend(const MappingReport *report, Text *svg)
{
    const MappingSettings *settings = &report->mapping->settings;
    double x = PANEL_LEFT;
    for (size_t i = 0; i < settings->map_count && !mapping_report_is_poisson(report); i++) {
        plot_sample(svg, x, 78.0, map_plot_style_of(settings->maps[i]));
        plot_text(svg, x + 38.0, 82.0, "start", "", OPTIONS_ODE_MAPS[settings->maps[i]]);
        x += LEGEND_DISTANCE;
    }
    plot_text(
        svg, PANEL_LEFT, 56.0, "start", "note",
        "lines: predicted; dots: delivered by ODE, a single pin of the joint's effective mass; "
        "the largest error wherever the steps fall");
}

void mapping_plot_write(const void *of, Text *svg)
{
    const MappingReport *report = of;
    const size_t count = report->mapping->contact_count;
    const size_t drawn = count < PICTURE_CONTACTS ? count : PICTURE_CONTACTS;
    plot_begin(svg, PICTURE_WIDTH, HEAD_HEIGHT + ROW_HEIGHT * (double)drawn,
               report->scenario->title);
    plot_text(svg, PANEL_LEFT, 34.0, "start", "title", report->scenario->title);
    map_plot_draw_legend(report, svg);
    for (size_t i = 0; i < drawn; i++) {
        draw_contact(report, i, svg);
    }
    if (drawn < count) {
        char words[64];
        snprintf(words, sizeof words, "%zu more contacts are in the tables", count - drawn);
        plot_text(svg, PICTURE_WIDTH - 30.0, 56.0, "end", "note", words);
    }
    plot_end(svg);
}
