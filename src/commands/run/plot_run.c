// Draws a run as SVG: the motion of its bodies, and below it what its joints did.
#include "base/sorted.h"
#include "base/zeroed.h"
#include "commands/run/plot_lines.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The panels of the bodies' motion: their rotation, or their centres where nothing turns.

// a symmetric logarithmic scale is used where one backend exceeds another by this factor, or
// exceeds what it stays below for most of its run
static const double SPIKY = 8.0;
static const double USUAL = 0.9;

static double plot_run_omega_of(const RunReport *report, const Trajectory *run, size_t sample,
                                size_t body)
{
    (void)report;
    return trajectory_motion(run, sample, body)->omega;
}

static double plot_run_alpha_of(const RunReport *report, const Trajectory *run, size_t sample,
                                size_t body)
{
    (void)report;
    return trajectory_motion(run, sample, body)->alpha;
}

static double speed_of(const RunReport *report, const Trajectory *run, size_t sample, size_t body)
{
    (void)report;
    const Vec2 velocity = trajectory_motion(run, sample, body)->velocity;
    return hypot(velocity.x, velocity.y);
}

static double plot_run_acceleration_of(const RunReport *report, const Trajectory *run,
                                       size_t sample, size_t body)
{
    (void)report;
    const Vec2 acceleration = trajectory_motion(run, sample, body)->acceleration;
    return hypot(acceleration.x, acceleration.y);
}

// How far a quantity goes in one run, over all bodies that are shown.
typedef struct Reach {
    double low;
    double high;
    double usual; // what most of the run stays below on either side of zero
} Reach;

// The marks of spikes stand in the frame, too.
static void widen_by_spikes(const PlotView *view, const Trajectory *run, PlotQuantity quantity,
                            Reach *reach)
{
    for (size_t body = 0; quantity.signal == RANGES_ALPHA && body < run->body_count; body++) {
        const SignalSpikes *spikes = &run->alpha_spikes[body];
        for (size_t i = 0; view->bodies.is_shown[body] && spikes->is_known && i < spikes->kept;
             i++) {
            reach->low = fmin(reach->low, PLOT_MARK_ROOM * spikes->spikes[i].value);
            reach->high = fmax(reach->high, PLOT_MARK_ROOM * spikes->spikes[i].value);
        }
    }
}

static Reach plot_run_find_reach(const PlotView *view, const Trajectory *run, PlotQuantity quantity)
{
    const PlotSet *bodies = &view->bodies;
    Reach reach = {.low = INFINITY, .high = -INFINITY};
    const size_t count = plot_look_stretch_count(run, quantity);
    double *sizes = calloc(count, sizeof *sizes);
    assert(sizes != NULL);
    for (size_t i = 0; i < count; i++) {
        for (size_t body = 0; body < run->body_count; body++) {
            if (!bodies->is_shown[body] && !bodies->is_other[body]) {
                continue;
            }
            const Range range = plot_look_stretch(view->report, run, quantity, i, body).range;
            if (range.least <= range.most) {
                reach.low = fmin(reach.low, range.least);
                reach.high = fmax(reach.high, range.most);
                sizes[i] = fmax(sizes[i], fmax(-range.least, range.most));
            }
        }
    }
    widen_by_spikes(view, run, quantity, &reach);
    sorted_make(sizes, count);
    reach.usual = sizes[(size_t)(USUAL * (double)(count - 1))];
    free(sizes);
    return reach;
}

// A linear scale, unless one backend dwarfs another, or spikes dwarf the rest of a run.
static void choose_scale(const PlotView *view, PlotQuantity quantity, Axis *axis)
{
    const RunReport *report = view->report;
    double least = INFINITY;
    axis->low = INFINITY;
    axis->high = -INFINITY;
    for (size_t i = 0; i < report->run_count; i++) {
        if (!report->runs[i]->is_complete) {
            continue;
        }
        const Reach reach = plot_run_find_reach(view, report->runs[i], quantity);
        const double size = fmax(-reach.low, reach.high);
        least = size > 0.0 ? fmin(least, size) : least;
        least = reach.usual > 0.0 ? fmin(least, reach.usual) : least;
        axis->low = fmin(axis->low, reach.low);
        axis->high = fmax(axis->high, reach.high);
    }
    const double most = fmax(-axis->low, axis->high);
    if (most > SPIKY * least) {
        const bool is_size = axis->low >= 0.0;
        axis->scale = AXIS_SYMLOG;
        axis->threshold = pow(10.0, floor(log10(least)));
        axis->high = pow(10.0, ceil(log10(most)));
        // what is never below 0 needs no room there
        axis->low = is_size ? 0.0 : -axis->high;
    } else {
        axis_fit(&axis->low, &axis->high);
    }
}

