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
           view->report->scenario->linkage.joints[joint].kind == JOINT_CLEARANCE &&
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
