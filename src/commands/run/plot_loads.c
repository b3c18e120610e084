// Draws what drives a mechanism, and how pins bear on their holes.
#include "commands/run/plot_lines.h"
#include "run/drive_torque.h"

#include <math.h>
#include <stdio.h>

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
    panel.y.low = INFINITY;
    panel.y.high = -INFINITY;
    for (size_t n = 0; n < count * report->run_count; n++) {
        show_torques(report, report->runs[n / count], joints[n % count], &panel.y);
    }
    axis_fit(&panel.y.low, &panel.y.high);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    for (size_t n = 0; n < count * report->run_count; n++) {
        const size_t run = plot_look_run(view, n / count);
        if (report->runs[run]->is_complete) {
            plot_look_draw(view, &panel, run, TORQUE, joints[n % count]);
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

static Vec2 pin_load_at_mark(const Trajectory *run, const ContactMark *mark, const PlotPath *path)
{
    const int body = run->linkage.joints[path->joint].body_a;
    return vec2_rotate(-trajectory_angle_at(run, body, mark->time_s), mark->force_on_b);
}

// In space the body with the hole does not turn about one axis.
static PlotPath load_path(const Trajectory *run, size_t joint)
{
    return (PlotPath){.joint = joint,
                      .at = pin_load_at,
                      .at_mark = run->linkage.is_spatial ? NULL : pin_load_at_mark};
}

// Whether the loads of a pin are drawn: in a run that feels its play, and in the ideal one.
static bool shows_load(const PlotView *view, size_t run, size_t joint)
{
    return view->report->runs[run]->is_complete && !view->joints.is_left_out[joint] &&
           joint_has_hole(view->report->scenario->linkage.joints[joint].kind);
}

// What the load of a pin spans, N: the window of the panel.
typedef struct LoadWindow {
    Vec2 low;
    Vec2 high;
    double most; // the largest force
} LoadWindow;

static void widen_window(void *context, Vec2 load)
{
    LoadWindow *window = context;
    window->low = (Vec2){fmin(window->low.x, load.x), fmin(window->low.y, load.y)};
    window->high = (Vec2){fmax(window->high.x, load.x), fmax(window->high.y, load.y)};
    window->most = fmax(window->most, vec2_length(load));
}

static LoadWindow find_window(const PlotView *view)
{
    const RunReport *report = view->report;
    LoadWindow window = {0};
    for (size_t run = 0; run < report->run_count; run++) {
        const Trajectory *of = report->runs[run];
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            if (shows_load(view, run, joint)) {
                const PlotPath path = load_path(of, joint);
                plot_look_places(report, of, &path, widen_window, &window);
            }
        }
    }
    return window;
}

static const double WINDOW_MARGIN = 0.08; // of the largest force, on each side

// The axes of a panel that holds a window, with one scale in both directions.
static void fit_window(const LoadWindow *window, PlotPanel *panel)
{
    const double margin = window->most > 0.0 ? WINDOW_MARGIN * window->most : 1.0;
    const double wide = window->high.x - window->low.x + 2.0 * margin;
    const double high = window->high.y - window->low.y + 2.0 * margin;
    const double scale = fmax(wide / panel->width, high / panel->height);
    const Vec2 middle = vec2_scale(0.5, vec2_add(window->low, window->high));
    const double x = 0.5 * scale * panel->width;
    const double y = 0.5 * scale * panel->height;
    panel->x.low = middle.x - x;
    panel->x.high = middle.x + x;
    panel->y.low = middle.y - y;
    panel->y.high = middle.y + y;
}

enum { SPOKES = 12 };
static const double SPOKE_LABEL = 18.0; // from the frame to the middle of an angle's label, pixels

static const double CIRCLE_LABEL = 32.0; // from the frame to the middle of a force's label, pixels

static Vec2 spoke_direction(int spoke)
{
    return vec2_rotate(2.0 * acos(-1.0) * spoke / SPOKES, (Vec2){1.0, 0.0});
}

// How far along a spoke the frame is, in the panel's unit; the middle of the circles lies within
// it.
static double spoke_length(const PlotPanel *panel, int spoke)
{
    const Vec2 along = spoke_direction(spoke);
    const double x = fabs(along.x) < 1e-9 ? INFINITY
                     : along.x > 0.0      ? panel->x.high / along.x
                                          : panel->x.low / along.x;
    const double y = fabs(along.y) < 1e-9 ? INFINITY
                     : along.y > 0.0      ? panel->y.high / along.y
                                          : panel->y.low / along.y;
    return fmin(x, y);
}

// The spoke for the labels of the circles: the one along which there is most room without loads.
static int roomiest_spoke(const PlotPanel *panel, const LoadWindow *window)
{
    int best = 0;
    double most = -INFINITY;
    const Vec2 loads = vec2_add(window->low, window->high);
    for (int spoke = 0; spoke < SPOKES; spoke++) {
        // beside the axes, whose own labels are the angles of the frame
        const double busy = 0.5 * fmax(0.0, vec2_dot(spoke_direction(spoke), loads));
        const double room = fmin(spoke_length(panel, spoke), window->most) - busy;
        if (spoke % 3 != 0 && room > most) {
            best = spoke;
            most = room;
        }
    }
    return best;
}

static void draw_spokes(const PlotPanel *panel)
{
    static const PlotStyle SPOKE = {"#e4e4e4", 1.0, 1.0, NULL};
    static const PlotStyle AXIS = {"#b0b0b0", 1.0, 1.0, NULL};
    const double pixel = (panel->x.high - panel->x.low) / panel->width;
    for (int spoke = 0; spoke < SPOKES; spoke++) {
        const double length = spoke_length(panel, spoke);
        const Vec2 end = vec2_scale(length, spoke_direction(spoke));
        char words[16];
        snprintf(words, sizeof words, "%d\302\260", 360 / SPOKES * spoke);
        plot_line(panel, 2, (const double[]){0.0, end.x}, (const double[]){0.0, end.y},
                  spoke % 3 == 0 ? AXIS : SPOKE);
        if (length > 4.0 * SPOKE_LABEL * pixel) {
            // whole within the frame
            const double x = fmin(fmax(plot_x(panel, end.x), panel->left + SPOKE_LABEL),
                                  panel->left + panel->width - SPOKE_LABEL);
            const double y = fmin(fmax(plot_y(panel, end.y), panel->top + 0.6 * SPOKE_LABEL),
                                  panel->top + panel->height - 0.6 * SPOKE_LABEL);
            plot_text(panel->svg, x, y + 4.0, "middle", "halo", words);
        }
    }
}

// Circles of equal force, in the steps of an axis as long as the largest.
static void draw_circles(const PlotPanel *panel, const LoadWindow *window)
{
    static const PlotStyle CIRCLE = {"#e4e4e4", 1.0, 1.0, NULL};
    const int spoke = roomiest_spoke(panel, window);
    const double step = axis_step(window->most, 4);
    // up to the corners of the panel
    const double far =
        hypot(fmax(panel->x.high, -panel->x.low), fmax(panel->y.high, -panel->y.low));
    for (double force = step; window->most > 0.0 && force < far; force += step) {
        const Vec2 at = vec2_scale(force, spoke_direction(spoke));
        plot_circle(panel, force, CIRCLE);
        const double room = panel->left + panel->width - plot_x(panel, at.x);
        if (force < 0.9 * spoke_length(panel, spoke) && room > CIRCLE_LABEL &&
            plot_x(panel, at.x) - panel->left > CIRCLE_LABEL) {
            char words[32];
            snprintf(words, sizeof words, "%g N", force);
            plot_text(panel->svg, plot_x(panel, at.x), plot_y(panel, at.y) + 4.0, "middle", "halo",
                      words);
        }
    }
}

void plot_loads_pins(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    const LoadWindow window = find_window(view);
    fit_window(&window, &panel);
    panel.title = "Force on the pin, seen from its hole";
    panel.x.title = "size, N, and direction from the x axis of the body with the hole";
    panel.y.title = NULL;
    plot_enter_bare(&panel);
    draw_spokes(&panel);
    draw_circles(&panel, &window);
    for (size_t i = 0; i < report->run_count; i++) {
        const size_t run = plot_look_run(view, i);
        for (size_t joint = 0; joint < report->scenario->linkage.joint_count; joint++) {
            if (shows_load(view, run, joint)) {
                const PlotPath path = load_path(report->runs[run], joint);
                plot_look_path(view, &panel, run, &path);
            }
        }
    }
    plot_leave(&panel);
}
