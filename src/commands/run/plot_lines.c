// Chooses line, colour and axis of each quantity in the picture of a run, and which bodies and
// joints it draws.
#include "commands/run/plot_lines.h"
#include "base/hermite.h"
#include "base/zeroed.h"
#include "commands/run/run_report.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The bodies and joints that a picture draws.
//
// All of them, up to some twenty: more lines cannot be told apart. Of more those that most happens
// to, in any of the runs.

enum { DRAWN_MOST = 24, DRAWN_OF_MANY = 12 };

const PlotSet *plot_view_set(const PlotView *view, bool is_joint)
{
    return is_joint ? &view->joints : &view->bodies;
}

// Does any body that no drive turns turn by more than rounding? A body without friction in a round
// hole does not, and its angular velocity would be a picture of noise. Its energy of rotation is
// held against its energy of translation: speeds that differ by 1e-10 are rounding over many steps.
static bool any_turns(const RunReport *report)
{
    const double turning = 1e-10 * 1e-10;
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        for (size_t body = 0; run->is_complete && body < run->body_count; body++) {
            if (linkage_is_driven(&report->scenario->linkage, (int)body)) {
                continue;
            }
            const Body *shape = &report->scenario->linkage.bodies[body];
            double rotation = 0.0;
            double translation = 0.0;
            for (size_t sample = 0; sample < run->sample_count; sample++) {
                const Motion *motion = trajectory_motion(run, sample, body);
                const double speed = hypot(motion->velocity.x, motion->velocity.y);
                rotation = fmax(rotation, shape->inertia * motion->omega * motion->omega);
                translation = fmax(translation, shape->mass * speed * speed);
            }
            if (rotation > turning * translation) {
                return true;
            }
        }
    }
    return false;
}

static double largest_acceleration(const Trajectory *run, size_t body)
{
    double most = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        const Vec2 acceleration = trajectory_motion(run, i, body)->acceleration;
        most = fmax(most, hypot(acceleration.x, acceleration.y));
    }
    return most;
}

double plot_view_most(const PlotView *view, bool is_joint, const Trajectory *run, size_t number)
{
    if (is_joint) {
        return run->joints[number].force_max.value;
    }
    const BodyExtremes *body = &run->bodies[number];
    return view->turns ? fmax(body->alpha_max.value, -body->alpha_min.value)
                       : largest_acceleration(run, number);
}

typedef struct Ranked {
    size_t number;
    double most;
} Ranked;

// The largest first, and of equal ones the first of the case.
static int compare_ranked(const void *a, const void *b)
{
    const Ranked *left = a;
    const Ranked *right = b;
    if (left->most != right->most) {
        return left->most < right->most ? 1 : -1;
    }
    return (left->number > right->number) - (left->number < right->number);
}

// Leaves out all but the first of many.
static void plot_lines_choose(const PlotView *view, bool is_joint, Ranked *ranked, size_t count)
{
    const RunReport *report = view->report;
    if (count <= DRAWN_MOST) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        ranked[i].most = 0.0;
        for (size_t k = 0; k < report->run_count; k++) {
            const Trajectory *run = report->runs[k];
            if (run->is_complete) {
                const double most = plot_view_most(view, is_joint, run, ranked[i].number);
                ranked[i].most = fmax(ranked[i].most, most);
            }
        }
    }
    qsort(ranked, count, sizeof *ranked, compare_ranked);
    for (size_t i = DRAWN_OF_MANY; i < count; i++) {
        plot_view_set(view, is_joint)->is_left_out[ranked[i].number] = true;
    }
}

static PlotSet set_create(size_t count)
{
    return (PlotSet){
        .is_shown = zeroed(count, sizeof(bool)),
        .is_other = zeroed(count, sizeof(bool)),
        .is_left_out = zeroed(count, sizeof(bool)),
        .is_named = zeroed(count, sizeof(bool)),
        .of_palette = zeroed(count, sizeof(unsigned)),
    };
}

static void plot_lines_set_free(PlotSet *set)
{
    free(set->is_shown);
    free(set->is_other);
    free(set->is_left_out);
    free(set->is_named);
    free(set->of_palette);
}