static void draw_motion(const PlotView *view, PlotPanel panel, PlotQuantity quantity,
                        bool has_spikes)
{
    const RunReport *report = view->report;
    choose_scale(view, quantity, &panel.y);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    plot_look_others(view, &panel, quantity);
    for (size_t i = 0; i < report->run_count; i++) {
        const size_t run = plot_look_run(view, i);
        for (size_t body = 0; body < report->scenario->linkage.body_count; body++) {
            if (plot_look_shows(view, false, body) && report->runs[run]->is_complete) {
                plot_look_draw(view, &panel, run, quantity, body);
            }
        }
    }
    plot_leave(&panel);
    // marks at the edge are not cut
    const Trajectory *spiky = has_spikes ? plot_look_spike_run(view) : NULL;
    for (size_t body = 0; spiky != NULL && body < spiky->body_count; body++) {
        if (plot_look_shows(view, false, body)) {
            plot_look_marks(view, &panel, &spiky->alpha_spikes[body], quantity, body, "rad/s^2");
        }
    }
}

// How bodies turn whose axes are not all along z: the sizes of their vectors.
static double turning_of(const RunReport *report, const Trajectory *run, size_t sample, size_t body)
{
    return run->space_motions != NULL
               ? vec3_length(trajectory_space_motion(run, sample, body)->omega)
               : fabs(plot_run_omega_of(report, run, sample, body));
}

static double spinning_up_of(const RunReport *report, const Trajectory *run, size_t sample,
                             size_t body)
{
    return run->space_motions != NULL
               ? vec3_length(trajectory_space_motion(run, sample, body)->alpha)
               : fabs(plot_run_alpha_of(report, run, sample, body));
}

// A pair of panels: a rate of the bodies' motion and how that changes.
typedef struct MotionPanels {
    const char *titles[2];
    const char *axes[2];
    PlotQuantity quantities[2];
    bool has_spikes; // the second
} MotionPanels;

// The rotation of the bodies, or the motion of their centres where nothing turns.
static const MotionPanels *choose_motions(const PlotView *view)
{
    static const MotionPanels PANELS[] = {
        {{"Angular velocity", "Angular acceleration"},
         {"omega, rad/s", "alpha, rad/s^2"},
         {{"omega", false, RANGES_OMEGA, plot_run_omega_of},
          {"alpha", false, RANGES_ALPHA, plot_run_alpha_of}},
         true},
        {{"Speed of the centre of mass", "Acceleration of the centre of mass"},
         {"speed, m/s", "acceleration, m/s^2"},
         {{"speed", false, -1, speed_of},
          {"acceleration", false, RANGES_ACCELERATION, plot_run_acceleration_of}},
         false},
        {{"Angular velocity about z", "Angular acceleration about z"},
         {"omega, rad/s", "alpha, rad/s^2"},
         {{"omega", false, RANGES_OMEGA, plot_run_omega_of},
          {"alpha", false, RANGES_ALPHA, plot_run_alpha_of}},
         true},
        {{"Angular velocity, its size at the samples", "Angular acceleration, its size"},
         {"|omega|, rad/s", "|alpha|, rad/s^2"},
         {{"|omega|", false, -1, turning_of}, {"|alpha|", false, -1, spinning_up_of}},
         false},
    };
    const Linkage *linkage = &view->report->scenario->linkage;
    return &PANELS[!view->turns ? 1 : !linkage->is_spatial ? 0 : space_has_plane(linkage) ? 2 : 3];
}

// How the bodies move: which 0 a rate, 1 how that changes. They are the angular velocity and
// acceleration, or speed and acceleration of the centres where nothing turns. The panel gets its
// titles.
static void plot_motions_draw(const PlotView *view, int which, PlotPanel panel)
{
    const MotionPanels *panels = choose_motions(view);
    panel.title = panels->titles[which];
    panel.y.title = panels->axes[which];
    draw_motion(view, panel, panels->quantities[which], which == 1 && panels->has_spikes);
}

// The panels of very many bodies and joints: what each came to.
//
// The largest acceleration and force of all of them, over their numbers in the case: the only
// panels of a large mechanism that leave nothing out.

static const double DEPTH = 1e-6; // the axis ends at this share of the largest value

// Whether something is in the panels of all, drawn there or not.
static bool is_in(const PlotSet *set, size_t number)
{
    return set->is_shown[number] || set->is_other[number];
}

