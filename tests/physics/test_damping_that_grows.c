// Do impacts whose damping grows with the depth end as an integration of another kind says?
//
//     m x'' = -max(0, K x^n + c(x) x'),  c(x) = c s^2 (3 - 2 s), s = min(x / D, 1)
// as MSC Adams' IMPACT. The truth is Gragg's extrapolated midpoint rule in long double, which ends
// its steps where the force has a kink: at D, where it is zero, and at the wall. Seeded impacts.
#include "complete_run.h"

#include "mechanism.h"
#include "sample.h"

#include "base/lcg.h"

#include <math.h>

enum { IMPACTS = 20, COLUMNS = 8, STEPS = 400, BISECTIONS = 70 };

typedef long double Long;

typedef struct Impact {
    double stiffness; // N/m^n
    double exponent;  // 1
    double damper;    // N s/m
    double full;      // m
    double mass;      // kg
    double speed;     // m/s
} Impact;

typedef struct Outcome {
    double restitution; // 1
    double force_max;   // N
    double depth_max;   // m
    double duration_s;  // from wall to wall
} Outcome;

typedef struct Point {
    Long depth;   // m
    Long closing; // m/s
} Point;

// Which formula the damping follows, and whether anything presses.
typedef struct Branch {
    bool is_full;
    bool is_slack;
} Branch;

static Long force_at(const Impact *impact, Branch branch, Point at)
{
    const Long share = branch.is_full ? 1.0L : at.depth / impact->full;
    return impact->stiffness * powl(fmaxl(at.depth, 0.0L), impact->exponent) +
           impact->damper * share * share * (3.0L - 2.0L * share) * at.closing;
}

static Point rates_at(const Impact *impact, Branch branch, Point at)
{
    const Long pressed = branch.is_slack ? 0.0L : force_at(impact, branch, at);
    return (Point){at.closing, -pressed / impact->mass};
}

static Point moved(Point from, Long time_s, Point rates)
{
    return (Point){from.depth + time_s * rates.depth, from.closing + time_s * rates.closing};
}

// Gragg's midpoint rule with 2 k steps, extrapolated in their squares.
static Point step(const Impact *impact, Branch branch, Point from, Long time_s)
{
    Point table[COLUMNS];
    for (int k = 0; k < COLUMNS; k++) {
        const int count = 2 * (k + 1);
        const Long h = time_s / count;
        Point before = from;
        Point now = moved(from, h, rates_at(impact, branch, from));
        for (int i = 1; i < count; i++) {
            const Point next = moved(before, 2.0L * h, rates_at(impact, branch, now));
            before = now;
            now = next;
        }
        const Point last = moved(before, h, rates_at(impact, branch, now));
        table[k] = (Point){0.5L * (now.depth + last.depth), 0.5L * (now.closing + last.closing)};
        for (int j = k - 1; j >= 0; j--) {
            const Long ratio = (Long)(k + 1) * (k + 1) / ((Long)(j + 1) * (j + 1)) - 1.0L;
            table[j].depth = table[j + 1].depth + (table[j + 1].depth - table[j].depth) / ratio;
            table[j].closing =
                table[j + 1].closing + (table[j + 1].closing - table[j].closing) / ratio;
        }
    }
    return table[0];
}

// What changes sign in an impact.
typedef enum Watched { WALL, FULL, FORCE, FORCE_RATE, CLOSING, WATCHED_COUNT } Watched;

static Long watched_at(const Impact *impact, Branch branch, Point at, Watched what)
{
    const Long share = branch.is_full ? 1.0L : at.depth / impact->full;
    const Long slope = branch.is_full ? 0.0L : 6.0L * share * (1.0L - share) / impact->full;
    const Long damper = impact->damper * share * share * (3.0L - 2.0L * share);
    const Long spring =
        impact->exponent * impact->stiffness * powl(fmaxl(at.depth, 0.0L), impact->exponent - 1.0L);
    switch (what) {
    case WALL:
        return at.depth;
    case FULL:
        return at.depth - impact->full;
    case FORCE:
        return force_at(impact, branch, at);
    case FORCE_RATE:
        return (spring + impact->damper * slope * at.closing) * at.closing -
               damper * force_at(impact, branch, at) / impact->mass;
    default:
        return at.closing;
    }
}

