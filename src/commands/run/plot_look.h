// Which line, colour and axis stands for what in the picture of a run.
#pragma once

#include "commands/run/plot_view.h"
#include "write/plot.h"

// Something drawn over the crank angle: of a body or a joint, its number in the ranges of a run or,
// where these do not hold it, its value at a sample.
typedef struct PlotQuantity {
    const char *name;
    bool is_joint;
    int signal; // RANGES_OMEGA and its like; -1: samples are all there is
    double (*at)(const RunReport *report, const Trajectory *run, size_t sample, size_t index);
} PlotQuantity;

// A stretch of a run in which a quantity went from one value to another: as the ranges have it, or
// one sample.
typedef struct PlotStretch {
    double time_s;
    Range range; // least > most where nothing is known
} PlotStretch;

size_t plot_look_stretch_count(const Trajectory *run, PlotQuantity quantity);
PlotStretch plot_look_stretch(const RunReport *report, const Trajectory *run, PlotQuantity quantity,
                              size_t stretch, size_t index);

// Whether the panels of all bodies or joints draw one.
bool plot_look_shows(const PlotView *view, bool is_joint, size_t index);

// The number of the colour of a body or joint.
size_t plot_look_colour(const PlotView *view, bool is_joint, size_t index);

// The axis of the crank angle from the start, or of time where no driver turns at constant speed.
Axis plot_look_x_axis(const PlotView *view);

// Where on it an instant stands.
double plot_look_x(const PlotView *view, double crank_rad, double time_s);

// Greys what is before the reported time.
void plot_look_shade(const PlotView *view, const PlotPanel *panel);

// The run whose strongest spikes the tables list, the last that has any; NULL where none has.
const Trajectory *plot_look_spike_run(const PlotView *view);

// Marks the spikes of one signal that the tables list.
void plot_look_marks(const PlotView *view, const PlotPanel *panel, const SignalSpikes *spikes,
                     PlotQuantity quantity, size_t index, const char *unit);

// Draws one quantity of one body or joint of one run.
void plot_look_draw(const PlotView *view, const PlotPanel *panel, size_t run, PlotQuantity quantity,
                    size_t index);

// Draws in grey, of all bodies or joints that are left out, from the least to the largest value of
// a quantity in the last run that is complete; nothing where none is.
void plot_look_others(const PlotView *view, const PlotPanel *panel, PlotQuantity quantity);

// Where the path of a joint stands at a sample, in the units of its panel.
typedef struct PlotPath {
    size_t joint;
    int end;          // of a hole in space; 0: the line is not dashed
    double per_metre; // the panel's unit, of a pin in its hole
    Vec2 (*at)(const RunReport *report, const Trajectory *run, size_t sample,
               const struct PlotPath *path);
} PlotPath;

// Draws the path of one joint of one run.
void plot_look_path(const PlotView *view, const PlotPanel *panel, size_t run, const PlotPath *path);

// How the bodies move: which 0 a rate, 1 how that changes. They are the angular velocity and
// acceleration, or speed and acceleration of the centres where nothing turns. The panel gets its
// titles.
void plot_motions_draw(const PlotView *view, int which, PlotPanel panel);

// Joint forces over the crank angle, every step of them, with a dot for the strongest contacts and
// marks for the spikes of the table.
void plot_joints_forces(const PlotView *view, PlotPanel panel);

// The path of each pin in its hole, in space of its middle across the hole's axis, as the
// eccentricity over the radial clearance where several joints have play.
void plot_joints_paths(const PlotView *view, PlotPanel panel);

// An offset, m, of a pin in its hole in space as what it is across the hole's axis, in two
// directions at right angles: the world's x and y where that axis is z.
Vec2 plot_pins_across(const RunReport *report, const Trajectory *run, size_t sample, size_t joint,
                      Vec3 offset);

// Of a linkage in space: how each pin tilts, and the path of its axis at both ends of its hole in
// the last run that has any.
void plot_pins_tilts(const PlotView *view, PlotPanel panel);
void plot_pins_ends(const PlotView *view, PlotPanel panel);

// Of blocks between guides: the path of each over its play and its tilt, both over the crank angle,
// and where its corners touch; of any slider its acceleration along its line; of stops how far the
// bodies are from them.
void plot_slides_paths(const PlotView *view, PlotPanel panel);
void plot_slides_accelerations(const PlotView *view, PlotPanel panel);
void plot_slides_offsets(const PlotView *view, PlotPanel panel);
void plot_slides_tilts(const PlotView *view, PlotPanel panel);
void plot_slides_stops(const PlotView *view, PlotPanel panel);

// Of limited coordinates: where they are between their stops, or in their backlash; and whether a
// linkage has any of a kind that are angles, or lengths.
void plot_limits_angles(const PlotView *view, PlotPanel panel);
void plot_limits_lengths(const PlotView *view, PlotPanel panel);
void plot_limits_angle_gaps(const PlotView *view, PlotPanel panel);
void plot_limits_length_gaps(const PlotView *view, PlotPanel panel);
bool plot_limits_any(const Linkage *linkage, bool is_angle, LimitKind kind);

// Of the one that a torque drives that changes over time: where it is over that torque; and whether
// a linkage has that.
void plot_limits_loop(const PlotView *view, PlotPanel panel);
bool plot_limits_has_loop(const Linkage *linkage);

// Of a mechanism of which something is left out: the largest value of every body and joint in each
// run, over their numbers in the case.
void plot_overview_bodies(const PlotView *view, PlotPanel panel);
void plot_overview_joints(const PlotView *view, PlotPanel panel);

// Where no joint has play: how far omega is from the run that is taken as the truth.
void plot_joints_errors(const PlotView *view, PlotPanel panel);
