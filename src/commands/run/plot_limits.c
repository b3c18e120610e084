// Where were coordinates between their flanks or stops?
//
// Of a backlash the coordinate is shown from the middle of the gap, of stops as it is: by
// themselves, for a gap is a small part of the way between stops. Over a torque that changes and
// drives it, it is the loop that a test of a servo or a gear shows.
#include "commands/run/plot_look.h"
#include "model/coordinate.h"
#include "write/units.h"

#include <math.h>

static const PlotStyle LIMIT = {"#222222", 1.4, 1.0, "6 4"};

static const Joint *joint_of(const RunReport *report, size_t joint)
{
    return &report->scenario->linkage.joints[joint];
}

// What the coordinate is shown from.
static double origin_of(const Joint *joint)
{
    return joint->limits.kind == LIMIT_BACKLASH ? joint->limits.middle : 0.0;
}

static double angle_of(const RunReport *report, const Trajectory *run, size_t sample, size_t joint)
{
    const double angle = trajectory_state(run, sample, joint)->tilt;
    return (angle - origin_of(joint_of(report, joint))) * UNITS_DEG;
}

static double length_of(const RunReport *report, const Trajectory *run, size_t sample, size_t joint)
{
    const double length = trajectory_state(run, sample, joint)->eccentricity.x;
    const Joint *of = joint_of(report, joint);
    // that of gears is from the middle already
    return (length - (of->kind == JOINT_GEAR ? 0.0 : origin_of(of))) * UNITS_MM;
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

static bool shows(const LimitPanel *limits, const PlotView *view, size_t run, size_t joint)
{
    const Joint *of = joint_of(view->report, joint);
    return of->limits.kind == limits->kind && linkage_is_torsional(of) == limits->is_angle &&
           !view->joints.is_left_out[joint] && trajectory_feels_play(view->report->runs[run], of);
}

// One that a joint does not have is infinite.
static double limit_of(const LimitPanel *limits, const Joint *joint, int side)
{
    const double limit = side == 0 ? coordinate_low(joint) : coordinate_high(joint);
    return (limit - origin_of(joint)) * limits->unit;
}

static void take(Axis *axis, double value)
{
    axis->low = isfinite(value) ? fmin(axis->low, value) : axis->low;
    axis->high = isfinite(value) ? fmax(axis->high, value) : axis->high;
}

static void widen(const LimitPanel *limits, const PlotView *view, Axis *axis)
{
    const RunReport *report = view->report;
    axis->low = INFINITY;
    axis->high = -INFINITY;
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *trajectory = report->runs[run];
        for (size_t joint = 0; joint < trajectory->joint_count; joint++) {
            if (!shows(limits, view, run, joint)) {
                continue;
            }
            take(axis, limit_of(limits, joint_of(report, joint), 0));
            take(axis, limit_of(limits, joint_of(report, joint), 1));
            for (size_t i = 0; i < trajectory->sample_count; i++) {
                take(axis, limits->quantity.at(report, trajectory, i, joint));
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

static void draw_limits(const LimitPanel *limits, const PlotView *view, const PlotPanel *panel,
                        size_t joint)
{
    for (int side = 0; side < 2; side++) {
        const double limit = limit_of(limits, joint_of(view->report, joint), side);
        if (isfinite(limit)) {
            plot_line(panel, 2, (const double[]){panel->x.low, panel->x.high},
                      (const double[]){limit, limit}, LIMIT);
        }
    }
}

static void draw(const LimitPanel *limits, const PlotView *view, PlotPanel panel)
{
    panel.title = limits->title;
    panel.y.title = limits->axis;
    widen(limits, view, &panel.y);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    for (size_t run = 0; run < view->report->run_count; run++) {
        for (size_t joint = 0; joint < view->report->scenario->linkage.joint_count; joint++) {
            if (shows(limits, view, run, joint)) {
                draw_limits(limits, view, &panel, joint);
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
                     is_angle ? angle_of : length_of},
    };
}

void plot_limits_angles(const PlotView *view, PlotPanel panel)
{
    const LimitPanel limits = panel_of(true, LIMIT_STOPS);
    draw(&limits, view, panel);
}

void plot_limits_lengths(const PlotView *view, PlotPanel panel)
{
    const LimitPanel limits = panel_of(false, LIMIT_STOPS);
    draw(&limits, view, panel);
}

void plot_limits_angle_gaps(const PlotView *view, PlotPanel panel)
{
    const LimitPanel limits = panel_of(true, LIMIT_BACKLASH);
    draw(&limits, view, panel);
}

void plot_limits_length_gaps(const PlotView *view, PlotPanel panel)
{
    const LimitPanel limits = panel_of(false, LIMIT_BACKLASH);
    draw(&limits, view, panel);
}

// The coordinate over what drives it at the same time.
static Vec2 loop_at(const RunReport *report, const Trajectory *run, size_t sample,
                    const PlotPath *path)
{
    const Torque *torque = &report->scenario->linkage.torque;
    const bool is_angle = linkage_is_torsional(joint_of(report, path->joint));
    return (Vec2){
        time_table_at(&torque->table, run->times[sample]),
        (is_angle ? angle_of : length_of)(report, run, sample, path->joint),
    };
}

static Axis torque_axis(const RunReport *report, bool is_angle)
{
    const TimeTable *table = &report->scenario->linkage.torque.table;
    Axis axis = {.title = is_angle ? "torque of the drive, N m" : "force of the drive, N",
                 .low = INFINITY,
                 .high = -INFINITY};
    for (size_t i = 0; i < table->count; i++) {
        take(&axis, table->values[i]);
    }
    axis_round(&axis.low, &axis.high);
    return axis;
}

void plot_limits_loop(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    const size_t joint = (size_t)report->scenario->linkage.torque.joint;
    const bool is_angle = linkage_is_torsional(joint_of(report, joint));
    const LimitPanel limits = panel_of(is_angle, joint_of(report, joint)->limits.kind);
    const PlotPath path = {.joint = joint, .at = loop_at};
    panel.title = is_angle ? "Angle over torque; dashed: flanks and stops"
                           : "Travel over force; dashed: flanks and stops";
    panel.x = torque_axis(report, is_angle);
    panel.y.title = is_angle ? "angle, deg" : "travel, mm";
    widen(&limits, view, &panel.y);
    plot_enter(&panel);
    for (size_t run = 0; run < report->run_count; run++) {
        if (shows(&limits, view, run, joint)) {
            draw_limits(&limits, view, &panel, joint);
            plot_look_path(view, &panel, run, &path);
        }
    }
    plot_leave(&panel);
}

bool plot_limits_has_loop(const Linkage *linkage)
{
    const TimeTable *table = &linkage->torque.table;
    bool is_changing = false;
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
