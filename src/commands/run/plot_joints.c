// Draws what the joints did: forces, the pin in its hole, stops, guides and tilt.
#include "base/sorted.h"
#include "base/zeroed.h"
#include "commands/run/plot_lines.h"
#include "commands/run/run_report.h"
#include "model/coordinate.h"
#include "model/forces.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The tilt of pins in their holes, and where they were at the holes' ends.

static double plot_pins_tilt_of(const RunReport *report, const Trajectory *run, size_t sample,
                                size_t joint)
{
    (void)report;
    return trajectory_space_state(run, sample, joint)->tilt * UNITS_MRAD;
}

static const PlotQuantity PIN_TILT = {"tilt, mrad", true, -1, plot_pins_tilt_of};

static bool plot_pins_shows(const PlotView *view, size_t run, size_t joint)
{
    return !view->joints.is_left_out[joint] &&
           joint_has_hole(view->report->scenario->linkage.joints[joint].kind) &&
           trajectory_feels_play(view->report->runs[run],
                                 &view->report->scenario->linkage.joints[joint]);
}

// The world's z is turned into the hole's axis on the shortest way, and x and y with it: so they
// move as smoothly as the axis does. An axis that points to the back at the start is taken the
// other way round.
Vec2 plot_pins_across(const RunReport *report, const Trajectory *run, size_t sample, size_t joint,
                      Vec3 offset)
{
    const SpaceEnd hole = space_end(&report->scenario->linkage, joint, 0);
    const SpaceMotion *first = trajectory_space_motion(run, 0, 0);
    const SpaceMotion *motions = trajectory_space_motion(run, sample, 0);
    const double sign = space_direction(first, hole.body, hole.axis).z < 0.0 ? -1.0 : 1.0;
    const Vec3 axis = vec3_scale(sign, space_direction(motions, hole.body, hole.axis));
    // only an axis that turns over comes to -z, where no way is the shortest
    const double share = 1.0 / fmax(1.0 + axis.z, 1e-9);
    const Vec3 x = {1.0 - share * axis.x * axis.x, -share * axis.x * axis.y, -axis.x};
    const Vec3 y = {-share * axis.x * axis.y, 1.0 - share * axis.y * axis.y, -axis.y};
    return (Vec2){vec3_dot(x, offset), vec3_dot(y, offset)};
}

// The tilt at which a pin touches at both ends, mrad.
static double plot_pins_tilt_limit(const Joint *joint)
{
    return asin(fmin(1.0, 2.0 * linkage_radial_clearance(joint) / joint->clearance.width)) *
           UNITS_MRAD;
}

void plot_pins_tilts(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    const Linkage *linkage = &report->scenario->linkage;
    panel.title = "Tilt of the pin; dashed: both ends touch";
    panel.y.title = "tilt, mrad";
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        const bool has_play =
            joint_has_hole(linkage->joints[joint].kind) && !view->joints.is_left_out[joint];
        const double limit = has_play ? plot_pins_tilt_limit(&linkage->joints[joint]) : 0.0;
        panel.y.high = fmax(panel.y.high, 1.08 * limit);
        for (size_t run = 0; run < report->run_count; run++) {
            for (size_t i = 0;
                 plot_pins_shows(view, run, joint) && i < report->runs[run]->sample_count; i++) {
                panel.y.high = fmax(panel.y.high,
                                    1.05 * plot_pins_tilt_of(report, report->runs[run], i, joint));
            }
        }
    }
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        if (joint_has_hole(linkage->joints[joint].kind) && !view->joints.is_left_out[joint]) {
            const double limit = plot_pins_tilt_limit(&linkage->joints[joint]);
            const PlotStyle style = {"#222222", 1.2, 1.0, "6 4"};
            plot_line(&panel, 2, (const double[]){panel.x.low, panel.x.high},
                      (const double[]){limit, limit}, style);
        }
        for (size_t run = 0; run < report->run_count; run++) {
            if (plot_pins_shows(view, run, joint)) {
                plot_look_draw(view, &panel, run, PIN_TILT, joint);
            }
        }
    }
    plot_leave(&panel);
}

// Where the pin's axis is at an end of the hole, as a share of the play.
static Vec2 end_at(const RunReport *report, const Trajectory *run, size_t sample,
                   const PlotPath *path)
{
    const Vec3 offset = trajectory_space_state(run, sample, path->joint)->ends[path->end];
    const Joint *joint = &report->scenario->linkage.joints[path->joint];
    return vec2_scale(1.0 / linkage_radial_clearance(joint),
                      plot_pins_across(report, run, sample, path->joint, offset));
}

