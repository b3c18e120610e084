// The lower panels of a run's picture: what the joints felt.
#pragma once

#include "report/plot_look.h"

// Joint forces over the crank angle, each contact kept as a stem of its full height: most last
// shorter than the distance of two samples.
void plot_joints_forces(const RunReport *report, PlotPanel panel);

// The path of each pin in its hole, as the eccentricity over the radial clearance where several
// joints have play.
void plot_joints_paths(const RunReport *report, PlotPanel panel);

// Where no joint has play: how far omega is from the run that is taken as the truth.
void plot_joints_errors(const RunReport *report, PlotPanel panel);