static void plot_run_choose_axis(const PlotView *view, bool is_joint, size_t count, Axis *axis)
{
    const PlotSet *set = plot_view_set(view, is_joint);
    Range range = RANGE_EMPTY;
    for (size_t run = 0; run < view->report->run_count; run++) {
        for (size_t i = 0; view->report->runs[run]->is_complete && i < count; i++) {
            const double value =
                is_in(set, i) ? plot_view_most(view, is_joint, view->report->runs[run], i) : 0.0;
            if (value > 0.0) {
                range_add(&range, value);
            }
        }
    }
    axis->scale = AXIS_LOG;
    axis->high = range.most > 0.0 ? pow(10.0, ceil(log10(range.most))) : 1.0;
    axis->low =
        fmax(pow(10.0, floor(log10(fmin(range.least, 0.1 * axis->high)))), DEPTH * axis->high);
}

// The numbers of all over those of the case, and a dot for those that other panels draw.
static void draw_run(const PlotView *view, const PlotPanel *panel, bool is_joint, size_t run,
                     size_t count)
{
    const PlotSet *set = plot_view_set(view, is_joint);
    const Trajectory *trajectory = view->report->runs[run];
    double *x = zeroed(2 * count, sizeof *x);
    double *y = x + count;
    size_t drawn = 0;
    for (size_t i = 0; i < count; i++) {
        if (is_in(set, i)) {
            x[drawn] = (double)(i + 1);
            y[drawn++] = plot_view_most(view, is_joint, trajectory, i);
        }
    }
    PlotStyle style = plot_look_style(view, run, 0);
    style.colour = "#333333";
    plot_line(panel, drawn, x, y, style);
    for (size_t i = 0; i < count; i++) {
        if (set->is_shown[i]) {
            plot_dot(panel, (double)(i + 1), plot_view_most(view, is_joint, trajectory, i),
                     plot_look_style(view, run, plot_look_colour(view, is_joint, i)));
        }
    }
    free(x);
}

static void plot_run_draw(const PlotView *view, PlotPanel panel, bool is_joint)
{
    const Linkage *linkage = &view->report->scenario->linkage;
    const size_t count = is_joint ? linkage->joint_count : linkage->body_count;
    panel.x = (Axis){.title = is_joint ? "number of the joint, as in the case"
                                       : "number of the body, as in the case",
                     .low = 1.0,
                     .high = (double)count};
    plot_run_choose_axis(view, is_joint, count, &panel.y);
    plot_enter(&panel);
    for (size_t run = 0; run < view->report->run_count; run++) {
        if (view->report->runs[run]->is_complete) {
            draw_run(view, &panel, is_joint, run, count);
        }
    }
    plot_leave(&panel);
}

static void plot_overview_bodies(const PlotView *view, PlotPanel panel)
{
    panel.title = "All bodies: the largest of the whole run";
    panel.y.title = view->turns ? "|alpha|, rad/s^2" : "acceleration, m/s^2";
    plot_run_draw(view, panel, false);
}

// Of a mechanism of which something is left out: the largest value of every body and joint in each
// run, over their numbers in the case.
static void plot_overview_joints(const PlotView *view, PlotPanel panel)
{
    panel.title = "All joints: the largest of the whole run";
    panel.y.title = "force, N";
    plot_run_draw(view, panel, true);
}

static const double PICTURE_WIDTH = 1000.0; // pixels, as all that follow
static const double PICTURE_HEIGHT = 880.0;
static const double ROW_HEIGHT = 384.0; // of every row of panels after the second
static const double PANEL_WIDTH = 390.0;
static const double PANEL_HEIGHT = 290.0;
static const double PANEL_LEFT[2] = {84.0, 584.0};
static const double PANEL_TOP = 146.0; // of the first row
static const double LEGEND_TOP = 62.0;
static const double LEGEND_ROW = 22.0;
static const double LEGEND_END = 106.0; // the last row that leaves the panels where they are

// The part of a picture that is drawn below its legend.
typedef struct Sheet {
    Text *svg;
    double top;   // of the first row of panels
    size_t count; // of all panels
} Sheet;

// The panel of that number. One that has no other beside it takes the whole row.
static PlotPanel place_panel(const PlotView *view, Sheet sheet, size_t number, const char *title)
{
    const bool is_alone = number % 2 == 0 && number + 1 == sheet.count;
    return (PlotPanel){
        .svg = sheet.svg,
        .title = title,
        .left = PANEL_LEFT[number % 2],
        .top = sheet.top + (double)(number / 2) * ROW_HEIGHT,
        .width = is_alone ? PANEL_LEFT[1] - PANEL_LEFT[0] + PANEL_WIDTH : PANEL_WIDTH,
        .height = PANEL_HEIGHT,
        .x = plot_look_x_axis(view),
    };
}