// How far the axis of any pin comes from the middle of an end of its hole, of its play.
static double plot_pins_farthest(const PlotView *view)
{
    const RunReport *report = view->report;
    double most = 0.0;
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            for (size_t i = 0;
                 plot_pins_shows(view, run, joint) && i < report->runs[run]->sample_count; i++) {
                for (int end = 0; end < 2; end++) {
                    const PlotPath path = {.joint = joint, .end = end};
                    most = fmax(most, vec2_length(end_at(report, report->runs[run], i, &path)));
                }
            }
        }
    }
    return most;
}

void plot_pins_ends(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    static const PlotStyle WALL = {"#222222", 1.6, 1.0, "6 4"};
    const double high = fmax(1.15, 1.06 * plot_pins_farthest(view));
    const double wide = high * panel.width / panel.height;
    panel.title = "Pin's axis at the hole's ends; broken: front";
    panel.x = (Axis){.title = "across, of the radial clearance", .low = -wide, .high = wide};
    panel.y = (Axis){.title = "of the radial clearance", .low = -high, .high = high};
    plot_enter(&panel);
    for (size_t run = report->run_count; run-- > 0;) {
        bool is_drawn = false;
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            for (int end = 0; plot_pins_shows(view, run, joint) && end < 2; end++) {
                plot_look_path(view, &panel, run,
                               &(PlotPath){.joint = joint, .end = end, .at = end_at});
                is_drawn = true;
            }
        }
        if (is_drawn) {
            break; // paths of several solvers would hide one another
        }
    }
    plot_circle(&panel, 1.0, WALL);
    plot_leave(&panel);
}

// the force axis ends at this share of the largest force: a contact begins and ends at zero
static const double FORCE_DEPTH = 1e-5;

static double force_of(const RunReport *report, const Trajectory *run, size_t sample, size_t joint)
{
    (void)report;
    return trajectory_state(run, sample, joint)->force;
}

static const PlotQuantity FORCE = {"force", true, RANGES_FORCE, force_of};

// Whether the run has forces of this joint at all: none act in a drive that is prescribed.
static bool knows_force(const RunReport *report, const Trajectory *run, size_t joint)
{
    const size_t count = run->is_complete ? plot_look_stretch_count(run, FORCE) : 0;
    for (size_t i = 0; i < count; i++) {
        if (plot_look_stretch(report, run, FORCE, i, joint).range.most > 0.0) {
            return true;
        }
    }
    return false;
}

// Widens the range of the forces that are drawn by those of one joint in one run.
static void widen_force_range(const RunReport *report, const Trajectory *run, size_t joint,
                              Range *forces)
{
    const size_t count = plot_look_stretch_count(run, FORCE);
    for (size_t i = 0; i < count; i++) {
        const Range range = plot_look_stretch(report, run, FORCE, i, joint).range;
        forces->most = fmax(forces->most, range.most);
        forces->least = range.most > 0.0 ? fmin(forces->least, range.most) : forces->least;
        forces->least = range.least > 0.0 ? fmin(forces->least, range.least) : forces->least;
    }
    const JointExtremes *extremes = &run->joints[joint];
    if (extremes->spike_count > 0) {
        forces->most = fmax(forces->most, extremes->spikes[0].force_max);
    }
    const SignalSpikes *spikes = &run->force_spikes[joint];
    for (size_t i = 0; spikes->is_known && i < spikes->kept; i++) {
        forces->most = fmax(forces->most, spikes->spikes[i].value);
    }
}

// The range of the forces that are drawn: from 0, or in whole decades where that is asked for.
static void choose_force_range(const PlotView *view, Axis *axis)
{
    const RunReport *report = view->report;
    const PlotSet *joints = &view->joints;
    Range forces = {INFINITY, 0.0};
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *trajectory = report->runs[run];
        for (size_t joint = 0; joint < trajectory->joint_count; joint++) {
            if (trajectory->is_complete && (joints->is_shown[joint] || joints->is_other[joint])) {
                widen_force_range(report, trajectory, joint, &forces);
            }
        }
    }
    if (!report->has_log_forces) {
        *axis = (Axis){.title = axis->title, .low = 0.0, .high = PLOT_MARK_ROOM * forces.most};
        axis_fit(&axis->low, &axis->high);
        return;
    }
    axis->scale = AXIS_LOG;
    axis->high = forces.most > 0.0 ? pow(10.0, ceil(log10(forces.most))) : 1.0;
    axis->low = fmax(pow(10.0, floor(log10(fmin(forces.least, 0.1 * axis->high)))),
                     FORCE_DEPTH * axis->high);
}

