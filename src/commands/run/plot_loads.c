// Draws what drives a mechanism, and how pins bear on their holes.
#include "commands/run/plot_lines.h"
#include "run/drive_torque.h"

#include <math.h>

static double plot_loads_torque_of(const RunReport *report, const Trajectory *run, size_t sample,
                                   size_t joint)
{
    const int drive = linkage_drive_of_joint(&report->scenario->linkage, joint);
    return drive_torque_at(report->scenario, run, drive < 0 ? 0 : (size_t)drive, sample);
}

bool plot_loads_has_torque(const Linkage *linkage)
{
    return drive_torque_exists(linkage);
}

// The joints in whose colours torques are drawn. Returns how many.
static size_t driven_joints(const Linkage *linkage, size_t joints[LINKAGE_DRIVE_MAX])
{
    const size_t count = linkage_drive_count(linkage);
    joints[0] = (size_t)linkage->torque.joint;
    for (size_t i = 0; i < count; i++) {
        joints[i] = (size_t)linkage_drive(linkage, i)->joint;
    }
    return count > 1 ? count : 1;
}

// Widens the axis to the torques of a joint in a run.
static void show_torques(const RunReport *report, const Trajectory *of, size_t joint, Axis *axis)
{
    for (size_t i = 0; of->is_complete && i < of->sample_count; i++) {
        const double torque = plot_loads_torque_of(report, of, i, joint);
        axis->low = fmin(axis->low, torque);
        axis->high = fmax(axis->high, torque);
    }
}

void plot_loads_torque(const PlotView *view, PlotPanel panel)
{
    static const PlotQuantity TORQUE = {"torque", true, -1, plot_loads_torque_of};
    const RunReport *report = view->report;
    size_t joints[LINKAGE_DRIVE_MAX];
    const size_t count = driven_joints(&report->scenario->linkage, joints);
    panel.title = count > 1 ? "Torques of the drives" : "Torque of the drive";
    panel.y.title = "torque, N m";
    for (size_t n = 0; n < count * report->run_count; n++) {
        show_torques(report, report->runs[n / count], joints[n % count], &panel.y);
    }
    axis_round(&panel.y.low, &panel.y.high);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    for (size_t n = 0; n < count * report->run_count; n++) {
        if (report->runs[n / count]->is_complete) {
            plot_look_draw(view, &panel, n / count, TORQUE, joints[n % count]);
        }
    }
    plot_leave(&panel);
}

// The force on a pin in the frame of the body that has its hole, N.
static Vec2 pin_load_at(const RunReport *report, const Trajectory *run, size_t sample,
                        const PlotPath *path)
{
    const Joint *joint = &report->scenario->linkage.joints[path->joint];
    const Motion *motions = trajectory_motion(run, sample, 0);
    const double turned = joint->body_a == LINKAGE_GROUND ? 0.0 : motions[joint->body_a].angle;
    return vec2_rotate(-turned, trajectory_state(run, sample, path->joint)->force_on_b);
}

// Whether the loads of a pin are drawn: in a run that feels its play, and in the ideal one.
static bool shows_load(const PlotView *view, size_t run, size_t joint)
{
    return view->report->runs[run]->is_complete && !view->joints.is_left_out[joint] &&
           view->report->scenario->linkage.joints[joint].kind == JOINT_CLEARANCE;
}

void plot_loads_pins(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    const size_t joints = report->scenario->linkage.joint_count;
    double most = 0.0;
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *of = report->runs[run];
        for (size_t joint = 0; joint < joints; joint++) {
            for (size_t i = 0; shows_load(view, run, joint) && i < of->sample_count; i++) {
                const PlotPath path = {.joint = joint};
                most = fmax(most, vec2_length(pin_load_at(report, of, i, &path)));
            }
        }
    }
    const double high = most > 0.0 ? 1.06 * most : 1.0;
    const double wide = high * panel.width / panel.height;
    panel.title = "Force on the pin, seen from its hole";
    panel.x = (Axis){.title = "along the hole body's x, N", .low = -wide, .high = wide};
    panel.y = (Axis){.title = "along its y, N", .low = -high, .high = high};
    plot_enter(&panel);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < joints; joint++) {
            if (shows_load(view, run, joint)) {
                plot_look_path(view, &panel, run, &(PlotPath){.joint = joint, .at = pin_load_at});
            }
        }
    }
    plot_leave(&panel);
}