// Where the next entry of the legend begins.
typedef struct Legend {
    Text *svg;
    double x;
    double y;
} Legend;

static void plot_run_add_entry(Legend *legend, PlotStyle style, const char *words)
{
    // a character of this font takes some 7 pixels
    const double width = 37.0 + 7.2 * (double)strlen(words) + 22.0;
    if (legend->x + width > PICTURE_WIDTH) {
        legend->x = PANEL_LEFT[0];
        legend->y += LEGEND_ROW;
    }
    plot_sample(legend->svg, legend->x, legend->y - 4.0, style);
    plot_text(legend->svg, legend->x + 37.0, legend->y, "start", "", words);
    legend->x += width;
}

// the label, with the backend before it where the label does not begin with it
static void name_run(const Trajectory *run, char *words, size_t size)
{
    const bool is_named = strncmp(run->label, run->backend, strlen(run->backend)) == 0;
    snprintf(words, size, "%s%s%s%s", is_named ? "" : run->backend, is_named ? "" : ": ",
             run->label, run->is_complete ? "" : " (failed)");
}

static void add_marks(Legend *legend, const Trajectory *run)
{
    char words[LINKAGE_NAME_SIZE + 64];
    snprintf(words, sizeof words, "spikes of the table, %s", run->backend);
    plot_run_add_entry(legend, (PlotStyle){"#333333", 0.0, 0.0, NULL}, words);
    const double width = 37.0 + 7.2 * (double)strlen(words) + 22.0;
    plot_mark_sample(legend->svg, legend->x - width + 20.0, legend->y,
                     (PlotStyle){"#333333", 1.0, 1.0, NULL});
}

// The colour of a body or joint that a panel draws.
static void add_colour(Legend *legend, const PlotView *view, bool is_joint, size_t index,
                       const char *what, const char *name)
{
    if (plot_view_set(view, is_joint)->is_named[index]) {
        PlotStyle style = plot_style(1, plot_look_colour(view, is_joint, index));
        style.width = 3.0;
        char words[LINKAGE_NAME_SIZE + 16];
        snprintf(words, sizeof words, "%s%s", what, name);
        plot_run_add_entry(legend, style, words);
    }
}

// Says how many of a set are drawn, and which.
static void add_left_out(Legend *legend, const PlotSet *set, const char *what, const char *by)
{
    if (set->left_out > 0) {
        char words[128];
        snprintf(words, sizeof words,
                 "%zu of %zu %s are drawn, those of the largest %s; grey: the range of the others",
                 set->drawn, set->drawn + set->left_out, what, by);
        legend->y += LEGEND_ROW;
        plot_text(legend->svg, PANEL_LEFT[0], legend->y, "start", "note", words);
    }
}

// Returns where its last row stands.
static double plot_run_draw_legend(const PlotView *view, Text *svg)
{
    const RunReport *report = view->report;
    Legend legend = {svg, PANEL_LEFT[0], LEGEND_TOP};
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        PlotStyle style = plot_look_style(view, i, 0);
        style.colour = style.width < plot_style(1, 0).width ? "#000000" : "#666666";
        char words[TRAJECTORY_LABEL_SIZE + LINKAGE_NAME_SIZE + 16];
        name_run(run, words, sizeof words);
        plot_run_add_entry(&legend, style, words);
    }
    legend.x = PANEL_LEFT[0];
    legend.y += LEGEND_ROW;
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        add_colour(&legend, view, false, i, "", linkage->bodies[i].name);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        add_colour(&legend, view, true, i, "joint ", linkage->joints[i].name);
    }
    const Trajectory *spiky = plot_look_spike_run(view);
    if (spiky != NULL) {
        add_marks(&legend, spiky);
    }
    add_left_out(&legend, &view->bodies, "bodies", "accelerations");
    add_left_out(&legend, &view->joints, "joints", "forces");
    return legend.y;
}

// What is drawn from the second panel of the second row on.
typedef void (*DrawPanel)(const PlotView *view, PlotPanel panel);

typedef struct PanelChoice {
    DrawPanel draw; // NULL: that of sliders
    PlotSlide slide;
} PanelChoice;

enum {
    PANEL_MAX = 22,
    FIRST_PANELS = 3, // those of motion and the one of forces
};

static bool plot_run_has_joint(const RunReport *report, JointKinds kinds)
{
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_is_among(linkage->joints[i].kind, kinds)) {
            return true;
        }
    }
    return false;
}