static void draw_spikes(const PlotView *view, const PlotPanel *panel, size_t run, size_t joint)
{
    const RunReport *report = view->report;
    const JointExtremes *extremes = &report->runs[run]->joints[joint];
    const Joint *shape = &report->scenario->linkage.joints[joint];
    const bool is_shown = trajectory_feels_play(report->runs[run], shape);
    for (size_t i = 0; is_shown && i < extremes->spike_count; i++) {
        const Spike *spike = &extremes->spikes[i];
        plot_dot(panel, plot_look_x(view, spike->crank_rad, spike->onset_s), spike->force_max,
                 plot_style(1, plot_look_colour(view, true, joint)));
    }
}

// What the panel of forces has: those of joints whose limits turn them are torques.
static void name_forces(const PlotView *view, PlotPanel *panel)
{
    const Linkage *linkage = &view->report->scenario->linkage;
    bool is_any[2] = {false, false};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const bool is_torque = linkage_is_torsional(&linkage->joints[i]);
        is_any[is_torque ? 1 : 0] |= plot_look_shows(view, true, i);
    }
    const bool has_play = scenario_has_clearance(view->report->scenario);
    if (is_any[0] && is_any[1]) {
        panel->title = "Force or torque; dots: strongest contacts";
        panel->y.title = "force, N, or torque, N m";
    } else if (is_any[1]) {
        panel->title = "Torque in the joint; dots: strongest contacts";
        panel->y.title = "torque, N m";
    } else {
        panel->title = has_play ? "Force in the joint; dots: strongest contacts" : panel->title;
        panel->y.title = "force, N";
    }
}

static bool shows_force(const PlotView *view, size_t run, size_t joint)
{
    return plot_look_shows(view, true, joint) &&
           knows_force(view->report, view->report->runs[run], joint);
}

void plot_joints_forces(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    name_forces(view, &panel);
    choose_force_range(view, &panel.y);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    plot_look_others(view, &panel, FORCE);
    for (size_t i = 0; i < report->run_count; i++) {
        const size_t run = plot_look_run(view, i);
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            if (shows_force(view, run, joint)) {
                plot_look_draw(view, &panel, run, FORCE, joint);
            }
        }
    }
    plot_leave(&panel);
    // dots and marks at the edge are not cut
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            if (shows_force(view, run, joint)) {
                draw_spikes(view, &panel, run, joint);
            }
        }
    }
    const Trajectory *spiky = plot_look_spike_run(view);
    for (size_t joint = 0; spiky != NULL && joint < spiky->joint_count; joint++) {
        if (plot_look_shows(view, true, joint)) {
            const char *unit = joint_units(&report->scenario->linkage.joints[joint])->force;
            plot_look_marks(view, &panel, &spiky->force_spikes[joint], FORCE, joint, unit);
        }
    }
}

static Vec2 pin_at(const RunReport *report, const Trajectory *run, size_t sample,
                   const PlotPath *path)
{
    const Vec2 eccentricity =
        run->space_states == NULL
            ? trajectory_state(run, sample, path->joint)->eccentricity
            : plot_pins_across(report, run, sample, path->joint,
                               trajectory_space_state(run, sample, path->joint)->offset);
    return vec2_scale(path->per_metre, eccentricity);
}

static Vec2 pin_at_mark(const Trajectory *run, const ContactMark *mark, const PlotPath *path)
{
    (void)run;
    return vec2_scale(path->per_metre, mark->eccentricity);
}

// How a pin in the plane moves in its hole, in the units of its path.
static Vec2 pin_rate(const RunReport *report, const Trajectory *run, size_t sample,
                     const PlotPath *path)
{
    const Joint *joint = &report->scenario->linkage.joints[path->joint];
    const Motion *motions = trajectory_motion(run, sample, 0);
    const Vec2 rate = vec2_sub(linkage_point_velocity(motions, joint->body_b, joint->anchor_b),
                               linkage_point_velocity(motions, joint->body_a, joint->anchor_a));
    return vec2_scale(path->per_metre, rate);
}