// Takes out of those that are shown or named what is left out. Colours go by the order of the case,
// from the one given on.
static void plot_lines_settle(PlotSet *set, size_t count, unsigned first_colour)
{
    unsigned colour = first_colour;
    for (size_t i = 0; i < count; i++) {
        set->is_other[i] = set->is_shown[i] && set->is_left_out[i];
        set->is_shown[i] = set->is_shown[i] && !set->is_left_out[i];
        set->left_out += set->is_other[i] ? 1 : 0;
        set->drawn += set->is_shown[i] ? 1 : 0;
        set->is_named[i] = set->is_shown[i] || (set->is_named[i] && !set->is_left_out[i]);
        set->of_palette[i] = colour;
        colour += set->is_named[i] ? 1 : 0;
    }
}

static void plot_lines_choose_bodies(PlotView *view)
{
    const Linkage *linkage = &view->report->scenario->linkage;
    Ranked *ranked = zeroed(linkage->body_count, sizeof *ranked);
    size_t count = 0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        view->bodies.is_shown[i] = !linkage_is_driven(linkage, (int)i);
        if (view->bodies.is_shown[i]) {
            ranked[count++].number = i;
        }
    }
    plot_lines_choose(view, false, ranked, count);
    free(ranked);
    plot_lines_settle(&view->bodies, linkage->body_count, 0);
}

// Of each kind by itself, since there are panels for some kinds alone.
static void choose_joints(PlotView *view)
{
    const Scenario *scenario = view->report->scenario;
    const Linkage *linkage = &scenario->linkage;
    const bool has_clearance = scenario_has_clearance(scenario);
    Ranked *ranked = zeroed(linkage->joint_count, sizeof *ranked);
    for (JointKind kind = 0; kind < JOINT_KIND_COUNT; kind++) {
        size_t count = 0;
        for (size_t i = 0; i < linkage->joint_count; i++) {
            if (linkage->joints[i].kind == kind) {
                ranked[count++].number = i;
                view->joints.is_shown[i] = !has_clearance || linkage_has_play(&linkage->joints[i]);
                view->joints.is_named[i] = slide_range_has(&linkage->joints[i]);
            }
        }
        plot_lines_choose(view, true, ranked, count);
    }
    free(ranked);
    plot_lines_settle(&view->joints, linkage->joint_count, (unsigned)view->bodies.drawn);
}

PlotView plot_view_begin(const RunReport *report)
{
    const Linkage *linkage = &report->scenario->linkage;
    PlotView view = {
        .report = report,
        .turns = linkage_drive_count(linkage) == linkage->body_count || !space_has_plane(linkage) ||
                 any_turns(report),
        .bodies = set_create(linkage->body_count),
        .joints = set_create(linkage->joint_count),
    };
    plot_lines_choose_bodies(&view);
    choose_joints(&view);
    return view;
}

void plot_view_finish(PlotView *view)
{
    plot_lines_set_free(&view->bodies);
    plot_lines_set_free(&view->joints);
    *view = (PlotView){.report = NULL};
}

// The kind of line, the colour and the axis of each quantity.
//
// A backend has a kind of line, a body or joint a colour. The first backend is drawn wide and
// pale, the next thin over it: where the two agree, the thin line lies in the middle of the pale. A
// run with ideal joints beside others with play is a very thin dark line on top.

bool plot_look_shows(const PlotView *view, bool is_joint, size_t index)
{
    return plot_view_set(view, is_joint)->is_shown[index];
}

size_t plot_look_colour(const PlotView *view, bool is_joint, size_t index)
{
    return plot_view_set(view, is_joint)->of_palette[index];
}

static bool is_ideal(const PlotView *view, size_t run)
{
    const RunReport *report = view->report;
    return scenario_has_clearance(report->scenario) && report->run_count > 1 &&
           strcmp(report->runs[run]->backend, OPTIONS_BACKENDS[BACKEND_ANALYTIC]) == 0;
}

PlotStyle plot_look_style(const PlotView *view, size_t run, size_t colour)
{
    size_t kind = 0;
    for (size_t i = 0; i < run; i++) {
        kind += is_ideal(view, i) ? 0 : 1;
    }
    // a run alone is no band for others to lie on
    size_t others = 0;
    for (size_t i = 0; i < view->report->run_count; i++) {
        others += i != run && !is_ideal(view, i) && view->report->runs[i]->is_complete ? 1 : 0;
    }
    kind = others == 0 ? 1 : kind;
    return is_ideal(view, run) ? plot_style_dark(colour) : plot_style(kind, colour);
}

