// Which line, colour and axis stands for what in the picture of a run.
#pragma once

#include "report/plot.h"
#include "report/run_report.h"

// Something drawn over the crank angle: its value at a sample of a body or joint, and the colour
// of that body or joint.
typedef struct PlotQuantity {
    double (*at)(const RunReport *report, const Trajectory *run, size_t sample, size_t index);
    size_t (*colour)(const RunReport *report, size_t index);
} PlotQuantity;

// The line of a run in the colour of that number.
PlotStyle plot_look_line(size_t run, size_t colour);

// Driven bodies are not shown; ideal joints only where no joint has play.
bool plot_look_shows_body(const RunReport *report, size_t body);
bool plot_look_shows_joint(const RunReport *report, size_t joint);

// The number of the colour of a body or joint.
size_t plot_look_body_colour(const RunReport *report, size_t body);
size_t plot_look_joint_colour(const RunReport *report, size_t joint);

// The axis of the crank angle from the start, or of time where there is no driver.
Axis plot_look_x_axis(const RunReport *report);

// Where on it an instant stands.
double plot_look_x(const RunReport *report, double crank_rad, double time_s);

// Draws one quantity of one body or joint of one run.
void plot_look_draw(const RunReport *report, const PlotPanel *panel, size_t run,
                    PlotQuantity quantity, size_t index);