// Whether the path of a pin is drawn, and then in which unit: um, or where there are several pins
// the joint's radial clearance.
static bool plot_joints_find_path(const PlotView *view, size_t run, size_t joint, bool is_one,
                                  PlotPath *path)
{
    const Joint *shape = &view->report->scenario->linkage.joints[joint];
    if (view->joints.is_left_out[joint] || !joint_has_hole(shape->kind) ||
        !trajectory_feels_play(view->report->runs[run], shape)) {
        return false;
    }
    *path = (PlotPath){.joint = joint,
                       .per_metre = is_one ? UNITS_UM : 1.0 / linkage_radial_clearance(shape),
                       .at = pin_at,
                       .at_mark = view->report->scenario->linkage.is_spatial ? NULL : pin_at_mark,
                       .rate = view->report->scenario->linkage.is_spatial ? NULL : pin_rate};
    return true;
}

static void take_farthest(void *context, Vec2 place)
{
    double *most = context;
    *most = fmax(*most, fmax(fabs(place.x), fabs(place.y)));
}

// How far from the hole's centre a pin comes in x or y, in the units of their paths.
static double plot_joints_farthest(const PlotView *view, bool is_one)
{
    const RunReport *report = view->report;
    double most = 0.0;
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *trajectory = report->runs[run];
        for (size_t joint = 0; joint < trajectory->joint_count; joint++) {
            PlotPath path;
            if (plot_joints_find_path(view, run, joint, is_one, &path)) {
                plot_look_places(report, trajectory, &path, take_farthest, &most);
            }
        }
    }
    return most;
}

// The directions of a panel are the world's where every axis is z.
static void name_directions(const Linkage *linkage, bool is_one, PlotPanel *panel)
{
    if (!space_has_plane(linkage)) {
        panel->x.title = is_one ? "across the hole's axis, um" : "across / radial clearance";
        panel->y.title = is_one ? "at right angles to that, um" : "at right angles to that";
    } else {
        panel->x.title = is_one ? "e_x, um" : "e_x / radial clearance";
        panel->y.title = is_one ? "e_y, um" : "e_y / radial clearance";
    }
}

void plot_joints_paths(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    static const PlotStyle WALL = {"#222222", 1.6, 1.0, "6 4"};
    const Linkage *linkage = &report->scenario->linkage;
    size_t joints_with_play = 0;
    double clearance = 0.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_has_hole(linkage->joints[i].kind)) {
            joints_with_play++;
            clearance = linkage_radial_clearance(&linkage->joints[i]);
        }
    }
    const bool is_one = joints_with_play == 1;
    const double radius = is_one ? clearance * UNITS_UM : 1.0;
    // the same scale in both directions: the circle is one
    const double high = fmax(1.15 * radius, 1.06 * plot_joints_farthest(view, is_one));
    const double wide = high * panel.width / panel.height;
    panel.title = "Pin in its hole; dashed: where they touch";
    panel.x = (Axis){.low = -wide, .high = wide};
    panel.y = (Axis){.low = -high, .high = high};
    name_directions(linkage, is_one, &panel);
    plot_enter(&panel);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < linkage->joint_count; joint++) {
            PlotPath path;
            if (plot_joints_find_path(view, run, joint, is_one, &path)) {
                plot_look_path(view, &panel, run, &path);
            }
        }
    }
    plot_circle(&panel, radius, WALL);
    plot_leave(&panel);
}

// Coordinates between their flanks or stops.
//
// Of a backlash the coordinate is shown from the middle of the gap, of stops as it is: by
// themselves, for a gap is a small part of the way between stops. Over a torque that changes and
// drives it, it is the loop that a test of a servo or a gear shows.

static const PlotStyle LIMIT = {"#222222", 1.4, 1.0, "6 4"};

static const Joint *plot_limits_joint_of(const RunReport *report, size_t joint)
{
    return &report->scenario->linkage.joints[joint];
}

// What the coordinate is shown from.
static double origin_of(const Joint *joint)
{
    return joint->limits.kind == LIMIT_BACKLASH ? joint->limits.middle : 0.0;
}

static double plot_joints_angle_of(const RunReport *report, const Trajectory *run, size_t sample,
                                   size_t joint)
{
    const double angle = trajectory_state(run, sample, joint)->tilt;
    return (angle - origin_of(plot_limits_joint_of(report, joint))) * UNITS_DEG;
}

static double plot_joints_length_of(const RunReport *report, const Trajectory *run, size_t sample,
                                    size_t joint)
{
    const double length = trajectory_state(run, sample, joint)->eccentricity.x;
    const Joint *of = plot_limits_joint_of(report, joint);
    // that of gears is from the middle already
    return (length - (joint_has_teeth(of->kind) ? 0.0 : origin_of(of))) * UNITS_MM;
}