size_t plot_look_run(const PlotView *view, size_t i)
{
    size_t place = 0;
    for (size_t run = 0; run < view->report->run_count; run++) {
        if (!is_ideal(view, run) && place++ == i) {
            return run;
        }
    }
    size_t ideal = 0;
    for (size_t run = 0; run < view->report->run_count; run++) {
        ideal = is_ideal(view, run) ? run : ideal;
    }
    return ideal;
}

// The distance of the ticks of an axis of so many revolutions, deg; 0: any.
static double crank_tick(double turns)
{
    static const double TICKS[][2] = {{0.1, 5.0},  {0.2, 10.0}, {0.3, 15.0}, {0.6, 30.0},
                                      {1.0, 60.0}, {2.0, 90.0}, {3.0, 180.0}};
    for (size_t i = 0; i < sizeof TICKS / sizeof *TICKS; i++) {
        if (turns <= TICKS[i][0]) {
            return turns > 0.02 ? TICKS[i][1] : 0.0;
        }
    }
    return 0.0;
}

Axis plot_look_x_axis(const PlotView *view)
{
    const Scenario *scenario = view->report->scenario;
    if (!drive_is_steady(&scenario->linkage.driver)) {
        return (Axis){.title = "time, ms", .high = scenario_duration(scenario) * UNITS_MS};
    }
    const double turns = scenario->run.revolutions;
    return (Axis){
        .title = "crank angle from the start, deg",
        .high = 360.0 * turns,
        .tick = crank_tick(turns),
    };
}

double plot_look_x(const PlotView *view, double crank_rad, double time_s)
{
    const Linkage *linkage = &view->report->scenario->linkage;
    return drive_is_steady(&linkage->driver) ? fabs(crank_rad - linkage->driver.start) * UNITS_DEG
                                             : time_s * UNITS_MS;
}

static const char *plot_lines_name_of(const RunReport *report, PlotQuantity quantity, size_t index)
{
    const Linkage *linkage = &report->scenario->linkage;
    return quantity.is_joint ? linkage->joints[index].name : linkage->bodies[index].name;
}

static bool has_ranges(const Trajectory *run, PlotQuantity quantity)
{
    return quantity.signal >= 0 && run->ranges.count > 0;
}

size_t plot_look_stretch_count(const Trajectory *run, PlotQuantity quantity)
{
    return has_ranges(run, quantity) ? run->ranges.count : run->sample_count;
}

PlotStretch plot_look_stretch(const RunReport *report, const Trajectory *run, PlotQuantity quantity,
                              size_t stretch, size_t index)
{
    if (!has_ranges(run, quantity)) {
        const double value = quantity.at(report, run, stretch, index);
        return (PlotStretch){run->times[stretch], {value, value}};
    }
    const Ranges *ranges = &run->ranges;
    const size_t signal = quantity.is_joint ? ranges_of_joint(ranges, index, quantity.signal)
                                            : ranges_of_body(index, quantity.signal);
    // the last stretches may reach beyond the end
    return (PlotStretch){fmin(((double)stretch + 0.5) * ranges->width_s, run->duration_s),
                         ranges_over(ranges, signal, stretch, stretch + 1)};
}

void plot_look_shade(const PlotView *view, const PlotPanel *panel)
{
    const double from_s = scenario_report_from(view->report->scenario);
    if (from_s > 0.0) {
        const double crank = linkage_crank_angle(&view->report->scenario->linkage, from_s);
        plot_shade(panel, panel->x.low, plot_look_x(view, crank, from_s));
    }
}

const Trajectory *plot_look_spike_run(const PlotView *view)
{
    const RunReport *report = view->report;
    const Trajectory *last = NULL;
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        for (size_t k = 0; run->is_complete && k < run->body_count; k++) {
            last = run->alpha_spikes[k].is_known && run->alpha_spikes[k].kept > 0 ? run : last;
        }
        for (size_t k = 0; run->is_complete && k < run->joint_count; k++) {
            last = run->force_spikes[k].is_known && run->force_spikes[k].kept > 0 ? run : last;
        }
    }
    return last;
}

