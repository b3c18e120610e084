// What did the joints feel, and where was the pin in its hole?
#include "commands/run/plot_look.h"

#include "write/joint_units.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// the force axis ends at this share of the largest force: a contact begins and ends at zero
static const double FORCE_DEPTH = 1e-5;
// errors below this share of the largest omega are rounding
static const double ERROR_FLOOR = 1e-12;
static const double ERROR_DECADES = 1e4;

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
}

// The range of the forces that are drawn, in whole decades.
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

void plot_joints_forces(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    panel.y = (Axis){.scale = AXIS_LOG};
    name_forces(view, &panel);
    choose_force_range(view, &panel.y);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    plot_look_others(view, &panel, FORCE);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            if (plot_look_shows(view, true, joint) &&
                knows_force(report, report->runs[run], joint)) {
                plot_look_draw(view, &panel, run, FORCE, joint);
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
    plot_leave(&panel);
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

// Whether the path of a pin is drawn, and then in which unit: um, or where there are several pins
// the joint's radial clearance.
static bool find_path(const PlotView *view, size_t run, size_t joint, bool is_one, PlotPath *path)
{
    const Joint *shape = &view->report->scenario->linkage.joints[joint];
    if (view->joints.is_left_out[joint] || shape->kind != JOINT_CLEARANCE ||
        !trajectory_feels_play(view->report->runs[run], shape)) {
        return false;
    }
    *path = (PlotPath){.joint = joint,
                       .per_metre = is_one ? UNITS_UM : 1.0 / linkage_radial_clearance(shape),
                       .at = pin_at};
    return true;
}

// How far from the hole's centre a pin comes in x or y, in the units of their paths.
static double farthest(const PlotView *view, bool is_one)
{
    const RunReport *report = view->report;
    double most = 0.0;
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *trajectory = report->runs[run];
        for (size_t joint = 0; joint < trajectory->joint_count; joint++) {
            PlotPath path;
            const bool is_drawn = find_path(view, run, joint, is_one, &path);
            for (size_t i = 0; is_drawn && i < trajectory->sample_count; i++) {
                const Vec2 e = pin_at(report, trajectory, i, &path);
                most = fmax(most, fmax(fabs(e.x), fabs(e.y)));
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
        if (linkage->joints[i].kind == JOINT_CLEARANCE) {
            joints_with_play++;
            clearance = linkage_radial_clearance(&linkage->joints[i]);
        }
    }
    const bool is_one = joints_with_play == 1;
    const double radius = is_one ? clearance * UNITS_UM : 1.0;
    // the same scale in both directions: the circle is one
    const double high = fmax(1.15 * radius, 1.06 * farthest(view, is_one));
    const double wide = high * panel.width / panel.height;
    panel.title = "Pin in its hole; dashed: where they touch";
    panel.x = (Axis){.low = -wide, .high = wide};
    panel.y = (Axis){.low = -high, .high = high};
    name_directions(linkage, is_one, &panel);
    plot_enter(&panel);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < linkage->joint_count; joint++) {
            PlotPath path;
            if (find_path(view, run, joint, is_one, &path)) {
                plot_look_path(view, &panel, run, &path);
            }
        }
    }
    plot_circle(&panel, radius, WALL);
    plot_leave(&panel);
}

// The run that the others are held against, or NULL.
static const Trajectory *find_truth(const RunReport *report)
{
    for (size_t i = 0; i < report->run_count; i++) {
        for (size_t k = 0; report->errors[i].is_known && k < report->run_count; k++) {
            if (strcmp(report->runs[k]->backend, report->errors[i].against) == 0) {
                return report->runs[k];
            }
        }
    }
    return NULL;
}

static double omega_error(const RunReport *report, const Trajectory *run, size_t sample,
                          size_t body)
{
    const Trajectory *truth = find_truth(report);
    if (run->space_motions != NULL && truth->space_motions != NULL) {
        return vec3_length(vec3_sub(trajectory_space_motion(run, sample, body)->omega,
                                    trajectory_space_motion(truth, sample, body)->omega));
    }
    return fabs(trajectory_motion(run, sample, body)->omega -
                trajectory_motion(truth, sample, body)->omega);
}

// The largest difference as a range of four decades, none of them below rounding.
static void choose_error_range(const RunReport *report, const Trajectory *truth, Axis *axis)
{
    double high = 0.0;
    double scale = 0.0;
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t body = 0; report->errors[run].is_known && body < truth->body_count; body++) {
            scale = fmax(scale, trajectory_omega_scale(truth, body));
            for (size_t i = 0; i < truth->sample_count; i++) {
                high = fmax(high, omega_error(report, report->runs[run], i, body));
            }
        }
    }
    const double rounding = fmax(ERROR_FLOOR * scale, ERROR_FLOOR);
    axis->high = pow(10.0, ceil(log10(fmax(high, rounding))));
    axis->low = fmax(axis->high / ERROR_DECADES, 1e-3 * pow(10.0, floor(log10(rounding))));
}

void plot_joints_errors(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    static const PlotQuantity ERROR = {"difference of omega", false, -1, omega_error};
    const Trajectory *truth = find_truth(report);
    char title[128];
    snprintf(title, sizeof title, "%s%s",
             truth == NULL ? "No run to compare with" : "Difference from ",
             truth == NULL ? "" : truth->backend);
    panel.title = title;
    panel.y = (Axis){
        .title = "|difference of omega|, rad/s", .scale = AXIS_LOG, .low = 1e-6, .high = 1.0};
    if (truth != NULL) {
        choose_error_range(report, truth, &panel.y);
    }
    plot_enter(&panel);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t body = 0; report->errors[run].is_known && body < truth->body_count; body++) {
            if (plot_look_shows(view, false, body)) {
                plot_look_draw(view, &panel, run, ERROR, body);
            }
        }
    }
    plot_leave(&panel);
}