// A panel of all coordinates with backlash or with stops that are angles, or that are lengths.
typedef struct LimitPanel {
    const char *title;
    const char *axis;
    bool is_angle;
    LimitKind kind;
    double unit;
    PlotQuantity quantity;
} LimitPanel;

static bool plot_limits_shows(const LimitPanel *limits, const PlotView *view, size_t run,
                              size_t joint)
{
    const Joint *of = plot_limits_joint_of(view->report, joint);
    return of->limits.kind == limits->kind && linkage_is_torsional(of) == limits->is_angle &&
           !view->joints.is_left_out[joint] && trajectory_feels_play(view->report->runs[run], of);
}

// One that a joint does not have is infinite.
static double limit_of(const LimitPanel *limits, const Joint *joint, int side)
{
    const double limit = side == 0 ? coordinate_low(joint) : coordinate_high(joint);
    return (limit - origin_of(joint)) * limits->unit;
}

static void plot_joints_take(Axis *axis, double value)
{
    axis->low = isfinite(value) ? fmin(axis->low, value) : axis->low;
    axis->high = isfinite(value) ? fmax(axis->high, value) : axis->high;
}

static void plot_limits_widen(const LimitPanel *limits, const PlotView *view, Axis *axis)
{
    const RunReport *report = view->report;
    axis->low = INFINITY;
    axis->high = -INFINITY;
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *trajectory = report->runs[run];
        for (size_t joint = 0; joint < trajectory->joint_count; joint++) {
            if (!plot_limits_shows(limits, view, run, joint)) {
                continue;
            }
            plot_joints_take(axis, limit_of(limits, plot_limits_joint_of(report, joint), 0));
            plot_joints_take(axis, limit_of(limits, plot_limits_joint_of(report, joint), 1));
            for (size_t i = 0; i < trajectory->sample_count; i++) {
                plot_joints_take(axis, limits->quantity.at(report, trajectory, i, joint));
            }
        }
    }
    if (!(axis->low < axis->high)) {
        axis->low = -1.0;
        axis->high = 1.0;
    }
    const double margin = 0.05 * (axis->high - axis->low);
    axis->low -= margin;
    axis->high += margin;
    axis_round(&axis->low, &axis->high);
}

static void plot_limits_draw_limits(const LimitPanel *limits, const PlotView *view,
                                    const PlotPanel *panel, size_t joint)
{
    for (int side = 0; side < 2; side++) {
        const double limit = limit_of(limits, plot_limits_joint_of(view->report, joint), side);
        if (isfinite(limit)) {
            plot_line(panel, 2, (const double[]){panel->x.low, panel->x.high},
                      (const double[]){limit, limit}, LIMIT);
        }
    }
}

static void plot_limits_draw(const LimitPanel *limits, const PlotView *view, PlotPanel panel)
{
    panel.title = limits->title;
    panel.y.title = limits->axis;
    plot_limits_widen(limits, view, &panel.y);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    for (size_t run = 0; run < view->report->run_count; run++) {
        for (size_t joint = 0; joint < view->report->scenario->linkage.joint_count; joint++) {
            if (plot_limits_shows(limits, view, run, joint)) {
                plot_limits_draw_limits(limits, view, &panel, joint);
                plot_look_draw(view, &panel, run, limits->quantity, joint);
            }
        }
    }
    plot_leave(&panel);
}

static LimitPanel panel_of(bool is_angle, LimitKind kind)
{
    static const char *const TITLES[2][2] = {
        {"Travel of the slider; dashed: stops", "Angle of the joint; dashed: stops"},
        {"Teeth or slider in the backlash; dashed: flanks",
         "Angle of the joint in its backlash; dashed: flanks"}};
    return (LimitPanel){
        .title = TITLES[kind == LIMIT_BACKLASH ? 1 : 0][is_angle ? 1 : 0],
        .axis = is_angle ? "angle, deg" : "travel, mm",
        .is_angle = is_angle,
        .kind = kind,
        .unit = is_angle ? UNITS_DEG : UNITS_MM,
        .quantity = {is_angle ? "angle, deg" : "travel, mm", true, -1,
                     is_angle ? plot_joints_angle_of : plot_joints_length_of},
    };
}

void plot_limits_angles(const PlotView *view, PlotPanel panel)
{
    const LimitPanel limits = panel_of(true, LIMIT_STOPS);
    plot_limits_draw(&limits, view, panel);
}