void plot_look_marks(const PlotView *view, const PlotPanel *panel, const SignalSpikes *spikes,
                     PlotQuantity quantity, size_t index, const char *unit)
{
    for (size_t i = 0; spikes->is_known && i < spikes->kept; i++) {
        const SignalSpike *spike = &spikes->spikes[i];
        char title[2 * LINKAGE_NAME_SIZE + 96];
        snprintf(title, sizeof title, "%s %s: %.6g %s at %.7g ms", quantity.name,
                 plot_lines_name_of(view->report, quantity, index), spike->value, unit,
                 spike->time_s * UNITS_MS);
        plot_mark(panel, plot_look_x(view, spike->crank_rad, spike->time_s), spike->value,
                  spike->value < 0.0, title,
                  plot_style(1, plot_look_colour(view, quantity.is_joint, index)));
    }
}

// What a band is drawn through: by stretch with values, where it is and from where to where.
typedef struct Curve {
    size_t count;
    double *x; // owned, with the two below
    double *low;
    double *high;
} Curve;

static Curve curve_begin(size_t most)
{
    double *x = calloc(3 * most, sizeof *x);
    assert(x != NULL);
    return (Curve){0, x, x + most, x + 2 * most};
}

static void curve_add(const PlotView *view, double time_s, Range range, Curve *curve)
{
    const double crank = linkage_crank_angle(&view->report->scenario->linkage, time_s);
    if (range.least <= range.most) {
        curve->x[curve->count] = plot_look_x(view, crank, time_s);
        curve->low[curve->count] = range.least;
        curve->high[curve->count++] = range.most;
    }
}

void plot_look_draw(const PlotView *view, const PlotPanel *panel, size_t run, PlotQuantity quantity,
                    size_t index)
{
    const RunReport *report = view->report;
    const Trajectory *trajectory = report->runs[run];
    const size_t most = plot_look_stretch_count(trajectory, quantity);
    Curve curve = curve_begin(most);
    for (size_t i = 0; i < most; i++) {
        const PlotStretch stretch = plot_look_stretch(report, trajectory, quantity, i, index);
        curve_add(view, stretch.time_s, stretch.range, &curve);
    }
    char title[TRAJECTORY_LABEL_SIZE + 2 * LINKAGE_NAME_SIZE];
    snprintf(title, sizeof title, "%s: %s %s", trajectory->backend, quantity.name,
             plot_lines_name_of(report, quantity, index));
    plot_band(panel, curve.count, curve.x, curve.low, curve.high, title,
              plot_look_style(view, run, plot_look_colour(view, quantity.is_joint, index)));
    free(curve.x);
}

void plot_look_others(const PlotView *view, const PlotPanel *panel, PlotQuantity quantity)
{
    const RunReport *report = view->report;
    const PlotSet *set = plot_view_set(view, quantity.is_joint);
    const Trajectory *last = NULL;
    for (size_t i = 0; i < report->run_count; i++) {
        last = report->runs[i]->is_complete ? report->runs[i] : last;
    }
    if (last == NULL || set->left_out == 0) {
        return;
    }
    const size_t most = plot_look_stretch_count(last, quantity);
    const size_t count = quantity.is_joint ? last->joint_count : last->body_count;
    Curve curve = curve_begin(most);
    for (size_t i = 0; i < most; i++) {
        Range range = RANGE_EMPTY;
        double time_s = 0.0;
        for (size_t k = 0; k < count; k++) {
            if (set->is_other[k]) {
                const PlotStretch stretch = plot_look_stretch(report, last, quantity, i, k);
                time_s = stretch.time_s;
                range_join(&range, &stretch.range);
            }
        }
        curve_add(view, time_s, range, &curve);
    }
    char title[TRAJECTORY_LABEL_SIZE + LINKAGE_NAME_SIZE];
    snprintf(title, sizeof title, "%s: %s of all others", last->backend, quantity.name);
    plot_band(panel, curve.count, curve.x, curve.low, curve.high, title,
              (PlotStyle){"#d0d0d0", 1.3, 1.0, NULL});
    free(curve.x);
}