// The time within a step at which something changes its sign.
static Long crossing(const Impact *impact, Branch branch, Point from, Long time_s, Watched what)
{
    const bool is_positive =
        watched_at(impact, branch, step(impact, branch, from, time_s), what) > 0.0L;
    Long low = 0.0L;
    Long high = time_s;
    for (int i = 0; i < BISECTIONS; i++) {
        const Long middle = 0.5L * (low + high);
        const Point at = step(impact, branch, from, middle);
        if ((watched_at(impact, branch, at, what) > 0.0L) == is_positive) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}

static void keep_largest(const Impact *impact, Branch branch, Point at, Outcome *outcome)
{
    const Long pressed = branch.is_slack ? 0.0L : force_at(impact, branch, at);
    outcome->depth_max = fmax(outcome->depth_max, (double)at.depth);
    outcome->force_max = fmax(outcome->force_max, (double)pressed);
}

// Passes a step and what is largest in it. Returns whether the branch or the contact ends with it,
// at the time written.
static bool pass(const Impact *impact, Branch *branch, Point *at, Long *time_s, Outcome *outcome)
{
    const Point end = step(impact, *branch, *at, *time_s);
    Long first_s = INFINITY;
    Watched first = WATCHED_COUNT;
    for (Watched what = WALL; what < WATCHED_COUNT; what++) {
        const bool was = watched_at(impact, *branch, *at, what) > 0.0L;
        const bool is = watched_at(impact, *branch, end, what) > 0.0L;
        const bool counts = what == FULL    ? was == branch->is_full && is != was
                            : what == FORCE ? is == branch->is_slack
                                            : was && !is;
        if (counts) {
            const Long when_s = crossing(impact, *branch, *at, *time_s, what);
            if (what == FORCE_RATE || what == CLOSING) {
                keep_largest(impact, *branch, step(impact, *branch, *at, when_s), outcome);
            } else if (when_s < first_s) {
                first_s = when_s;
                first = what;
            }
        }
    }
    *time_s = fminl(first_s, *time_s);
    *at = step(impact, *branch, *at, *time_s);
    branch->is_full = first == FULL ? !branch->is_full : branch->is_full;
    branch->is_slack = first == FORCE ? !branch->is_slack : branch->is_slack;
    return first == WALL;
}

static Outcome truth_of(const Impact *impact)
{
    Outcome outcome = {.restitution = 0.0};
    Branch branch = {false, false};
    Point at = {0.0L, impact->speed};
    // the power has no series at the wall: steps grow from where it is nothing
    const Long rise_s = powl((impact->exponent + 1.0L) * impact->mass * impact->speed *
                                 impact->speed / (2.0L * impact->stiffness),
                             1.0L / (impact->exponent + 1.0L)) /
                        impact->speed;
    const Long damped_s = impact->mass / fmaxl(impact->damper, 1e-30L);
    const Long longest_s = fminl(rise_s, damped_s) / (STEPS / 8);
    Long time_s = 0.0L;
    for (bool is_over = false; !is_over;) {
        // and shrink to where it is nothing again
        const Long left_s =
            at.closing < 0.0L ? fmaxl(-0.3L * at.depth / at.closing, 1e-9L * rise_s) : INFINITY;
        Long width_s = fminl(fminl(longest_s, left_s), fmaxl(0.3L * time_s, 1e-9L * rise_s));
        is_over = pass(impact, &branch, &at, &width_s, &outcome);
        time_s += width_s;
    }
    outcome.restitution = (double)(-at.closing / impact->speed);
    outcome.duration_s = (double)time_s;
    return outcome;
}

static double drawn(uint64_t *seed, double low, double high)
{
    return low + (high - low) * 0.5 * (lcg_draw(seed) + 1.0);
}

// From hardly damped to hardly any rebound, with full damping from a twentieth of the depth on to
// three times it.
static Impact draw_impact(uint64_t *seed)
{
    Impact impact = {.exponent = drawn(seed, 1.0, 3.0)};
    impact.mass = pow(10.0, drawn(seed, -2.0, 1.0));
    impact.speed = pow(10.0, drawn(seed, -1.3, 0.7));
    const double depth = pow(10.0, drawn(seed, -5.5, -3.0));
    impact.stiffness = 0.5 * (impact.exponent + 1.0) * impact.mass * impact.speed * impact.speed /
                       pow(depth, impact.exponent + 1.0);
    impact.full = depth * pow(10.0, drawn(seed, -1.3, 0.5));
    impact.damper = impact.mass * impact.speed / depth * pow(10.0, drawn(seed, -1.5, 0.5));
    return impact;
}

static const double PLAY = 1e-3; // m

static Scenario scenario_of(const Impact *impact, double duration_s)
{
    Scenario scenario = mechanism_pin(impact->mass, PLAY);
    scenario.linkage.bodies[0].start.velocity.x = impact->speed;
    scenario.contact.stiffness = impact->stiffness;
    scenario.contact.exponent = impact->exponent;
    scenario.contact.damping = DAMPING_STEP;
    scenario.contact.viscous_coefficient = impact->damper;
    scenario.contact.full_damping_depth = impact->full;
    // a little flight behind it, and no way to the other side
    scenario.run.duration = PLAY / impact->speed + duration_s + 0.2 * PLAY / impact->speed;
    scenario.run.samples = 2;
    return scenario;
}

static Outcome run_of(const Scenario *scenario, BackendKind backend)
{
    Trajectory *run = complete_run(scenario, backend);
    const double speed = scenario->linkage.bodies[0].start.velocity.x;
    const JointExtremes *joint = &run->joints[0];
    assert_int_equal(joint->impacts, 1);
    const Outcome outcome = {
        .restitution = -trajectory_motion(run, run->sample_count - 1, 0)->velocity.x / speed,
        .force_max = joint->spikes[0].force_max,
        .depth_max = joint->spikes[0].penetration_max,
        .duration_s = joint->spikes[0].duration_s,
    };
    trajectory_destroy(run);
    return outcome;
}

// The largest relative difference of two outcomes.
static double apart(const Outcome *a, const Outcome *b)
{
    return fmax(
        fmax(fabs(a->restitution - b->restitution), fabs(a->force_max / b->force_max - 1.0)),
        fmax(fabs(a->depth_max / b->depth_max - 1.0), fabs(a->duration_s / b->duration_s - 1.0)));
}

static void the_truth_itself_is_that_of_a_damper_that_is_whole_at_once(void **state)
{
    (void)state;
    // a depth of next to nothing leaves a linear spring and damper, exp(-2 z acos z / sqrt(1 -
    // z^2))
    const double ratio = 0.2;
    const Impact impact = {.stiffness = 1e7,
                           .exponent = 1.0,
                           .damper = 2.0 * ratio * sqrt(1e7 * 0.1),
                           .full = 1e-12,
                           .mass = 0.1,
                           .speed = 0.5};
    const double expected = exp(-2.0 * ratio * acos(ratio) / sqrt(1.0 - ratio * ratio));
    assert_near(truth_of(&impact).restitution, expected, 1e-6);
}

static void twenty_impacts_end_in_the_reference_as_the_truth_says(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(61);
    double worst = 0.0;
    for (size_t i = 0; i < sample_size(IMPACTS); i++) {
        const Impact impact = draw_impact(&seed);
        const Outcome truth = truth_of(&impact);
        const Scenario scenario = scenario_of(&impact, truth.duration_s);
        const Outcome made = run_of(&scenario, BACKEND_REFERENCE);
        const double off = apart(&made, &truth);
        worst = fmax(worst, off);
        if (!(off <= 1e-9)) {
            fail_msg("impact %zu: off by %.3g: e %.12g for %.12g, N %.12g for %.12g, s %.12g for "
                     "%.12g",
                     i, off, made.restitution, truth.restitution, made.force_max, truth.force_max,
                     made.duration_s, truth.duration_s);
        }
        // the control: a damper that is whole at the wall
        Scenario whole = scenario;
        whole.contact.damping = DAMPING_VISCOUS;
        whole.run.duration *= 3.0;
        Trajectory *run = complete_run(&whole, BACKEND_REFERENCE);
        assert_true(fabs(run->joints[0].spikes[0].force_max / truth.force_max - 1.0) > 1e-4);
        trajectory_destroy(run);
    }
    print_message("# reference: off by %.2g at most\n", worst);
}

static void in_ode_twenty_steps_a_contact_do_by_map_impulse(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(61);
    double worst = 0.0;
    for (size_t i = 0; i < sample_size(IMPACTS); i++) {
        const Impact impact = draw_impact(&seed);
        const Outcome truth = truth_of(&impact);
        Scenario scenario = scenario_of(&impact, truth.duration_s);
        scenario.ode.stepping = ODE_STAGGERED;
        scenario.ode.map = ODE_MAP_IMPULSE;
        scenario.run.step = truth.duration_s / 20.0;
        const Outcome made = run_of(&scenario, BACKEND_ODE);
        const double off = apart(&made, &truth);
        worst = fmax(worst, off);
        if (!(off <= 1e-3)) {
            fail_msg("impact %zu: off by %.3g: e %.9g for %.9g, N %.9g for %.9g, s %.9g for %.9g",
                     i, off, made.restitution, truth.restitution, made.force_max, truth.force_max,
                     made.duration_s, truth.duration_s);
        }
    }
    print_message("# ODE: off by %.2g at most\n", worst);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_truth_itself_is_that_of_a_damper_that_is_whole_at_once),
        cmocka_unit_test(twenty_impacts_end_in_the_reference_as_the_truth_says),
        cmocka_unit_test(in_ode_twenty_steps_a_contact_do_by_map_impulse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