void plot_limits_lengths(const PlotView *view, PlotPanel panel)
{
    const LimitPanel limits = panel_of(false, LIMIT_STOPS);
    plot_limits_draw(&limits, view, panel);
}

void plot_limits_angle_gaps(const PlotView *view, PlotPanel panel)
{
    const LimitPanel limits = panel_of(true, LIMIT_BACKLASH);
    plot_limits_draw(&limits, view, panel);
}

void plot_limits_length_gaps(const PlotView *view, PlotPanel panel)
{
    const LimitPanel limits = panel_of(false, LIMIT_BACKLASH);
    plot_limits_draw(&limits, view, panel);
}

// The coordinate over what drives it at the same time.
static Vec2 loop_at(const RunReport *report, const Trajectory *run, size_t sample,
                    const PlotPath *path)
{
    const Torque *torque = &report->scenario->linkage.torque;
    const bool is_angle = linkage_is_torsional(plot_limits_joint_of(report, path->joint));
    return (Vec2){
        time_table_at(&torque->table, run->times[sample]),
        (is_angle ? plot_joints_angle_of : plot_joints_length_of)(report, run, sample, path->joint),
    };
}

static Axis torque_axis(const RunReport *report, bool is_angle)
{
    const TimeTable *table = &report->scenario->linkage.torque.table;
    Axis axis = {.title = is_angle ? "torque of the drive, N m" : "force of the drive, N",
                 .low = INFINITY,
                 .high = -INFINITY};
    for (size_t i = 0; i < table->count; i++) {
        plot_joints_take(&axis, table->values[i] - table->wave.amplitude);
        plot_joints_take(&axis, table->values[i] + table->wave.amplitude);
    }
    axis_round(&axis.low, &axis.high);
    return axis;
}

void plot_limits_loop(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    const size_t joint = (size_t)report->scenario->linkage.torque.joint;
    const bool is_angle = linkage_is_torsional(plot_limits_joint_of(report, joint));
    const LimitPanel limits = panel_of(is_angle, plot_limits_joint_of(report, joint)->limits.kind);
    const PlotPath path = {.joint = joint, .at = loop_at, .is_straight = true};
    panel.title = is_angle ? "Angle over torque; dashed: flanks and stops"
                           : "Travel over force; dashed: flanks and stops";
    panel.x = torque_axis(report, is_angle);
    panel.y.title = is_angle ? "angle, deg" : "travel, mm";
    plot_limits_widen(&limits, view, &panel.y);
    plot_enter(&panel);
    for (size_t run = 0; run < report->run_count; run++) {
        if (plot_limits_shows(&limits, view, run, joint)) {
            plot_limits_draw_limits(&limits, view, &panel, joint);
            plot_look_path(view, &panel, run, &path);
        }
    }
    plot_leave(&panel);
}

bool plot_limits_has_loop(const Linkage *linkage)
{
    const TimeTable *table = &linkage->torque.table;
    bool is_changing = time_table_changes(table) && table->count == 1;
    for (size_t i = 1; i < table->count; i++) {
        is_changing = is_changing || table->values[i] != table->values[0];
    }
    return is_changing && linkage->joints[linkage->torque.joint].limits.kind != LIMIT_NONE;
}

bool plot_limits_any(const Linkage *linkage, bool is_angle, LimitKind kind)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint->limits.kind == kind && linkage_is_torsional(joint) == is_angle) {
            return true;
        }
    }
    return false;
}

// Blocks between their guides, and sliders along their lines.
//
// A block of length l between guides with play c to either side, its middle y off the middle line
// and tilted by t, touches with a corner where
//     |y| + (l/2) |sin t| - (h/2) (1 - cos t) = c        h the height of the block
// which in y / c and t / limit is all but the square |y / c| + |t / limit| = 1 on its tip: its
// corners are both corners of one side (y = +-c), or two opposite ones (t = +-limit).

static const PlotStyle GUIDE_EDGE = {"#222222", 1.4, 1.0, "6 4"};

static const Joint *plot_slides_joint_of(const RunReport *report, size_t joint)
{
    return &report->scenario->linkage.joints[joint];
}

// Whether a run shows the play of a joint that is of some kinds.
static bool plot_slides_shows(const PlotView *view, size_t run, size_t joint, JointKinds kinds)
{
    const Joint *of = plot_slides_joint_of(view->report, joint);
    return joint_is_among(of->kind, kinds) && !view->joints.is_left_out[joint] &&
           trajectory_feels_play(view->report->runs[run], of);
}

