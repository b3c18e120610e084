// Which bodies and joints does a picture draw?
//
// All of them, up to some twenty: more lines cannot be told apart. Of more those that most happens
// to, in any of the runs.
#include "commands/run/plot_view.h"

#include "base/zeroed.h"
#include "commands/run/slide_range.h"

#include <math.h>

enum { DRAWN_MOST = 24, DRAWN_OF_MANY = 12 };

const PlotSet *plot_view_set(const PlotView *view, bool is_joint)
{
    return is_joint ? &view->joints : &view->bodies;
}

// Does any body turn by more than rounding? A body without friction in a round hole does not, and
// its angular velocity would be a picture of noise. Its energy of rotation is held against its
// energy of translation: speeds that differ by 1e-10 are rounding over many steps.
static bool any_turns(const RunReport *report)
{
    const double turning = 1e-10 * 1e-10;
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        for (size_t body = 0; run->is_complete && body < run->body_count; body++) {
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
static void choose(const PlotView *view, bool is_joint, Ranked *ranked, size_t count)
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

static void set_free(PlotSet *set)
{
    free(set->is_shown);
    free(set->is_other);
    free(set->is_left_out);
    free(set->is_named);
    free(set->of_palette);
}

// Takes out of those that are shown or named what is left out. Colours go by the order of the case,
// from the one given on.
static void settle(PlotSet *set, size_t count, unsigned first_colour)
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

static void choose_bodies(PlotView *view)
{
    const Linkage *linkage = &view->report->scenario->linkage;
    Ranked *ranked = zeroed(linkage->body_count, sizeof *ranked);
    size_t count = 0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        view->bodies.is_shown[i] = (int)i != linkage_driven_body(linkage);
        if (view->bodies.is_shown[i]) {
            ranked[count++].number = i;
        }
    }
    choose(view, false, ranked, count);
    free(ranked);
    settle(&view->bodies, linkage->body_count, 0);
}

// Of each kind by itself, since there are panels for some kinds alone.
static void choose_joints(PlotView *view)
{
    const Scenario *scenario = view->report->scenario;
    const Linkage *linkage = &scenario->linkage;
    const bool has_clearance = scenario_has_clearance(scenario);
    Ranked *ranked = zeroed(linkage->joint_count, sizeof *ranked);
    for (JointKind kind = 0; kind <= JOINT_GEAR; kind++) {
        size_t count = 0;
        for (size_t i = 0; i < linkage->joint_count; i++) {
            if (linkage->joints[i].kind == kind) {
                ranked[count++].number = i;
                view->joints.is_shown[i] = !has_clearance || linkage_has_play(&linkage->joints[i]);
                view->joints.is_named[i] = slide_range_has(&linkage->joints[i]);
            }
        }
        choose(view, true, ranked, count);
    }
    free(ranked);
    settle(&view->joints, linkage->joint_count, (unsigned)view->bodies.drawn);
}

PlotView plot_view_begin(const RunReport *report)
{
    const Linkage *linkage = &report->scenario->linkage;
    PlotView view = {
        .report = report,
        .turns = linkage->driver.is_present || !space_has_plane(linkage) || any_turns(report),
        .bodies = set_create(linkage->body_count),
        .joints = set_create(linkage->joint_count),
    };
    choose_bodies(&view);
    choose_joints(&view);
    return view;
}

void plot_view_finish(PlotView *view)
{
    set_free(&view->bodies);
    set_free(&view->joints);
    *view = (PlotView){.report = NULL};
}
