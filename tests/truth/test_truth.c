// Is the truth true? Closed forms of single impacts and swings, conservation laws, and its own
// convergence, all asked for to far more digits than a double has.
#include "close.h"

#include "problems.h"
#include "quad_truth.h"

#include "mechanism.h"

#include <string.h>

// far below a double's rounding, far above quadruple precision's: what a truth must keep
static const double TRUE_SHARE = 1e-20;

static void quad_check(Quad value, Quad truth, Quad tolerance, const char *what, int line)
{
    if (!(fabsq(value - truth) <= tolerance)) {
        char texts[3][64];
        quadmath_snprintf(texts[0], sizeof texts[0], "%.30Qg", value);
        quadmath_snprintf(texts[1], sizeof texts[1], "%.30Qg", truth);
        quadmath_snprintf(texts[2], sizeof texts[2], "%.3Qg", fabsq(value - truth));
        print_error("%s = %s is not %s: off by %s\n", what, texts[0], texts[1], texts[2]);
        _fail(__FILE__, line);
    }
}

// Fails unless value is within a share of the truth.
#define assert_quad(value, truth, share)                                                           \
    quad_check((value), (truth), (share)*fabsq(truth), #value, __LINE__)

static void run_until(const QuadProblem *problem, double tolerance, double time,
                      TruthSample *sample, TruthFigures *figures)
{
    TruthOptions options = truth_options_default();
    options.tolerance = tolerance;
    assert_true(truth_run(problem, &options, 1, &time, sample, figures));
}

// A pin of 0.1 kg flung at the wall of a hole of the ground, 1 m/s along x.
static QuadProblem flung_pin(double clearance, double stiffness, double chi)
{
    Scenario scenario = mechanism_pin(0.1, clearance);
    scenario.contact.stiffness = stiffness;
    scenario.linkage.bodies[0].start.velocity = (Vec2){1.0, 0.0};
    QuadProblem problem = quad_problem(&scenario);
    problem.hysteresis = chi;
    return problem;
}

// An exact power of two, so that its place is known without rounding.
static const double CLEARANCE = 0x1p-14;

static void an_undamped_impact_is_hertz_impact(void **state)
{
    (void)state;
    const QuadProblem problem = flung_pin(CLEARANCE, 6.6e10, 0.0);
    TruthSample pin;
    TruthFigures figures;
    run_until(&problem, 1e-20, 1.5e-4, &pin, &figures);
    assert_int_equal(figures.onsets, 1);
    assert_int_equal(figures.ends, 1);
    assert_quad(figures.onset_s, CLEARANCE, 1e-30);
    // speed given back, and the duration 4/5 sqrt(pi) Gamma(2/5) / Gamma(9/10) d_max / v
    assert_quad(figures.end_speed, 1, TRUE_SHARE);
    const Quad exponent = (Quad)2 / 5;
    const Quad mass = problem.bodies[0].mass;
    const Quad depth = powq(5 * mass / (4 * problem.joints[0].law.stiffness), exponent);
    const Quad shape = 4 * sqrtq(acosq(-1)) * tgammaq(exponent) / (5 * tgammaq((Quad)9 / 10));
    assert_near((double)shape, 2.943275, 1e-6);
    assert_quad(figures.end_s - figures.onset_s, shape * depth, TRUE_SHARE);
    // the deepest point stands half way, where it does not mind the rounding of the time
    run_until(&problem, 1e-20, (double)(figures.onset_s + shape * depth / 2), &pin, NULL);
    assert_quad(pin.x - (Quad)CLEARANCE, depth, TRUE_SHARE);
    // the control: a stiffness that differs in the fourteenth digit is seen
    const QuadProblem other = flung_pin(CLEARANCE, 6.6e10 * (1.0 + 1e-14), 0.0);
    TruthFigures other_figures;
    run_until(&other, 1e-20, 1.5e-4, &pin, &other_figures);
    assert_true(fabsq(other_figures.end_s - figures.end_s) > 1e-15 * depth);
}

// chi (1 + e) - ln((1 + chi) / (1 - chi e)), whose root e is what a damped impact gives back.
static Quad restitution_residual(Quad chi, Quad e)
{
    return chi * (1 + e) - log1pq(chi) + log1pq(-chi * e);
}

static void a_damped_impact_gives_back_what_the_closed_form_says(void **state)
{
    (void)state;
    const double factors[] = {0.1425, 0.634828, 1.432751, 9.998159};
    for (size_t i = 0; i < sizeof factors / sizeof *factors; i++) {
        const QuadProblem problem = flung_pin(CLEARANCE, 6.6e10, factors[i]);
        TruthSample pin;
        TruthFigures figures;
        run_until(&problem, 1e-20, 2e-4, &pin, &figures);
        assert_int_equal(figures.ends, 1);
        const Quad chi = problem.hysteresis;
        const Quad e = figures.end_speed / figures.onset_speed;
        // d/de of the residual turns it into an error of e
        const Quad slope = chi - chi / (1 - chi * e);
        assert_quad(e - restitution_residual(chi, e) / slope, e, TRUE_SHARE);
        // the control: neither the factor nor the impact speed may be off by 1e-12
        QuadProblem other = problem;
        other.impact_speed_share = 1 + (Quad)1e-12;
        run_until(&other, 1e-20, 2e-4, &pin, &figures);
        const Quad wrong = figures.end_speed / figures.onset_speed;
        assert_true(fabsq(restitution_residual(chi, wrong) / slope) > 1e-15);
    }
}

static void a_pin_falls_freely_to_its_wall(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.1, CLEARANCE);
    scenario.gravity = scenario_downward(9.80665);
    scenario.contact.stiffness = 6.6e10;
    const QuadProblem problem = quad_problem(&scenario);
    const double time = 4e-3; // it falls for 3.53 ms
    TruthSample pin;
    TruthFigures figures;
    run_until(&problem, 1e-20, time, &pin, &figures);
    const Quad g = -problem.gravity.y;
    assert_quad(figures.onset_s, sqrtq(2 * (Quad)CLEARANCE / g), 1e-28);
    assert_quad(figures.onset_speed, sqrtq(2 * g * (Quad)CLEARANCE), 1e-28);
    // on its way back it is a stone thrown upwards
    const Quad flown = (Quad)time - figures.end_s;
    assert_true(flown > 0);
    const Quad height = -(Quad)CLEARANCE + flown * (figures.end_speed - g * flown / 2);
    quad_check(pin.y, height, 1e-26 * CLEARANCE, "pin.y", __LINE__);
}

