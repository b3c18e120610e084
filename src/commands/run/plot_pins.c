// How did the pins tilt in their holes, and where were they at the holes' ends?
#include "commands/run/plot_look.h"
#include "write/units.h"

#include <math.h>

static double tilt_of(const RunReport *report, const Trajectory *run, size_t sample, size_t joint)
{
    (void)report;
    return trajectory_space_state(run, sample, joint)->tilt * UNITS_MRAD;
}

static const PlotQuantity TILT = {"tilt, mrad", true, -1, tilt_of};

static bool shows(const PlotView *view, size_t run, size_t joint)
{
    return !view->joints.is_left_out[joint] &&
           trajectory_feels_play(view->report->runs[run],
                                 &view->report->scenario->linkage.joints[joint]);
}

// The tilt at which a pin touches at both ends, mrad.
static double tilt_limit(const Joint *joint)
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
            linkage->joints[joint].kind == JOINT_CLEARANCE && !view->joints.is_left_out[joint];
        const double limit = has_play ? tilt_limit(&linkage->joints[joint]) : 0.0;
        panel.y.high = fmax(panel.y.high, 1.08 * limit);
        for (size_t run = 0; run < report->run_count; run++) {
            for (size_t i = 0; shows(view, run, joint) && i < report->runs[run]->sample_count;
                 i++) {
                panel.y.high =
                    fmax(panel.y.high, 1.05 * tilt_of(report, report->runs[run], i, joint));
            }
        }
    }
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        if (linkage->joints[joint].kind == JOINT_CLEARANCE && !view->joints.is_left_out[joint]) {
            const double limit = tilt_limit(&linkage->joints[joint]);
            const PlotStyle style = {"#222222", 1.2, 1.0, "6 4"};
            plot_line(&panel, 2, (const double[]){panel.x.low, panel.x.high},
                      (const double[]){limit, limit}, style);
        }
        for (size_t run = 0; run < report->run_count; run++) {
            if (shows(view, run, joint)) {
                plot_look_draw(view, &panel, run, TILT, joint);
            }
        }
    }
    plot_leave(&panel);
}

// Where the pin's axis is at an end of the hole, as a share of the play, in two directions across
// the hole's axis: x and y where that is z.
static Vec2 end_at(const RunReport *report, const Trajectory *run, size_t sample,
                   const PlotPath *path)
{
    const Linkage *linkage = &report->scenario->linkage;
    const SpaceEnd hole = space_end(linkage, path->joint, 0);
    const SpaceMotion *motions = trajectory_space_motion(run, sample, 0);
    const Vec3 axis = space_direction(motions, hole.body, hole.axis);
    const Vec3 first = vec3_normal_to(axis);
    const Vec3 offset = trajectory_space_state(run, sample, path->joint)->ends[path->end];
    const double scale = 1.0 / linkage_radial_clearance(&linkage->joints[path->joint]);
    return (Vec2){scale * vec3_dot(first, offset),
                  scale * vec3_dot(vec3_cross(axis, first), offset)};
}

// How far the axis of any pin comes from the middle of an end of its hole, of its play.
static double farthest(const PlotView *view)
{
    const RunReport *report = view->report;
    double most = 0.0;
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            for (size_t i = 0; shows(view, run, joint) && i < report->runs[run]->sample_count;
                 i++) {
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
    const double high = fmax(1.15, 1.06 * farthest(view));
    const double wide = high * panel.width / panel.height;
    panel.title = "Pin's axis at the hole's ends; broken: front";
    panel.x = (Axis){.title = "across, of the radial clearance", .low = -wide, .high = wide};
    panel.y = (Axis){.title = "of the radial clearance", .low = -high, .high = high};
    plot_enter(&panel);
    for (size_t run = report->run_count; run-- > 0;) {
        bool is_drawn = false;
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            for (int end = 0; shows(view, run, joint) && end < 2; end++) {
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
