// What did each of very many bodies and joints come to?
//
// The largest acceleration and force of all of them, over their numbers in the case: the only
// panels of a large mechanism that leave nothing out.
#include "commands/run/plot_look.h"

#include "base/zeroed.h"

#include <math.h>
#include <stdio.h>

static const double DEPTH = 1e-6; // the axis ends at this share of the largest value

// Whether something is in the panels of all, drawn there or not.
static bool is_in(const PlotSet *set, size_t number)
{
    return set->is_shown[number] || set->is_other[number];
}

static void choose_axis(const PlotView *view, bool is_joint, size_t count, Axis *axis)
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
    PlotStyle style = plot_style(run, 0);
    style.colour = "#333333";
    plot_line(panel, drawn, x, y, style);
    for (size_t i = 0; i < count; i++) {
        if (set->is_shown[i]) {
            plot_dot(panel, (double)(i + 1), plot_view_most(view, is_joint, trajectory, i),
                     plot_style(run, plot_look_colour(view, is_joint, i)));
        }
    }
    free(x);
}

static void draw(const PlotView *view, PlotPanel panel, bool is_joint)
{
    const Linkage *linkage = &view->report->scenario->linkage;
    const size_t count = is_joint ? linkage->joint_count : linkage->body_count;
    panel.x = (Axis){.title = is_joint ? "number of the joint, as in the case"
                                       : "number of the body, as in the case",
                     .low = 1.0,
                     .high = (double)count};
    choose_axis(view, is_joint, count, &panel.y);
    plot_enter(&panel);
    for (size_t run = 0; run < view->report->run_count; run++) {
        if (view->report->runs[run]->is_complete) {
            draw_run(view, &panel, is_joint, run, count);
        }
    }
    plot_leave(&panel);
}

void plot_overview_bodies(const PlotView *view, PlotPanel panel)
{
    panel.title = "All bodies: the largest of the whole run";
    panel.y.title = view->turns ? "|alpha|, rad/s^2" : "acceleration, m/s^2";
    draw(view, panel, false);
}

void plot_overview_joints(const PlotView *view, PlotPanel panel)
{
    panel.title = "All joints: the largest of the whole run";
    panel.y.title = "force, N";
    draw(view, panel, true);
}