// Two links from the ground: an ideal joint between them, play at the ground. No driver.
static Scenario hanging_links(void)
{
    Scenario scenario = mechanism_pin(0.3, 1e-4);
    Linkage *linkage = &scenario.linkage;
    scenario.gravity = scenario_downward(9.80665);
    scenario.contact.stiffness = 1e9;
    scenario.contact.damping = DAMPING_NONE;
    linkage->bodies[0].inertia = 1e-3;
    linkage->bodies[0].start.position = (Vec2){0.125, 0.0};
    linkage->joints[0].anchor_b = (Vec2){-0.125, 0.0};
    linkage->body_count = 2;
    linkage->bodies[1] = linkage->bodies[0];
    linkage->bodies[1].start.position = (Vec2){0.375, 0.0};
    linkage->joint_count = 2;
    linkage->joints[1] = (Joint){
        .kind = JOINT_REVOLUTE,
        .body_a = 0,
        .body_b = 1,
        .anchor_a = {0.125, 0.0},
        .anchor_b = {-0.125, 0.0},
    };
    return scenario;
}

static void energy_is_kept_without_damping_and_the_ideal_joint_stays_closed(void **state)
{
    (void)state;
    const Scenario scenario = hanging_links();
    QuadProblem problem = quad_problem(&scenario);
    TruthSample bodies[2];
    TruthFigures before;
    TruthFigures after;
    run_until(&problem, 1e-18, 0.0, bodies, &before);
    run_until(&problem, 1e-18, 30e-3, bodies, &after);
    assert_true(after.onsets >= 2);
    // the motion has energies of about 0.1 J
    quad_check(after.energy, before.energy, 0.1 * TRUE_SHARE, "energy, J", __LINE__);
    assert_true(after.drift_max < 1e-20);
    // the control: a trace of damping is seen
    problem.hysteresis = 1e-9;
    run_until(&problem, 1e-18, 30e-3, bodies, &after);
    assert_true(before.energy - after.energy > 1e-15);
}