// Slopes at the samples with which a cubic between two of them stays between them.
static void limit_slopes(size_t count, const double *times, const double *values, double *slopes)
{
    slopes[0] = 0.0;
    slopes[count - 1] = 0.0;
    for (size_t i = 1; i + 1 < count; i++) {
        const double before = (values[i] - values[i - 1]) / (times[i] - times[i - 1]);
        const double after = (values[i + 1] - values[i]) / (times[i + 1] - times[i]);
        slopes[i] = before * after > 0.0 ? 2.0 * before * after / (before + after) : 0.0;
    }
}

// A path at its samples and marks, and how it moves.
typedef struct PathCurve {
    size_t count;
    double *times; // s; owned, with the four below
    double *x;
    double *y;
    double *x_rate; // NAN: not known
    double *y_rate;
} PathCurve;

static PathCurve path_create(size_t room)
{
    double *all = zeroed(5 * room, sizeof *all);
    return (PathCurve){0, all, all + room, all + 2 * room, all + 3 * room, all + 4 * room};
}

// Times ascend: what is at the time of the last place is left out.
static void path_add(PathCurve *curve, double time_s, Vec2 place, Vec2 rate)
{
    const size_t i = curve->count;
    if (i > 0 && !(time_s > curve->times[i - 1])) {
        return;
    }
    curve->times[i] = time_s;
    curve->x[i] = place.x;
    curve->y[i] = place.y;
    curve->x_rate[i] = rate.x;
    curve->y_rate[i] = rate.y;
    curve->count++;
}

// The marks of a joint, which a trajectory has in the order of time.
typedef struct JointMarks {
    const MarkedContact *contacts;
    size_t count; // of contacts
    size_t contact;
    size_t mark; // the next of that contact
} JointMarks;

static JointMarks marks_of(const Trajectory *run, const PlotPath *path)
{
    JointMarks marks = {0};
    for (size_t i = 0; path->at_mark != NULL && i < run->marked_count; i++) {
        if (run->marked[i].joint == path->joint) {
            marks.contacts = marks.count == 0 ? &run->marked[i] : marks.contacts;
            marks.count++;
        }
    }
    return marks;
}

// The next of the marks before a time, NULL where there is none.
static const ContactMark *next_mark(JointMarks *marks, double before_s)
{
    if (marks->contact == marks->count) {
        return NULL;
    }
    const MarkedContact *contact = &marks->contacts[marks->contact];
    const ContactMark *mark = &contact->marks[marks->mark];
    if (!(mark->time_s < before_s)) {
        return NULL;
    }
    if (++marks->mark == contact->count) {
        marks->mark = 0;
        marks->contact++;
    }
    return mark;
}

// s: by how much a sample at the beginning of the reported time may be rounded
static const double PATH_ROUNDED = 1e-12;

// Of the reported time alone: what is before may be far larger.
static PathCurve path_take(const RunReport *report, const Trajectory *run, const PlotPath *path)
{
    const Vec2 unknown = {NAN, NAN};
    const double from_s = run->report_from_s - PATH_ROUNDED;
    JointMarks marks = marks_of(run, path);
    PathCurve curve = path_create(run->sample_count + marks.count * MARKS_MOST);
    for (size_t i = 0; i < run->sample_count; i++) {
        const ContactMark *mark;
        while ((mark = next_mark(&marks, run->times[i])) != NULL) {
            if (mark->time_s >= from_s) {
                path_add(&curve, mark->time_s, path->at_mark(run, mark, path), unknown);
            }
        }
        if (run->times[i] >= from_s) {
            path_add(&curve, run->times[i], path->at(report, run, i, path),
                     path->rate != NULL ? path->rate(report, run, i, path) : unknown);
        }
    }
    return curve;
}

// Gives the places of an unknown rate one.
static void path_settle(const PathCurve *curve, const double *values, double *rates)
{
    if (curve->count < 2) {
        return;
    }
    double *slopes = zeroed(curve->count, sizeof *slopes);
    limit_slopes(curve->count, curve->times, values, slopes);
    for (size_t i = 0; i < curve->count; i++) {
        rates[i] = isfinite(rates[i]) ? rates[i] : slopes[i];
    }
    free(slopes);
}

