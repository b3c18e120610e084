// Where were the blocks between their guides, how did the sliders accelerate, and how far from
// their stops were the bodies?
//
// A block of length l between guides with play c to either side, its middle y off the middle line
// and tilted by t, touches with a corner where
//     |y| + (l/2) |sin t| - (h/2) (1 - cos t) = c        h the height of the block
// which in y / c and t / limit is all but the square |y / c| + |t / limit| = 1 on its tip: its
// corners are both corners of one side (y = +-c), or two opposite ones (t = +-limit).
#include "commands/run/plot_look.h"
#include "commands/run/slide_range.h"
#include "write/units.h"

#include <math.h>
#include <stdlib.h>

static const PlotStyle WALL = {"#222222", 1.4, 1.0, "6 4"};

static const Joint *joint_of(const RunReport *report, size_t joint)
{
    return &report->scenario->linkage.joints[joint];
}

// Whether a run shows the play of a joint of that kind.
static bool shows(const PlotView *view, size_t run, size_t joint, JointKind kind)
{
    const Joint *of = joint_of(view->report, joint);
    return of->kind == kind && !view->joints.is_left_out[joint] &&
           trajectory_feels_play(view->report->runs[run], of);
}

static bool shows_acceleration(const PlotView *view, size_t run, size_t joint)
{
    return view->report->runs[run]->is_complete && !view->joints.is_left_out[joint] &&
           slide_range_has(joint_of(view->report, joint));
}

static double offset_of(const RunReport *report, const Trajectory *run, size_t sample, size_t joint)
{
    (void)report;
    return trajectory_state(run, sample, joint)->eccentricity.y * UNITS_UM;
}

static double tilt_of(const RunReport *report, const Trajectory *run, size_t sample, size_t joint)
{
    (void)report;
    return trajectory_state(run, sample, joint)->tilt * UNITS_MRAD;
}

static double gap_of(const RunReport *report, const Trajectory *run, size_t sample, size_t joint)
{
    (void)report;
    return trajectory_state(run, sample, joint)->gap * UNITS_MM;
}

static double acceleration_of(const RunReport *report, const Trajectory *run, size_t sample,
                              size_t joint)
{
    return slide_range_acceleration(&report->scenario->linkage, run, sample, joint);
}

// A quantity of every joint that a panel shows, with lines at the limits of each.
typedef struct SlidePanel {
    const char *title;
    const char *axis;
    PlotQuantity quantity;
    JointKind kind;
    double (*limit)(const Joint *joint);                           // NULL: none
    bool (*shows)(const PlotView *view, size_t run, size_t joint); // NULL: those of the kind
} SlidePanel;

static bool panel_shows(const SlidePanel *slide, const PlotView *view, size_t run, size_t joint)
{
    return slide->shows != NULL ? slide->shows(view, run, joint)
                                : shows(view, run, joint, slide->kind);
}

static void widen(const SlidePanel *slide, const PlotView *view, PlotPanel *panel)
{
    const RunReport *report = view->report;
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *trajectory = report->runs[run];
        for (size_t joint = 0; joint < trajectory->joint_count; joint++) {
            const bool is_shown = panel_shows(slide, view, run, joint);
            const double limit =
                is_shown && slide->limit != NULL ? slide->limit(joint_of(report, joint)) : 0.0;
            panel->y.high = fmax(panel->y.high, 1.08 * limit);
            panel->y.low = fmin(panel->y.low, -1.08 * limit);
            for (size_t i = 0; is_shown && i < trajectory->sample_count; i++) {
                const double value = slide->quantity.at(report, trajectory, i, joint);
                panel->y.high = fmax(panel->y.high, value);
                panel->y.low = fmin(panel->y.low, value);
            }
        }
    }
    axis_round(&panel->y.low, &panel->y.high);
}

static void draw_limits(const SlidePanel *slide, const PlotView *view, const PlotPanel *panel)
{
    const RunReport *report = view->report;
    for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
        for (int side = -1; slide->limit != NULL && !view->joints.is_left_out[joint] &&
                            joint_of(report, joint)->kind == slide->kind && side <= 1;
             side += 2) {
            const double limit = side * slide->limit(joint_of(report, joint));
            plot_line(panel, 2, (const double[]){panel->x.low, panel->x.high},
                      (const double[]){limit, limit}, WALL);
        }
    }
}