static bool shows_acceleration(const PlotView *view, size_t run, size_t joint)
{
    return view->report->runs[run]->is_complete && !view->joints.is_left_out[joint] &&
           slide_range_has(plot_slides_joint_of(view->report, joint));
}

static double offset_of(const RunReport *report, const Trajectory *run, size_t sample, size_t joint)
{
    (void)report;
    return trajectory_state(run, sample, joint)->eccentricity.y * UNITS_UM;
}

static double plot_slides_tilt_of(const RunReport *report, const Trajectory *run, size_t sample,
                                  size_t joint)
{
    (void)report;
    return trajectory_state(run, sample, joint)->tilt * UNITS_MRAD;
}

static double gap_of(const RunReport *report, const Trajectory *run, size_t sample, size_t joint)
{
    (void)report;
    return trajectory_state(run, sample, joint)->gap * UNITS_MM;
}

static double plot_joints_acceleration_of(const RunReport *report, const Trajectory *run,
                                          size_t sample, size_t joint)
{
    return slide_range_acceleration(&report->scenario->linkage, run, sample, joint);
}

// Where a slider is along its line, mm, and how fast it goes, m/s.
static double plot_slides_position_of(const RunReport *report, const Trajectory *run, size_t sample,
                                      size_t joint)
{
    const Linkage *linkage = &report->scenario->linkage;
    return forces_coordinate(linkage, (int)joint, trajectory_motion(run, sample, 0)).angle *
           UNITS_MM;
}

static double plot_slides_speed_of(const RunReport *report, const Trajectory *run, size_t sample,
                                   size_t joint)
{
    const Linkage *linkage = &report->scenario->linkage;
    return forces_coordinate(linkage, (int)joint, trajectory_motion(run, sample, 0)).rate;
}

static double offset_limit(const Joint *joint)
{
    return linkage_radial_clearance(joint) * UNITS_UM;
}

static double plot_slides_tilt_limit(const Joint *joint)
{
    return linkage_guide_tilt(&joint->guide) * UNITS_MRAD;
}

// A quantity of every joint that a panel shows, with lines at the limits of each.
typedef struct SlidePanel {
    const char *title;
    const char *axis;
    PlotQuantity quantity;
    JointKinds kinds;
    double (*limit)(const Joint *joint);                           // NULL: none
    bool (*shows)(const PlotView *view, size_t run, size_t joint); // NULL: those of the kinds
} SlidePanel;

static const SlidePanel SLIDE_PANELS[] = {
    [PLOT_SLIDE_OFFSET] = {.title = "Block across its guides; dashed: not tilted",
                           .axis = "off the middle line, um",
                           .quantity = {"offset, um", true, -1, offset_of},
                           .kinds = JOINTS_WITH_GUIDES,
                           .limit = offset_limit},
    [PLOT_SLIDE_TILT] = {.title = "Tilt of the block; dashed: opposite corners touch",
                         .axis = "tilt, mrad",
                         .quantity = {"tilt, mrad", true, -1, plot_slides_tilt_of},
                         .kinds = JOINTS_WITH_GUIDES,
                         .limit = plot_slides_tilt_limit},
    [PLOT_SLIDE_POSITION] = {.title = "Position of the slider on its line",
                             .axis = "position, mm",
                             .quantity = {"position, mm", true, -1, plot_slides_position_of},
                             .shows = shows_acceleration},
    [PLOT_SLIDE_SPEED] = {.title = "Velocity of the slider along its line",
                          .axis = "velocity, m/s",
                          .quantity = {"velocity", true, -1, plot_slides_speed_of},
                          .shows = shows_acceleration},
    [PLOT_SLIDE_ACCELERATION] = {.title = "Acceleration of the slider, at the samples",
                                 .axis = "acceleration, m/s^2",
                                 .quantity = {"acceleration", true, -1,
                                              plot_joints_acceleration_of},
                                 .shows = shows_acceleration},
    [PLOT_SLIDE_STOP] = {.title = "Distance from the stop",
                         .axis = "gap, mm",
                         .quantity = {"gap, mm", true, -1, gap_of},
                         .kinds = JOINTS_WITH_DISC},
};

static bool panel_shows(const SlidePanel *slide, const PlotView *view, size_t run, size_t joint)
{
    return slide->shows != NULL ? slide->shows(view, run, joint)
                                : plot_slides_shows(view, run, joint, slide->kinds);
}