// A quarter swing of a pendulum let go level takes K(1/2) / omega_0, K by the mean of Gauss.
static void a_pendulum_on_an_ideal_joint_swings_as_the_elliptic_integral_says(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.3, 1e-4);
    scenario.gravity = scenario_downward(9.80665);
    scenario.contact.stiffness = 1e9;
    scenario.linkage.bodies[0].inertia = 1e-3;
    scenario.linkage.bodies[0].start.position = (Vec2){0.125, 0.0};
    scenario.linkage.joints[0].anchor_b = (Vec2){-0.125, 0.0};
    scenario.linkage.joints[0].kind = JOINT_REVOLUTE;
    const QuadProblem problem = quad_problem(&scenario);
    const Quad mass = problem.bodies[0].mass;
    const Quad arm = (Quad)1 / 8;
    const Quad omega_squared =
        mass * -problem.gravity.y * arm / (problem.bodies[0].inertia + mass * arm * arm);
    Quad a = 1;
    Quad b = sqrtq((Quad)1 / 2);
    for (int i = 0; i < 10; i++) {
        const Quad mean = (a + b) / 2;
        b = sqrtq(a * b);
        a = mean;
    }
    const Quad quarter = acosq(-1) / (2 * a) / sqrtq(omega_squared);
    const double time = (double)quarter;
    TruthSample pendulum;
    TruthFigures figures;
    run_until(&problem, 1e-20, time, &pendulum, &figures);
    assert_true(figures.drift_max < 1e-20);
    // at the bottom: no acceleration, speed from the energy; the rounded time is made good
    const Quad speed = -sqrtq(2 * omega_squared);
    assert_quad(pendulum.angle + ((Quad)quarter - (Quad)time) * speed, -acosq(0), TRUE_SHARE);
    assert_quad(pendulum.omega, speed, TRUE_SHARE);
}

// Two bodies that nothing else holds: a hole in one, a pin of the other flung at its wall askew.
static QuadProblem two_free_bodies(double friction)
{
    Scenario scenario = mechanism_pin(0.2, 1e-3);
    Linkage *linkage = &scenario.linkage;
    scenario.contact.stiffness = 1e9;
    scenario.contact.restitution = 0.7;
    scenario.contact.friction = friction;
    scenario.contact.friction_speed = 1e-2;
    linkage->body_count = 2;
    linkage->bodies[1] = linkage->bodies[0];
    linkage->bodies[1].mass = 0.3;
    linkage->bodies[1].start.position = (Vec2){0.01, 0.02};
    linkage->bodies[1].start.velocity = (Vec2){1.0, 0.3};
    linkage->bodies[1].start.omega = 40.0;
    linkage->bodies[0].inertia = 2e-5;
    linkage->bodies[1].inertia = 3e-5;
    linkage->joints[0].body_a = 0;
    linkage->joints[0].body_b = 1;
    linkage->joints[0].anchor_a = (Vec2){0.01, 0.0};
    linkage->joints[0].anchor_b = (Vec2){0.0, -0.02};
    return quad_problem(&scenario);
}

typedef struct Momentum {
    Quad x;
    Quad y;
    Quad angular; // about the origin
} Momentum;

static Momentum momentum_of(const QuadProblem *problem, const TruthSample *samples)
{
    Momentum sum = {0, 0, 0};
    for (size_t i = 0; i < problem->body_count; i++) {
        const TruthSample *s = samples + i;
        const Quad mass = problem->bodies[i].mass;
        sum.x += mass * s->x_rate;
        sum.y += mass * s->y_rate;
        sum.angular +=
            mass * (s->x * s->y_rate - s->y * s->x_rate) + problem->bodies[i].inertia * s->omega;
    }
    return sum;
}

static void friction_keeps_momentum_and_takes_energy(void **state)
{
    (void)state;
    const QuadProblem problem = two_free_bodies(0.3);
    QuadProblem smooth = two_free_bodies(0.0);
    TruthSample start[2];
    TruthSample end[2];
    TruthFigures before;
    TruthFigures after;
    run_until(&problem, 1e-18, 0.0, start, &before);
    run_until(&problem, 1e-18, 5e-3, end, &after);
    assert_true(after.onsets >= 2);
    const Momentum first = momentum_of(&problem, start);
    const Momentum last = momentum_of(&problem, end);
    assert_quad(last.x, first.x, TRUE_SHARE);
    assert_quad(last.y, first.y, TRUE_SHARE);
    assert_quad(last.angular, first.angular, TRUE_SHARE);
    // without damping of the impacts, friction alone takes energy
    smooth.hysteresis = 0;
    run_until(&smooth, 1e-18, 5e-3, end, &after);
    assert_quad(after.energy, before.energy, TRUE_SHARE);
    smooth.friction = problem.friction;
    run_until(&smooth, 1e-18, 5e-3, end, &after);
    assert_true(after.energy < 0.999 * before.energy);
    assert_true(fabsq(end[1].omega - start[1].omega) > 1e-3);
}

