// Which line, colour and axis each quantity has in the picture of a run, and which bodies and
// joints it draws.
#pragma once

#include "commands/run/run_report.h"
#include "write/plot.h"

#include <stdbool.h>

// What of a mechanism a picture draws, and in which colour.

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

// Which line, colour and axis stands for what in the picture of a run.

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

// The line of a run in the colour of that number: a dark one, very thin, of the run with ideal
// joints where others have play; of the others the kinds of write/plot.h in their order.
PlotStyle plot_look_style(const PlotView *view, size_t run, size_t colour);

// The run that is drawn as the i-th: the one with ideal joints last, for it lies on the others.
size_t plot_look_run(const PlotView *view, size_t i);

// The axis of the crank angle from the start, or of time where no driver turns at constant speed.
Axis plot_look_x_axis(const PlotView *view);

// Where on it an instant stands.
double plot_look_x(const PlotView *view, double crank_rad, double time_s);

// Greys what is before the reported time.
void plot_look_shade(const PlotView *view, const PlotPanel *panel);

// The run whose strongest spikes the tables list, the last that has any; NULL where none has.
const Trajectory *plot_look_spike_run(const PlotView *view);

// How much farther than the largest value an axis goes, so that the mark there is in the frame.
static const double PLOT_MARK_ROOM = 1.04;

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
    // Where it stands at a mark of a contact; NULL: it is drawn through the samples alone.
    Vec2 (*at_mark)(const Trajectory *run, const ContactMark *mark, const struct PlotPath *path);
    bool is_straight; // between the samples: nothing is known of it there
    // How it moves there, per second; NULL: not known.
    Vec2 (*rate)(const RunReport *report, const Trajectory *run, size_t sample,
                 const struct PlotPath *path);
} PlotPath;

// Has every place seen of the path of a joint: at the samples and at the marks.
typedef void PlotPathSee(void *context, Vec2 place);
void plot_look_places(const RunReport *report, const Trajectory *run, const PlotPath *path,
                      PlotPathSee *see, void *context);

// Draws the path of one joint of one run: through samples and marks, between them a cubic with the
// rates at both or, where these are not known, one that leaves their range in neither direction.
void plot_look_path(const PlotView *view, const PlotPanel *panel, size_t run, const PlotPath *path);

// Joint forces over the crank angle, every step of them, with a dot for the strongest contacts and
// marks for the spikes of the table; from 0, or in decades where the report asks for them.
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

// Of blocks between guides the path of each over its play and its tilt, and where its corners
// touch.
void plot_slides_paths(const PlotView *view, PlotPanel panel);

// What a panel of sliders, blocks or stops shows over the crank angle.
typedef enum PlotSlide {
    PLOT_SLIDE_OFFSET, // of blocks between guides, across them
    PLOT_SLIDE_TILT,
    PLOT_SLIDE_POSITION, // of any slider along its line
    PLOT_SLIDE_SPEED,
    PLOT_SLIDE_ACCELERATION,
    PLOT_SLIDE_STOP, // how far bodies are from their stops
} PlotSlide;

void plot_slides_draw(const PlotView *view, PlotPanel panel, PlotSlide which);

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

// How far omega, or the velocity of the centres where nothing turns, is from the run that is taken
// as the truth, of runs that feel the play where there is any; and whether there is such a run, in
// which a body moves otherwise.
void plot_errors_draw(const PlotView *view, PlotPanel panel);
bool plot_errors_any(const PlotView *view);

// What the drive of a pivot has to give, or gives; and whether a linkage has that.
void plot_loads_torque(const PlotView *view, PlotPanel panel);
bool plot_loads_has_torque(const Linkage *linkage);

// The force on each pin as seen from its hole, a path about the middle: where on the wall it bears,
// and how hard.
void plot_loads_pins(const PlotView *view, PlotPanel panel);
