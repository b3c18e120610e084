// Which line, which colour, which axis stands for what in the picture of a run?
//
// A backend has a kind of line, a body or joint a colour. The first backend is drawn wide and
// pale, the next thin over it: where the two agree, the thin line lies in the middle of the pale.
#include "report/plot_look.h"

#include "report/units.h"

#include <assert.h>
#include <stdlib.h>

enum { PALETTE_SIZE = 6, LINE_KINDS = 3 };

// Okabe and Ito's palette, told apart by the colour-blind too (its yellow is too pale for lines)
static const char *const PALETTE[PALETTE_SIZE] = {"#0072b2", "#d55e00", "#009e73",
                                                  "#cc79a7", "#56b4e9", "#e69f00"};

PlotStyle plot_look_line(size_t run, size_t colour)
{
    static const PlotStyle KINDS[LINE_KINDS] = {
        {NULL, 5.0, 0.32, NULL}, {NULL, 1.3, 1.0, NULL}, {NULL, 1.3, 1.0, "5 3"}};
    PlotStyle style = KINDS[run % LINE_KINDS];
    style.colour = PALETTE[colour % PALETTE_SIZE];
    return style;
}

bool plot_look_shows_body(const RunReport *report, size_t body)
{
    return (int)body != linkage_driven_body(&report->scenario->linkage);
}

bool plot_look_shows_joint(const RunReport *report, size_t joint)
{
    return !scenario_has_clearance(report->scenario) ||
           report->scenario->linkage.joints[joint].kind == JOINT_CLEARANCE;
}

size_t plot_look_joint_colour(const RunReport *report, size_t joint)
{
    size_t colour = 0;
    for (size_t body = 0; body < report->scenario->linkage.body_count; body++) {
        colour += plot_look_shows_body(report, body) ? 1 : 0;
    }
    for (size_t i = 0; i < joint; i++) {
        colour += plot_look_shows_joint(report, i) ? 1 : 0;
    }
    return colour;
}

size_t plot_look_body_colour(const RunReport *report, size_t body)
{
    size_t colour = 0;
    for (size_t i = 0; i < body; i++) {
        colour += plot_look_shows_body(report, i) ? 1 : 0;
    }
    return colour;
}

Axis plot_look_x_axis(const RunReport *report)
{
    const Scenario *scenario = report->scenario;
    if (!scenario->linkage.driver.is_present) {
        return (Axis){.title = "time, ms", .high = scenario_duration(scenario) * UNITS_MS};
    }
    const double turns = scenario->run.revolutions;
    return (Axis){
        .title = "crank angle from the start, deg",
        .high = 360.0 * turns,
        .tick = turns <= 1.0   ? 60.0
                : turns <= 2.0 ? 90.0
                               : 0.0,
    };
}

double plot_look_x(const RunReport *report, double crank_rad, double time_s)
{
    const Driver *driver = &report->scenario->linkage.driver;
    return driver->is_present ? fabs(crank_rad - driver->start) * UNITS_DEG : time_s * UNITS_MS;
}

void plot_look_draw(const RunReport *report, const PlotPanel *panel, size_t run,
                    PlotQuantity quantity, size_t index)
{
    const Trajectory *trajectory = report->runs[run];
    double *x = calloc(trajectory->sample_count, sizeof *x);
    double *y = calloc(trajectory->sample_count, sizeof *y);
    assert(x != NULL && y != NULL);
    for (size_t i = 0; i < trajectory->sample_count; i++) {
        x[i] = plot_look_x(report, trajectory->crank_angles[i], trajectory->times[i]);
        y[i] = quantity.at(report, trajectory, i, index);
    }
    plot_line(panel, trajectory->sample_count, x, y,
              plot_look_line(run, quantity.colour(report, index)));
    free(x);
    free(y);
}