static void plot_slides_widen(const SlidePanel *slide, const PlotView *view, PlotPanel *panel)
{
    const RunReport *report = view->report;
    panel->y.low = INFINITY;
    panel->y.high = -INFINITY;
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *trajectory = report->runs[run];
        for (size_t joint = 0; joint < trajectory->joint_count; joint++) {
            const bool is_shown = panel_shows(slide, view, run, joint);
            if (is_shown && slide->limit != NULL) {
                const double limit = slide->limit(plot_slides_joint_of(report, joint));
                panel->y.high = fmax(panel->y.high, 1.08 * limit);
                panel->y.low = fmin(panel->y.low, -1.08 * limit);
            }
            for (size_t i = 0; is_shown && i < trajectory->sample_count; i++) {
                const double value = slide->quantity.at(report, trajectory, i, joint);
                panel->y.high = fmax(panel->y.high, value);
                panel->y.low = fmin(panel->y.low, value);
            }
        }
    }
    axis_fit(&panel->y.low, &panel->y.high);
}

static void plot_slides_draw_limits(const SlidePanel *slide, const PlotView *view,
                                    const PlotPanel *panel)
{
    const RunReport *report = view->report;
    for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
        for (int side = -1;
             slide->limit != NULL && !view->joints.is_left_out[joint] &&
             joint_is_among(plot_slides_joint_of(report, joint)->kind, slide->kinds) && side <= 1;
             side += 2) {
            const double limit = side * slide->limit(plot_slides_joint_of(report, joint));
            plot_line(panel, 2, (const double[]){panel->x.low, panel->x.high},
                      (const double[]){limit, limit}, GUIDE_EDGE);
        }
    }
}

void plot_slides_draw(const PlotView *view, PlotPanel panel, PlotSlide which)
{
    const RunReport *report = view->report;
    const SlidePanel *slide = &SLIDE_PANELS[which];
    panel.title = slide->title;
    panel.y.title = slide->axis;
    plot_slides_widen(slide, view, &panel);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    plot_slides_draw_limits(slide, view, &panel);
    for (size_t i = 0; i < report->run_count; i++) {
        const size_t run = plot_look_run(view, i);
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            if (panel_shows(slide, view, run, joint)) {
                plot_look_draw(view, &panel, run, slide->quantity, joint);
            }
        }
    }
    plot_leave(&panel);
}

// The path of one block: its offset over the play, its tilt over the tilt at which it jams.
static Vec2 block_at(const RunReport *report, const Trajectory *run, size_t sample,
                     const PlotPath *path)
{
    const Joint *joint = plot_slides_joint_of(report, path->joint);
    return (Vec2){offset_of(report, run, sample, path->joint) / offset_limit(joint),
                  plot_slides_tilt_of(report, run, sample, path->joint) /
                      plot_slides_tilt_limit(joint)};
}

// How far any block goes in either direction, of its limits.
static double plot_slides_farthest(const PlotView *view)
{
    const RunReport *report = view->report;
    double most = 1.15;
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *trajectory = report->runs[run];
        for (size_t joint = 0; joint < trajectory->joint_count; joint++) {
            const Joint *of = plot_slides_joint_of(report, joint);
            for (size_t i = 0; plot_slides_shows(view, run, joint, JOINTS_WITH_GUIDES) &&
                               i < trajectory->sample_count;
                 i++) {
                const double offset = fabs(offset_of(report, trajectory, i, joint));
                const double tilt = fabs(plot_slides_tilt_of(report, trajectory, i, joint));
                most = fmax(most, 1.06 * offset / offset_limit(of));
                most = fmax(most, 1.06 * tilt / plot_slides_tilt_limit(of));
            }
        }
    }
    return most;
}

void plot_slides_paths(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    const double high = plot_slides_farthest(view);
    panel.title = "Block between its guides; dashed: corners touch";
    panel.x = (Axis){.title = "offset / play to either side", .low = -high, .high = high};
    panel.y = (Axis){.title = "tilt / largest tilt", .low = -high, .high = high};
    plot_enter(&panel);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            if (plot_slides_shows(view, run, joint, JOINTS_WITH_GUIDES)) {
                plot_look_path(view, &panel, run, &(PlotPath){.joint = joint, .at = block_at});
            }
        }
    }
    plot_line(&panel, 5, (const double[]){1.0, 0.0, -1.0, 0.0, 1.0},
              (const double[]){0.0, 1.0, 0.0, -1.0, 0.0}, GUIDE_EDGE);
    plot_leave(&panel);
}