void plot_look_places(const RunReport *report, const Trajectory *run, const PlotPath *path,
                      PlotPathSee *see, void *context)
{
    const PathCurve curve = path_take(report, run, path);
    for (size_t i = 0; i < curve.count; i++) {
        see(context, (Vec2){curve.x[i], curve.y[i]});
    }
    free(curve.times);
}

static const double PATH_STEP = 4.0; // pixels that a piece of a path may go straight
enum { PATH_PIECES_MOST = 24 };      // between two samples

// Into how many straight pieces the path from a sample to the next is divided.
static size_t count_pieces(const PlotPanel *panel, const PathCurve *curve, size_t sample)
{
    const double width = curve->times[sample + 1] - curve->times[sample];
    const double far_x = plot_x(panel, curve->x[sample + 1]) - plot_x(panel, curve->x[sample]);
    const double far_y = plot_y(panel, curve->y[sample + 1]) - plot_y(panel, curve->y[sample]);
    double way = hypot(far_x, far_y);
    for (size_t i = sample; i <= sample + 1; i++) {
        // a path that comes back has its way in its rates
        const double x = plot_x(panel, curve->x_rate[i] * width) - plot_x(panel, 0.0);
        const double y = plot_y(panel, curve->y_rate[i] * width) - plot_y(panel, 0.0);
        way = fmax(way, hypot(x, y));
    }
    return (size_t)fmin(fmax(ceil(way / PATH_STEP), 1.0), PATH_PIECES_MOST);
}

static double between(const PathCurve *curve, const double *values, const double *rates,
                      size_t sample, double time_s)
{
    const Hermite hermite = hermite_fit(2, curve->times + sample, values + sample, rates + sample);
    return hermite_at(&hermite, time_s).value;
}

static const double PATH_NEAR = 1.0; // pixels; what moves less than that from a point is left out

// A line that is drawn through some of its points.
typedef struct PathLine {
    const PlotPanel *panel;
    size_t count;
    double *x; // owned, with y
    double *y;
} PathLine;

static void add_point(PathLine *line, double x, double y, bool is_last)
{
    const size_t before = line->count > 0 ? line->count - 1 : 0;
    const double far_x = fabs(plot_x(line->panel, x) - plot_x(line->panel, line->x[before]));
    const double far_y = fabs(plot_y(line->panel, y) - plot_y(line->panel, line->y[before]));
    if (line->count == 0 || is_last || far_x > PATH_NEAR || far_y > PATH_NEAR) {
        line->x[line->count] = x;
        line->y[line->count++] = y;
    }
}

static void draw_curve(const PlotPanel *panel, const PathCurve *curve, bool is_straight,
                       PlotStyle style)
{
    const size_t room = curve->count * PATH_PIECES_MOST + 1;
    double *all = zeroed(2 * room, sizeof *all);
    PathLine line = {panel, 0, all, all + room};
    for (size_t i = 0; i < curve->count; i++) {
        const bool is_last = i + 1 == curve->count;
        add_point(&line, curve->x[i], curve->y[i], is_last);
        const size_t pieces = is_last || is_straight ? 1 : count_pieces(panel, curve, i);
        for (size_t k = 1; k < pieces; k++) {
            const double share = (double)k / (double)pieces;
            const double time_s = curve->times[i] + share * (curve->times[i + 1] - curve->times[i]);
            add_point(&line, between(curve, curve->x, curve->x_rate, i, time_s),
                      between(curve, curve->y, curve->y_rate, i, time_s), false);
        }
    }
    plot_line(panel, line.count, line.x, line.y, style);
    free(all);
}

void plot_look_path(const PlotView *view, const PlotPanel *panel, size_t run, const PlotPath *path)
{
    PlotStyle style = plot_look_style(view, run, plot_look_colour(view, true, path->joint));
    // a path is no band: wide lines would run into each other
    style.width = fmin(style.width, 1.0);
    style.opacity = fmax(style.opacity, 0.8);
    style.dash = path->end == 0 ? NULL : "3 2";
    const PathCurve curve = path_take(view->report, view->report->runs[run], path);
    path_settle(&curve, curve.x, curve.x_rate);
    path_settle(&curve, curve.y, curve.y_rate);
    draw_curve(panel, &curve, path->is_straight, style);
    free(curve.times);
}