static void draw(const SlidePanel *slide, const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    panel.title = slide->title;
    panel.y.title = slide->axis;
    widen(slide, view, &panel);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    draw_limits(slide, view, &panel);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            if (panel_shows(slide, view, run, joint)) {
                plot_look_draw(view, &panel, run, slide->quantity, joint);
            }
        }
    }
    plot_leave(&panel);
}

static double offset_limit(const Joint *joint)
{
    return linkage_radial_clearance(joint) * UNITS_UM;
}

static double tilt_limit(const Joint *joint)
{
    return linkage_guide_tilt(&joint->guide) * UNITS_MRAD;
}

void plot_slides_offsets(const PlotView *view, PlotPanel panel)
{
    static const SlidePanel OFFSET = {
        .title = "Block across its guides; dashed: not tilted",
        .axis = "off the middle line, um",
        .quantity = {"offset, um", true, -1, offset_of},
        .kind = JOINT_GUIDE,
        .limit = offset_limit,
    };
    draw(&OFFSET, view, panel);
}

void plot_slides_tilts(const PlotView *view, PlotPanel panel)
{
    static const SlidePanel TILT = {
        .title = "Tilt of the block; dashed: opposite corners touch",
        .axis = "tilt, mrad",
        .quantity = {"tilt, mrad", true, -1, tilt_of},
        .kind = JOINT_GUIDE,
        .limit = tilt_limit,
    };
    draw(&TILT, view, panel);
}

void plot_slides_accelerations(const PlotView *view, PlotPanel panel)
{
    static const SlidePanel ACCELERATION = {
        .title = "Acceleration of the slider, at the samples",
        .axis = "acceleration, m/s^2",
        .quantity = {"acceleration", true, -1, acceleration_of},
        .shows = shows_acceleration,
    };
    draw(&ACCELERATION, view, panel);
}

void plot_slides_stops(const PlotView *view, PlotPanel panel)
{
    static const SlidePanel GAP = {
        .title = "Distance from the stop",
        .axis = "gap, mm",
        .quantity = {"gap, mm", true, -1, gap_of},
        .kind = JOINT_STOP,
    };
    draw(&GAP, view, panel);
}

// The path of one block: its offset over the play, its tilt over the tilt at which it jams.
static Vec2 block_at(const RunReport *report, const Trajectory *run, size_t sample,
                     const PlotPath *path)
{
    const Joint *joint = joint_of(report, path->joint);
    return (Vec2){offset_of(report, run, sample, path->joint) / offset_limit(joint),
                  tilt_of(report, run, sample, path->joint) / tilt_limit(joint)};
}

// How far any block goes in either direction, of its limits.
static double farthest(const PlotView *view)
{
    const RunReport *report = view->report;
    double most = 1.15;
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *trajectory = report->runs[run];
        for (size_t joint = 0; joint < trajectory->joint_count; joint++) {
            const Joint *of = joint_of(report, joint);
            for (size_t i = 0; shows(view, run, joint, JOINT_GUIDE) && i < trajectory->sample_count;
                 i++) {
                const double offset = fabs(offset_of(report, trajectory, i, joint));
                const double tilt = fabs(tilt_of(report, trajectory, i, joint));
                most = fmax(most, 1.06 * offset / offset_limit(of));
                most = fmax(most, 1.06 * tilt / tilt_limit(of));
            }
        }
    }
    return most;
}

void plot_slides_paths(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    const double high = farthest(view);
    panel.title = "Block between its guides; dashed: corners touch";
    panel.x = (Axis){.title = "offset / play to either side", .low = -high, .high = high};
    panel.y = (Axis){.title = "tilt / largest tilt", .low = -high, .high = high};
    plot_enter(&panel);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            if (shows(view, run, joint, JOINT_GUIDE)) {
                plot_look_path(view, &panel, run, &(PlotPath){.joint = joint, .at = block_at});
            }
        }
    }
    plot_line(&panel, 5, (const double[]){1.0, 0.0, -1.0, 0.0, 1.0},
              (const double[]){0.0, 1.0, 0.0, -1.0, 0.0}, WALL);
    plot_leave(&panel);
}
