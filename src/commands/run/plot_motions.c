// How did the bodies move?
//
// Their rotation, or the motion of their centres where nothing turns.
#include "commands/run/plot_look.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// a symmetric logarithmic scale is used where one backend exceeds another by this factor, or
// exceeds what it stays below for most of its run
static const double SPIKY = 8.0;
static const double USUAL = 0.9;

static double omega_of(const RunReport *report, const Trajectory *run, size_t sample, size_t body)
{
    (void)report;
    return trajectory_motion(run, sample, body)->omega;
}

static double alpha_of(const RunReport *report, const Trajectory *run, size_t sample, size_t body)
{
    (void)report;
    return trajectory_motion(run, sample, body)->alpha;
}

static double speed_of(const RunReport *report, const Trajectory *run, size_t sample, size_t body)
{
    (void)report;
    const Vec2 velocity = trajectory_motion(run, sample, body)->velocity;
    return hypot(velocity.x, velocity.y);
}

static double acceleration_of(const RunReport *report, const Trajectory *run, size_t sample,
                              size_t body)
{
    (void)report;
    const Vec2 acceleration = trajectory_motion(run, sample, body)->acceleration;
    return hypot(acceleration.x, acceleration.y);
}

// How far a quantity goes in one run, over all bodies that are shown.
typedef struct Reach {
    double low;
    double high;
    double usual; // what most of the run stays below on either side of zero
} Reach;

static int by_size(const void *a, const void *b)
{
    const double first = *(const double *)a;
    const double second = *(const double *)b;
    return (first > second) - (first < second);
}

static Reach find_reach(const PlotView *view, const Trajectory *run, PlotQuantity quantity)
{
    const PlotSet *bodies = &view->bodies;
    Reach reach = {0};
    const size_t count = plot_look_stretch_count(run, quantity);
    double *sizes = calloc(count, sizeof *sizes);
    assert(sizes != NULL);
    for (size_t i = 0; i < count; i++) {
        for (size_t body = 0; body < run->body_count; body++) {
            if (!bodies->is_shown[body] && !bodies->is_other[body]) {
                continue;
            }
            const Range range = plot_look_stretch(view->report, run, quantity, i, body).range;
            if (range.least <= range.most) {
                reach.low = fmin(reach.low, range.least);
                reach.high = fmax(reach.high, range.most);
                sizes[i] = fmax(sizes[i], fmax(-range.least, range.most));
            }
        }
    }
    qsort(sizes, count, sizeof *sizes, by_size);
    reach.usual = sizes[(size_t)(USUAL * (double)(count - 1))];
    free(sizes);
    return reach;
}

// A linear scale, unless one backend dwarfs another, or spikes dwarf the rest of a run.
static void choose_scale(const PlotView *view, PlotQuantity quantity, Axis *axis)
{
    const RunReport *report = view->report;
    double least = INFINITY;
    for (size_t i = 0; i < report->run_count; i++) {
        if (!report->runs[i]->is_complete) {
            continue;
        }
        const Reach reach = find_reach(view, report->runs[i], quantity);
        const double size = fmax(-reach.low, reach.high);
        least = size > 0.0 ? fmin(least, size) : least;
        least = reach.usual > 0.0 ? fmin(least, reach.usual) : least;
        axis->low = fmin(axis->low, reach.low);
        axis->high = fmax(axis->high, reach.high);
    }
    const double most = fmax(-axis->low, axis->high);
    const bool is_size = axis->low == 0.0;
    if (most > SPIKY * least) {
        axis->scale = AXIS_SYMLOG;
        axis->threshold = pow(10.0, floor(log10(least)));
        axis->high = pow(10.0, ceil(log10(most)));
        axis->low = -axis->high;
    } else {
        axis_round(&axis->low, &axis->high);
    }
    // what is never below 0 needs no room there
    axis->low = is_size ? 0.0 : axis->low;
}

static void draw_motion(const PlotView *view, PlotPanel panel, PlotQuantity quantity,
                        bool has_spikes)
{
    const RunReport *report = view->report;
    choose_scale(view, quantity, &panel.y);
    plot_enter(&panel);
    plot_look_shade(view, &panel);
    plot_look_others(view, &panel, quantity);
    for (size_t run = 0; run < report->run_count; run++) {
        for (size_t body = 0; body < report->scenario->linkage.body_count; body++) {
            if (plot_look_shows(view, false, body) && report->runs[run]->is_complete) {
                plot_look_draw(view, &panel, run, quantity, body);
            }
        }
    }
    const Trajectory *spiky = has_spikes ? plot_look_spike_run(view) : NULL;
    for (size_t body = 0; spiky != NULL && body < spiky->body_count; body++) {
        if (plot_look_shows(view, false, body)) {
            plot_look_marks(view, &panel, &spiky->alpha_spikes[body], quantity, body, "rad/s^2");
        }
    }
    plot_leave(&panel);
}

// How bodies turn whose axes are not all along z: the sizes of their vectors.
static double turning_of(const RunReport *report, const Trajectory *run, size_t sample, size_t body)
{
    return run->space_motions != NULL
               ? vec3_length(trajectory_space_motion(run, sample, body)->omega)
               : fabs(omega_of(report, run, sample, body));
}

static double spinning_up_of(const RunReport *report, const Trajectory *run, size_t sample,
                             size_t body)
{
    return run->space_motions != NULL
               ? vec3_length(trajectory_space_motion(run, sample, body)->alpha)
               : fabs(alpha_of(report, run, sample, body));
}

// A pair of panels: a rate of the bodies' motion and how that changes.
typedef struct MotionPanels {
    const char *titles[2];
    const char *axes[2];
    PlotQuantity quantities[2];
    bool has_spikes; // the second
} MotionPanels;

// The rotation of the bodies, or the motion of their centres where nothing turns.
static const MotionPanels *choose_motions(const PlotView *view)
{
    static const MotionPanels PANELS[] = {
        {{"Angular velocity", "Angular acceleration"},
         {"omega, rad/s", "alpha, rad/s^2"},
         {{"omega", false, RANGES_OMEGA, omega_of}, {"alpha", false, RANGES_ALPHA, alpha_of}},
         true},
        {{"Speed of the centre of mass", "Acceleration of the centre of mass"},
         {"speed, m/s", "acceleration, m/s^2"},
         {{"speed", false, -1, speed_of},
          {"acceleration", false, RANGES_ACCELERATION, acceleration_of}},
         false},
        {{"Angular velocity about z", "Angular acceleration about z"},
         {"omega, rad/s", "alpha, rad/s^2"},
         {{"omega", false, RANGES_OMEGA, omega_of}, {"alpha", false, RANGES_ALPHA, alpha_of}},
         true},
        {{"Angular velocity, its size at the samples", "Angular acceleration, its size"},
         {"|omega|, rad/s", "|alpha|, rad/s^2"},
         {{"|omega|", false, -1, turning_of}, {"|alpha|", false, -1, spinning_up_of}},
         false},
    };
    const Linkage *linkage = &view->report->scenario->linkage;
    return &PANELS[!view->turns ? 1 : !linkage->is_spatial ? 0 : space_has_plane(linkage) ? 2 : 3];
}

void plot_motions_draw(const PlotView *view, int which, PlotPanel panel)
{
    const MotionPanels *panels = choose_motions(view);
    panel.title = panels->titles[which];
    panel.y.title = panels->axes[which];
    draw_motion(view, panel, panels->quantities[which], which == 1 && panels->has_spikes);
}