// Hole and pin about the centres of mass of their bodies: what turns the one by R f turns the other
// by (R - |e|) f, and |e| is the play and a depth of less than a hundredth of the pin's radius.
static void friction_acts_where_the_wall_is(void **state)
{
    (void)state;
    QuadProblem problem = two_free_bodies(0.3);
    problem.joints[0].law.stiffness *= 1000;
    problem.joints[0].anchor_a = (QuadVec){0, 0};
    problem.joints[0].anchor_b = (QuadVec){0, 0};
    problem.start_position[3] = 0;
    problem.start_position[4] = 0;
    TruthSample start[2];
    TruthSample end[2];
    TruthFigures figures;
    run_until(&problem, 1e-16, 0.0, start, &figures);
    run_until(&problem, 1e-16, 5e-3, end, &figures);
    const QuadJoint *joint = &problem.joints[0];
    const Quad pin_radius = joint->radius_a - joint->clearance;
    assert_true(figures.depth_max < 1e-2 * pin_radius);
    const Quad turn_a = problem.bodies[0].inertia * (end[0].omega - start[0].omega);
    const Quad turn_b = problem.bodies[1].inertia * (end[1].omega - start[1].omega);
    assert_quad(-turn_a / turn_b, joint->radius_a / pin_radius, 1e-2);
    // the control: at one point for both, but not on the wall, it would be another ratio
    assert_true(fabsq(-turn_a / turn_b - 1) > 0.1);
}

// Gravity pulls the pin out of the wall, faster than its damped spring follows.
static void a_force_that_would_pull_is_clamped(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.1, CLEARANCE);
    scenario.gravity = scenario_downward(500.0);
    scenario.contact.stiffness = 1e7;
    scenario.linkage.bodies[0].start.velocity = (Vec2){0.0, 0.26};
    QuadProblem problem = quad_problem(&scenario);
    problem.hysteresis = 10;
    TruthSample coarse;
    TruthSample fine;
    TruthFigures figures;
    run_until(&problem, 1e-15, 1.2e-3, &coarse, NULL);
    run_until(&problem, 1e-20, 1.2e-3, &fine, &figures);
    assert_true(figures.clamps >= 1);
    assert_true(figures.ends >= 1);
    assert_quad(coarse.y_rate, fine.y_rate, 1e-16);
    // beyond v0/chi an unclamped spring would have held it back
    assert_true(figures.end_speed > figures.onset_speed / problem.hysteresis);
}

// Coupler and follower of every problem after its first impacts, by one tolerance after the other.
static void the_truth_converges_far_below_a_double(void **state)
{
    (void)state;
    for (size_t i = 0; i < PROBLEM_COUNT; i++) {
        const Scenario scenario = problem_scenario(&PROBLEMS[i]);
        const QuadProblem problem = quad_problem(&scenario);
        const double tolerances[] = {1e-8, 1e-14, 1e-20};
        TruthSample bodies[3][3];
        for (int k = 0; k < 3; k++) {
            TruthFigures figures;
            run_until(&problem, tolerances[k], 1.1e-3, bodies[k], &figures);
            assert_true(figures.onsets >= 1);
            assert_true(figures.drift_max < (k == 2 ? 1e-28 : 1e-12));
        }
        for (int body = 1; body < 3; body++) {
            const Quad truth = bodies[2][body].omega;
            assert_quad(bodies[1][body].omega, truth, 1e-17);
            // the control: a coarse tolerance is worse
            assert_true(fabsq(bodies[0][body].omega - truth) >
                        fabsq(bodies[1][body].omega - truth));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_undamped_impact_is_hertz_impact),
        cmocka_unit_test(a_damped_impact_gives_back_what_the_closed_form_says),
        cmocka_unit_test(a_pin_falls_freely_to_its_wall),
        cmocka_unit_test(energy_is_kept_without_damping_and_the_ideal_joint_stays_closed),
        cmocka_unit_test(a_pendulum_on_an_ideal_joint_swings_as_the_elliptic_integral_says),
        cmocka_unit_test(friction_keeps_momentum_and_takes_energy),
        cmocka_unit_test(friction_acts_where_the_wall_is),
        cmocka_unit_test(a_force_that_would_pull_is_clamped),
        cmocka_unit_test(the_truth_converges_far_below_a_double),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
