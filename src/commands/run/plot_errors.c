// Draws how far runs are from the one that is taken as the truth.
#include "commands/run/plot_lines.h"
#include "commands/run/run_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// errors below this share of the largest rate are rounding
static const double ERROR_FLOOR = 1e-12;
static const double ERROR_DECADES = 1e4;

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

static double velocity_error(const RunReport *report, const Trajectory *run, size_t sample,
                             size_t body)
{
    const Trajectory *truth = find_truth(report);
    return vec2_length(vec2_sub(trajectory_motion(run, sample, body)->velocity,
                                trajectory_motion(truth, sample, body)->velocity));
}

// The fastest of a body's centre at the samples, m/s.
static double speed_scale(const Trajectory *run, size_t body)
{
    double most = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        most = fmax(most, vec2_length(trajectory_motion(run, i, body)->velocity));
    }
    return most;
}

// What is compared.
typedef struct Compared {
    PlotQuantity quantity;
    const char *axis;
    double (*scale)(const Trajectory *run, size_t body);
} Compared;

static const Compared *compared_in(const PlotView *view)
{
    static const Compared TURNING = {{"difference of omega", false, -1, omega_error},
                                     "|difference of omega|, rad/s",
                                     trajectory_omega_scale};
    static const Compared MOVING = {{"difference of velocity", false, -1, velocity_error},
                                    "|difference of velocity|, m/s",
                                    speed_scale};
    return view->turns ? &TURNING : &MOVING;
}

// Whether a run's difference is drawn: that of one without the play is the play's.
static bool shows_error(const RunReport *report, size_t run)
{
    const bool has_play = scenario_has_clearance(report->scenario);
    return report->errors[run].is_known &&
           !(has_play &&
             strcmp(report->runs[run]->backend, OPTIONS_BACKENDS[BACKEND_ANALYTIC]) == 0);
}

// The largest difference as a range of four decades, none of them below rounding.
static void choose_error_range(const PlotView *view, const Trajectory *truth, Axis *axis)
{
    const RunReport *report = view->report;
    const Compared *of = compared_in(view);
    double high = 0.0;
    double scale = 0.0;
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t body = 0; shows_error(report, run) && body < truth->body_count; body++) {
            scale = fmax(scale, of->scale(truth, body));
            for (size_t i = 0; i < truth->sample_count; i++) {
                high = fmax(high, of->quantity.at(report, report->runs[run], i, body));
            }
        }
    }
    const double rounding = fmax(ERROR_FLOOR * scale, ERROR_FLOOR);
    axis->high = pow(10.0, ceil(log10(fmax(high, rounding))));
    axis->low = fmax(axis->high / ERROR_DECADES, 1e-3 * pow(10.0, floor(log10(rounding))));
}

// Whether there is a difference to draw, and not rounding alone.
static bool differs(const PlotView *view, size_t run, size_t body)
{
    const RunReport *report = view->report;
    const Compared *of = compared_in(view);
    const Trajectory *truth = find_truth(report);
    const double floor = ERROR_FLOOR * of->scale(truth, body);
    for (size_t i = 0; i < truth->sample_count; i++) {
        if (of->quantity.at(report, report->runs[run], i, body) > floor) {
            return true;
        }
    }
    return false;
}

static bool draws_error(const PlotView *view, size_t run, size_t body)
{
    return shows_error(view->report, run) && plot_look_shows(view, false, body) &&
           differs(view, run, body);
}

bool plot_errors_any(const PlotView *view)
{
    const RunReport *report = view->report;
    const Trajectory *truth = find_truth(report);
    for (size_t run = 0; truth != NULL && run < report->run_count; run++) {
        for (size_t body = 0; body < truth->body_count; body++) {
            if (draws_error(view, run, body)) {
                return true;
            }
        }
    }
    return false;
}

void plot_errors_draw(const PlotView *view, PlotPanel panel)
{
    const RunReport *report = view->report;
    const Compared *of = compared_in(view);
    const Trajectory *truth = find_truth(report);
    char title[128];
    snprintf(title, sizeof title, "Difference from %s", truth->backend);
    panel.title = title;
    panel.y = (Axis){.title = of->axis, .scale = AXIS_LOG};
    choose_error_range(view, truth, &panel.y);
    plot_enter(&panel);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t body = 0; body < truth->body_count; body++) {
            if (draws_error(view, run, body)) {
                plot_look_draw(view, &panel, run, of->quantity, body);
            }
        }
    }
    plot_leave(&panel);
}