// The panels of the joints that the mechanism has.
static size_t choose_panels(const PlotView *view, PanelChoice panels[PANEL_MAX])
{
    const RunReport *report = view->report;
    size_t count = 0;
    if (plot_run_has_joint(report, JOINTS_WITH_HOLE)) {
        panels[count++].draw = plot_joints_paths;
    }
    if (plot_run_has_joint(report, JOINTS_WITH_HOLE) && report->scenario->linkage.is_spatial) {
        panels[count++].draw = plot_pins_tilts;
        panels[count++].draw = plot_pins_ends;
    }
    if (plot_run_has_joint(report, JOINTS_WITH_GUIDES)) {
        panels[count++].draw = plot_slides_paths;
        panels[count++].slide = PLOT_SLIDE_OFFSET;
        panels[count++].slide = PLOT_SLIDE_TILT;
    }
    const bool is_planar = !report->scenario->linkage.is_spatial;
    if (is_planar && plot_run_has_joint(report, JOINTS_WITH_HOLE)) {
        panels[count++].draw = plot_loads_pins;
    }
    if (plot_run_has_joint(report, JOINTS_THAT_SLIDE)) {
        panels[count++].slide = PLOT_SLIDE_POSITION;
        panels[count++].slide = PLOT_SLIDE_SPEED;
        panels[count++].slide = PLOT_SLIDE_ACCELERATION;
    }
    if (plot_loads_has_torque(&report->scenario->linkage)) {
        panels[count++].draw = plot_loads_torque;
    }
    if (plot_run_has_joint(report, JOINTS_WITH_DISC)) {
        panels[count++].slide = PLOT_SLIDE_STOP;
    }
    static const struct {
        bool is_angle;
        LimitKind kind;
        DrawPanel draw;
    } LIMITED[] = {
        {true, LIMIT_BACKLASH, plot_limits_angle_gaps},
        {true, LIMIT_STOPS, plot_limits_angles},
        {false, LIMIT_BACKLASH, plot_limits_length_gaps},
        {false, LIMIT_STOPS, plot_limits_lengths},
    };
    for (size_t i = 0; i < sizeof LIMITED / sizeof *LIMITED; i++) {
        if (plot_limits_any(&report->scenario->linkage, LIMITED[i].is_angle, LIMITED[i].kind)) {
            panels[count++].draw = LIMITED[i].draw;
        }
    }
    if (plot_limits_has_loop(&report->scenario->linkage)) {
        panels[count++].draw = plot_limits_loop;
    }
    if (view->bodies.left_out > 0) {
        panels[count++].draw = plot_overview_bodies;
    }
    if (view->joints.left_out > 0) {
        panels[count++].draw = plot_overview_joints;
    }
    if (plot_errors_any(view)) {
        panels[count++].draw = plot_errors_draw;
    }
    return count;
}

void plot_run_write(const void *of, Text *svg)
{
    const RunReport *report = of;
    const char *title = report->scenario->title;
    PlotView view = plot_view_begin(report);
    PanelChoice panels[PANEL_MAX] = {0};
    const size_t count = choose_panels(&view, panels);
    // bodies may hang on nothing but bushings and springs
    const bool has_joints = report->scenario->linkage.joint_count > 0;
    const size_t first = FIRST_PANELS - (has_joints ? 0 : 1);
    const size_t all = count + first;
    const double rows_below = (double)((all + 1) / 2) - 2.0;
    Text legend;
    text_init(&legend);
    const double pushed = fmax(0.0, plot_run_draw_legend(&view, &legend) - LEGEND_END);
    const Sheet sheet = {svg, PANEL_TOP + pushed, all};
    plot_begin(svg, PICTURE_WIDTH, PICTURE_HEIGHT + pushed + rows_below * ROW_HEIGHT, title);
    plot_text(svg, PANEL_LEFT[0], 34.0, "start", "title", title);
    text_append(svg, "%s", legend.data);
    text_finish(&legend);
    plot_motions_draw(&view, 0, place_panel(&view, sheet, 0, ""));
    plot_motions_draw(&view, 1, place_panel(&view, sheet, 1, ""));
    if (has_joints) {
        plot_joints_forces(&view, place_panel(&view, sheet, 2, "Force in the joint"));
    }
    for (size_t i = 0; i < count; i++) {
        const PlotPanel panel = place_panel(&view, sheet, first + i, "");
        if (panels[i].draw != NULL) {
            panels[i].draw(&view, panel);
        } else {
            plot_slides_draw(&view, panel, panels[i].slide);
        }
    }
    plot_end(svg);
    plot_view_finish(&view);
}
