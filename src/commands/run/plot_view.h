// What of a mechanism a picture draws, and in which colour.
#pragma once

#include "commands/run/run_report.h"

#include <stdbool.h>

// The bodies or the joints of a mechanism, by their numbers.
typedef struct PlotSet {
    size_t drawn;      // in the panels of all; the sum of this and the next is what these are about
    size_t left_out;   // of them, because there are so many
    bool *is_shown;    // it is drawn in them; owned, like the four below
    bool *is_other;    // it is left out of them
    bool *is_left_out; // from every panel
    bool *is_named;    // some panel draws it in its colour, which the legend has
    unsigned *of_palette; // the number of its colour
} PlotSet;

// Driven bodies are not shown, and ideal joints only where no joint has play. Of many bodies, or of
// many joints of a kind, those are drawn that have the largest accelerations or forces; in grey
// what the others do.
typedef struct PlotView {
    const RunReport *report;
    bool turns; // the rotation of the bodies is shown, and not the motion of their centres
    PlotSet bodies;
    PlotSet joints;
} PlotView;

// For plot_view_finish.
PlotView plot_view_begin(const RunReport *report);
void plot_view_finish(PlotView *view);

const PlotSet *plot_view_set(const PlotView *view, bool is_joint);

// What most happens to a body or a joint in a complete run: its largest angular acceleration,
// rad/s^2, or acceleration where nothing turns, m/s^2; its largest force, N.
double plot_view_most(const PlotView *view, bool is_joint, const Trajectory *run, size_t number);
