// The lower panels of a run's picture: what the joints felt.
#pragma once

#include "commands/run/plot_look.h"

// Joint forces over the crank angle, every step of them, with a dot for the strongest contacts and
// marks for the spikes of the table.
void plot_joints_forces(const RunReport *report, PlotPanel panel);

// The path of each pin in its hole, as the eccentricity over the radial clearance where several
// joints have play.
void plot_joints_paths(const RunReport *report, PlotPanel panel);

// Where no joint has play: how far omega is from the run that is taken as the truth.
void plot_joints_errors(const RunReport *report, PlotPanel panel);
