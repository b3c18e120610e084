// Does friction hold, slide and lose what it must, in ideal joints and those with play?
//
// The truths are closed forms, the published motion of LuGre's block (values of the model's own
// equations by others, to nine digits), and integrations by equations of their own (rubbing.h).
// Each has a control that must be missed.
#include "complete_run.h"
#include "load_case.h"
#include "rubbing.h"
#include "sample.h"

#include "base/lcg.h"
#include "run/drive_torque.h"

#include <stdio.h>
#include <string.h>

static const double G = 9.80665;

static Scenario case_of(const char *text)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("case.yaml", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

static Trajectory *run_text(const char *text)
{
    const Scenario scenario = case_of(text);
    return complete_run(&scenario, BACKEND_REFERENCE);
}

static const Motion *motion_at_end(const Trajectory *run, size_t body)
{
    return &run->motions[(run->sample_count - 1) * run->body_count + body];
}

enum { TEXT_SIZE = 4096 };

// A block on a slope of 20 degrees, at rest.
static double block_slides(double friction, const char *law)
{
    char text[TEXT_SIZE];
    snprintf(text, sizeof text,
             "bodies:\n  block: {mass: 1 kg, inertia: 0.02 kg m^2, at: [0 m, 0 m]}\n"
             "joints:\n  line: {between: [ground, block], at: [0 m, 0 m], along: 20 deg, friction: "
             "%.17g, friction-law: %s}\n"
             "gravity: 9.80665 m/s^2\nrun: {duration: 10 s, samples: 10, backends: [reference]}\n",
             friction, law);
    Trajectory *run = run_text(text);
    const double slid = vec2_length(motion_at_end(run, 0)->position);
    trajectory_destroy(run);
    return slid;
}

static void a_block_holds_on_a_slope_up_to_its_friction(void **state)
{
    (void)state;
    const double slope = 20.0 * M_PI / 180.0;
    const double least = tan(slope);
    assert_near(block_slides(least * (1.0 + 1e-6), "stick"), 0.0, 5e-6);
    // beyond, it falls by what is left
    const double below = 0.5 * G * (sin(slope) - least * (1.0 - 1e-6) * cos(slope)) * 100.0;
    assert_near(block_slides(least * (1.0 - 1e-6), "stick"), below, 1e-12);
    // regularized friction creeps: by v_s atanh(tan / mu)
    assert_near(block_slides(1.5 * least, "regularized"), 10.0 * 5e-3 * atanh(1.0 / 1.5), 1e-4);
}

static double lever_turns(double arm, const char *law)
{
    char text[TEXT_SIZE];
    snprintf(text, sizeof text,
             "bodies:\n  lever: {mass: 1 kg, inertia: 0.02 kg m^2, at: [%.17g m, 0 m]}\n"
             "joints:\n  pin: {between: [ground, lever], at: [0 m, 0 m], friction: 0.3, "
             "friction-radius: 100 mm, friction-law: %s}\n"
             "gravity: 9.80665 m/s^2\nrun: {duration: 10 s, samples: 10, backends: [reference]}\n",
             arm, law);
    Trajectory *run = run_text(text);
    const double turned = fabs(motion_at_end(run, 0)->angle);
    trajectory_destroy(run);
    return turned;
}

static void a_lever_holds_inside_the_friction_circle(void **state)
{
    (void)state;
    const double circle = 0.3 * 0.1;
    const double presliding = 5e-6 / 0.1;
    assert_true(lever_turns(circle * (1.0 - 1e-6), "stick") < presliding);
    assert_true(lever_turns(-circle * (1.0 - 1e-6), "stick") < presliding);
    assert_true(lever_turns(circle * (1.0 + 1e-6), "stick") > 10.0 * presliding);
    assert_true(lever_turns(0.7 * circle, "regularized") > 1e3 * presliding);
}

// A pendulum that is let go from the horizontal, under a friction torque: in each swing it loses
// that times the way, and stops where its weight does not turn it any more. The angle counts from
// straight down.
static double rest_of_pendulum(double weight_arm, double torque)
{
    double from = 0.5 * M_PI;
    for (int swing = 0; swing < 1000; swing++) {
        if (weight_arm * fabs(sin(from)) <= torque) {
            return from;
        }
        // W cos(to) - W cos(from) = +-M (from - to), beyond the angle of equal torques
        const double sign = from > 0.0 ? 1.0 : -1.0;
        double low = -fabs(from);
        double high = asin(torque / weight_arm);
        for (int i = 0; i < 200; i++) {
            const double middle = 0.5 * (low + high);
            const double left =
                weight_arm * (cos(middle) - cos(fabs(from))) - torque * (fabs(from) - middle);
            *(left > 0.0 ? &high : &low) = middle;
        }
        from = sign * 0.5 * (low + high);
    }
    return NAN;
}

static void a_pendulum_stops_at_the_angle_of_the_closed_form(void **state)
{
    (void)state;
    static const double TORQUES[] = {0.1, 0.3, 0.7};
    for (size_t i = 0; i < sizeof TORQUES / sizeof *TORQUES; i++) {
        char text[TEXT_SIZE];
        snprintf(
            text, sizeof text,
            "bodies:\n  rod: {mass: 1 kg, inertia: 0.02 kg m^2, at: [0.3 m, 0 m]}\n"
            "joints:\n  pin: {between: [ground, rod], at: [0 m, 0 m], friction-torque: %.17g N "
            "m, friction-law: stick}\ngravity: 9.80665 m/s^2\n"
            "run: {duration: 40 s, samples: 10, backends: [reference]}\n",
            TORQUES[i]);
        Trajectory *run = run_text(text);
        const double angle = motion_at_end(run, 0)->angle + 0.5 * M_PI;
        const double truth = rest_of_pendulum(0.3 * G, TORQUES[i]);
        // a bend of 5 um at 10 mm to either side in every swing
        const double bend = 5e-6 / 1e-2;
        assert_near(angle, truth, 2.0 * bend);
        assert_near(run->energy.drive_work - run->energy.friction - run->energy.change, 0.0, 1e-9);
        // the next torque stops it elsewhere
        assert_true(fabs(angle - rest_of_pendulum(0.3 * G, 1.1 * TORQUES[i])) > 4.0 * bend);
        trajectory_destroy(run);
    }
}

static void friction_without_an_answer_is_refused(void **state)
{
    (void)state;
    static const char FORMAT[] =
        "bodies:\n  rod: {mass: 1 kg, inertia: 0.001 kg m^2, at: [0.3 m, 0 m]}\n"
        "joints:\n  pin: {between: [ground, rod], at: [0 m, 0 m], friction: %.17g, "
        "friction-radius: 500 mm, friction-law: stick}\ngravity: 9.80665 m/s^2\n"
        "run: {duration: 1 s, samples: 10, backends: [reference]}\n";
    // a friction of 1 N m changes the reaction by m l / (I + m l^2)
    const double most = (0.001 + 0.09) / 0.3 / 0.5;
    for (int i = 0; i < 2; i++) {
        char text[TEXT_SIZE];
        snprintf(text, sizeof text, FORMAT, most * (i == 0 ? 1.0 - 1e-9 : 1.0 + 1e-9));
        const Scenario scenario = case_of(text);
        Trajectory *run =
            run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
        assert_int_equal(run->is_complete, i == 0);
        if (i == 1) {
            assert_non_null(strstr(run->message, "friction of joint pin has no single answer"));
            assert_int_equal(run->steps, 0);
        }
        trajectory_destroy(run);
    }
}

// How far the bristle of the first joint is bent where a run ends, m, and when that is, s.
static double bend_at_end(const Scenario *scenario, double duration_s, double *end_s)
{
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    void *state = NULL;
    Err err = {0};
    assert_true(solver->open(scenario, &state, &err));
    do {
        assert_true(solver->step(state, duration_s, &err));
        const StepRecord record = solver->record(state);
        *end_s = solver_reached(&record);
    } while (*end_s < duration_s);
    ContactState states[1][JOINT_PLACES] = {{{0}}};
    solver->contacts(state, states);
    solver->close(state);
    return states[0][JOINT_PLACES - 1].bend;
}

static void lugre_has_its_published_numbers(void **state)
{
    (void)state;
    // M 1 kg pulled by 2 N/m whose end goes at 0.1 m/s; s0 1e5, s1 sqrt(1e5), s2 0.4, Fc 1, Fs 1.5,
    // vs 1 mm/s: a spring to the ground, and a force that grows, are the same
    static const char TEXT[] =
        "bodies:\n  block: {mass: 1 kg, inertia: 1 kg m^2, at: [0 m, 0 m]}\n"
        "joints:\n  line: {between: [ground, block], at: [0 m, 0 m], along: 0 deg, friction-force: "
        "1 N, friction-law: lugre, breakaway-ratio: 1.5, presliding: 15 um, presliding-damping: "
        "0.5, friction-speed: 1 mm/s}\n"
        "springs:\n  s: {between: [ground, block], at-a: [-10 m, 0 m], at-b: [0 m, 0 m], "
        "stiffness: 2 N/m, length: 10 m, damping: 0.4 N s/m}\n"
        "loads:\n  pull: {body: block, force: [[0 s, 0 N], [25 s, 5 N]]}\n"
        "gravity: 0 m/s^2\nrun: {duration: 25 s, samples: 25000, backends: [reference]}\n"
        "reference: {tolerance: 3e-14}\n";
    static const double SLIPS[] = {7.45801467, 13.82073449, 20.18345431};
    Trajectory *run = run_text(TEXT);
    const Scenario scenario = case_of(TEXT);
    double end_s;
    const double bend = bend_at_end(&scenario, 25.0, &end_s);
    assert_near(end_s, 25.0, 1e-12);
    assert_near(bend, 1.18167955e-5, 1e-13);
    assert_near(motion_at_end(run, 0)->position.x, 1.90883920, 1e-8);
    assert_near(motion_at_end(run, 0)->velocity.x, 9.42415459e-6, 1e-14);
    size_t slips = 0;
    for (size_t i = 1; i < run->sample_count; i++) {
        const double before = run->motions[i - 1].velocity.x;
        const double after = run->motions[i].velocity.x;
        if (before < 0.01 && after >= 0.01) {
            const double share = (0.01 - before) / (after - before);
            assert_true(slips < 3);
            // between samples of 1 ms, by a chord
            assert_near(run->times[i - 1] + share * 1e-3, SLIPS[slips++], 1e-4);
        }
    }
    assert_int_equal(slips, 3);
    trajectory_destroy(run);
}

// A lever whose hole of 100.1 mm hangs on a pin of 100 mm, with friction 0.3: how far it turns in
// the second half of 2 s, and what its energy is short of.
typedef struct HungLever {
    double turned;
    double unbalanced;
} HungLever;

static HungLever hung_lever(double arm, const char *law)
{
    char text[TEXT_SIZE];
    snprintf(text, sizeof text,
             "bodies:\n  lever: {mass: 1 kg, inertia: 0.002 kg m^2, at: [%.17g m, 0 m]}\n"
             "joints:\n  pin: {between: [lever, ground], at: [0 m, 0 m], hole: 100.1 mm, pin: 100 "
             "mm, friction: 0.3, friction-law: %s}\n"
             "contact: {stiffness: 1e7 N/m, damping: exact, restitution: 0.3}\n"
             "gravity: 9.80665 m/s^2\nrun: {duration: 2 s, samples: 200, backends: [reference]}\n",
             arm, law);
    Trajectory *run = run_text(text);
    const HungLever lever = {
        .turned = fabs(motion_at_end(run, 0)->angle - run->motions[100].angle),
        .unbalanced = fabs(run->energy.residual),
    };
    trajectory_destroy(run);
    return lever;
}

static void a_pin_with_play_holds_inside_its_friction_circle(void **state)
{
    (void)state;
    // the force is at the friction angle where it touches the pin
    const double circle = 0.05 * sin(atan(0.3));
    const double presliding = 5e-6 / 0.05;
    for (int side = -1; side <= 1; side += 2) {
        const HungLever holds = hung_lever(0.995 * side * circle, "stick");
        const HungLever slips = hung_lever(1.005 * side * circle, "stick");
        assert_true(holds.turned < presliding);
        assert_true(slips.turned > 100.0 * presliding);
        assert_near(holds.unbalanced, 0.0, 1e-12);
        assert_near(slips.unbalanced, 0.0, 1e-12);
    }
    // regularized friction creeps by v_s
    assert_true(hung_lever(0.5 * circle, "regularized").turned > 100.0 * presliding);
}

// Two rods whose pivots rub, in ODE: the largest error of a speed in half a second.
static double rods_error(const char *stepping, const char *map, const char *law, double step_s)
{
    char text[TEXT_SIZE];
    snprintf(
        text, sizeof text,
        "bodies:\n  one: {mass: 1 kg, inertia: 0.02 kg m^2, at: [0.3 m, 0 m]}\n"
        "  two: {mass: 0.5 kg, inertia: 0.01 kg m^2, at: [0.8 m, 0 m]}\n"
        "joints:\n  pin: {between: [ground, one], at: [0 m, 0 m], friction: 0.2, "
        "friction-radius: 20 mm, %s}\n  elbow: {between: [one, two], at: [0.6 m, 0 m], "
        "friction: 0.2, friction-radius: 20 mm, %s}\n"
        "gravity: 9.80665 m/s^2\nrun: {duration: 0.5 s, samples: 100, step: %.17g s, backends: "
        "[reference, ode]}\node: {stepping: %s, map: %s}\n",
        law, law, step_s, stepping, map);
    const Scenario scenario = case_of(text);
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    double error = 0.0;
    for (size_t i = 0; i < run->sample_count * run->body_count; i++) {
        error = fmax(error, fabs(run->motions[i].omega - truth->motions[i].omega));
    }
    assert_near(run->energy.friction, truth->energy.friction, 2e-4);
    trajectory_destroy(truth);
    trajectory_destroy(run);
    return error;
}

static void pivots_rub_in_ode_with_order_two(void **state)
{
    (void)state;
    static const char SMOOTH[] = "friction-speed: 50 mm/s";
    static const char STICKS[] = "friction-law: stick, presliding: 0.0001 um";
    const double step_s = 5e-4;
    const double smooth = rods_error("staggered", "midpoint", SMOOTH, step_s);
    const double sticks = rods_error("staggered", "midpoint", STICKS, step_s);
    assert_true(smooth < 4e-4 && sticks < 4e-4); // rad/s
    assert_true(rods_error("staggered", "midpoint", SMOOTH, 0.5 * step_s) < smooth / 3.5);
    assert_true(rods_error("staggered", "midpoint", STICKS, 0.5 * step_s) < sticks / 2.5);
    const double plain = rods_error("plain", "midpoint", SMOOTH, step_s);
    const double halved = rods_error("plain", "midpoint", SMOOTH, 0.5 * step_s);
    assert_true(halved < plain / 1.7 && halved > plain / 3.0); // the control: order one
    // within the step: friction needs no guess of what presses
    const double within = rods_error("staggered", "impulse", STICKS, step_s);
    const double finer = rods_error("staggered", "impulse", STICKS, 0.5 * step_s);
    print_message("within the step %.2g and %.2g, by rows %.2g\n", within, finer, sticks);
    assert_true(within < 0.5 * sticks && finer < within / 3.5);
}

static void a_drive_turns_against_friction(void **state)
{
    (void)state;
    static const char TEXT[] =
        "bodies:\n  crank: {mass: 0.5 kg, inertia: 0.001 kg m^2, at: [50 mm, 0 mm]}\n"
        "  coupler: {mass: 0.7 kg, inertia: 0.01 kg m^2, at: [165 mm, 122 mm]}\n"
        "  rocker: {mass: 0.8 kg, inertia: 0.01 kg m^2, at: [265 mm, 122 mm]}\n"
        "joints:\n"
        "  a: {between: [ground, crank], at: [0 m, 0 m], friction: 0.2, friction-radius: 10 mm}\n"
        "  b: {between: [crank, coupler], at: [100 mm, 0 m], friction-torque: 0.01 N m}\n"
        "  c: {between: [coupler, rocker], at: [230 mm, 244 mm], friction: 0.2, friction-radius: "
        "10 mm}\n  d: {between: [ground, rocker], at: [300 mm, 0 m]}\n"
        "drive: {joint: a, speed: 100 rpm}\n"
        "run: {revolutions: 1, samples: 2000, step: 100 us, backends: [reference, ode]}\n"
        "ode: {stepping: staggered}\n";
    const Scenario scenario = case_of(TEXT);
    static const BackendKind BACKENDS[] = {BACKEND_REFERENCE, BACKEND_ODE};
    for (size_t i = 0; i < 2; i++) {
        Trajectory *run = complete_run(&scenario, BACKENDS[i]);
        double work = 0.0; // of the torque by Euler's law
        for (size_t k = 0; k + 1 < run->sample_count; k++) {
            const double mean = 0.5 * (drive_torque_at(&scenario, run, 0, k) +
                                       drive_torque_at(&scenario, run, 0, k + 1));
            work += mean * scenario.linkage.driver.speed * (run->times[k + 1] - run->times[k]);
        }
        // a whole turn
        assert_near(run->energy.drive_work, run->energy.friction, 1e-5 * run->energy.friction);
        // ODE's forces change within the step, but in the first one
        const double share = BACKENDS[i] == BACKEND_REFERENCE ? 1e-6 : 1e-4;
        assert_close(work, run->energy.friction, share);
        trajectory_destroy(run);
    }
}

static void other_ways_of_ode_refuse_friction(void **state)
{
    (void)state;
    // as compare has them, which asks no case file
    Scenario scenario = load("cases/mechanisms/friction-circle.yaml", NULL, 0);
    scenario.run.step = 1e-4;
    for (int stepping = 0; stepping < ODE_STEPPING_COUNT; stepping++) {
        scenario.ode.stepping = (OdeStepping)stepping;
        Trajectory *run =
            run_scenario(&scenario, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
        const bool is_known = stepping == ODE_PLAIN || stepping == ODE_STAGGERED;
        assert_int_equal(run->is_complete, is_known);
        assert_true(is_known || strstr(run->message, "ODE does not know the friction of joint "
                                                     "left-pin") != NULL);
        trajectory_destroy(run);
    }
}

// Random mechanisms.

typedef struct Draw {
    char bodies[TEXT_SIZE / 2];
    char joints[TEXT_SIZE / 2];
    Rubbing truth;
    uint64_t seed;
} Draw;

static double between(Draw *draw, double low, double high)
{
    return low + (high - low) * 0.5 * (1.0 + lcg_draw(&draw->seed));
}

static int add_body(Draw *draw, double x, double y, const double velocity[3])
{
    const int number = draw->truth.body_count++;
    RubbingBody *body = &draw->truth.bodies[number];
    *body = (RubbingBody){
        .mass = between(draw, 0.3, 2.0),
        .inertia = between(draw, 0.005, 0.03),
        .q = {x, y, 0.0},
    };
    const size_t used = strlen(draw->bodies);
    snprintf(draw->bodies + used, sizeof draw->bodies - used,
             "  b%d: {mass: %.17g kg, inertia: %.17g kg m^2, at: [%.17g m, %.17g m]", number,
             body->mass, body->inertia, x, y);
    if (velocity != NULL) {
        memcpy(body->v, velocity, sizeof body->v);
        const size_t more = strlen(draw->bodies);
        snprintf(draw->bodies + more, sizeof draw->bodies - more,
                 ", velocity: [%.17g m/s, %.17g m/s], spin: %.17g rad/s", velocity[0], velocity[1],
                 velocity[2]);
    }
    strcat(draw->bodies, "}\n");
    return number;
}

static RubbingJoint *add_joint(Draw *draw, int a, int b, double x, double y, bool slides)
{
    const int number = draw->truth.joint_count++;
    RubbingJoint *joint = &draw->truth.joints[number];
    const double *centre_b = draw->truth.bodies[b].q;
    *joint = (RubbingJoint){
        .slides = slides,
        .a = a,
        .b = b,
        .at_a = {x, y},
        .at_b = {x - centre_b[0], y - centre_b[1]},
        .mu = between(draw, 0.05, 0.25),
        .ratio = between(draw, 0.0, 1.0) < 0.5 ? 1.0 : between(draw, 1.05, 1.5),
        .zeta = between(draw, 0.3, 1.2),
    };
    if (a >= 0) {
        joint->at_a[0] -= draw->truth.bodies[a].q[0];
        joint->at_a[1] -= draw->truth.bodies[a].q[1];
    }
    const double presliding = between(draw, 20e-6, 60e-6);
    const double speed = between(draw, 0.01, 0.1);
    char first[16] = "ground";
    if (a >= 0) {
        snprintf(first, sizeof first, "b%d", a);
    }
    size_t used = strlen(draw->joints);
    snprintf(draw->joints + used, sizeof draw->joints - used,
             "  j%d: {between: [%s, b%d], at: [%.17g m, %.17g m], friction: %.17g, friction-law: "
             "stick, presliding: %.17g m, presliding-damping: %.17g",
             number, first, b, x, y, joint->mu, presliding, joint->zeta);
    used = strlen(draw->joints);
    if (joint->ratio > 1.0) {
        snprintf(draw->joints + used, sizeof draw->joints - used,
                 ", breakaway-ratio: %.17g, friction-speed: %.17g m/s", joint->ratio, speed);
        used = strlen(draw->joints);
    }
    double reach = 1.0;
    if (slides) {
        joint->along = between(draw, -1.0, 1.0);
        joint->length = between(draw, 0.0, 1.0) < 0.3 ? 0.0 : between(draw, 0.1, 0.4);
        snprintf(draw->joints + used, sizeof draw->joints - used, ", along: %.17g rad",
                 joint->along);
        used = strlen(draw->joints);
        if (joint->length > 0.0) {
            snprintf(draw->joints + used, sizeof draw->joints - used, ", friction-length: %.17g m",
                     joint->length);
        }
    } else {
        reach = joint->radius = between(draw, 5e-3, 30e-3);
        snprintf(draw->joints + used, sizeof draw->joints - used, ", friction-radius: %.17g m",
                 joint->radius);
    }
    joint->bend = presliding / reach;
    joint->speed = speed / reach;
    strcat(draw->joints, "}\n");
    return joint;
}

// A body that hangs on another or the ground by a pivot, turning.
static void add_pendulum(Draw *draw, int a, double x, double y, const double carried[2])
{
    const double arm[2] = {between(draw, 0.1, 0.4), between(draw, -0.4, 0.1)};
    const double omega = between(draw, 1.0, 8.0);
    const double velocity[3] = {carried[0] - omega * arm[1], carried[1] + omega * arm[0], omega};
    const int b = add_body(draw, x + arm[0], y + arm[1], velocity);
    add_joint(draw, a, b, x, y, false);
}

static void draw_sliding(Draw *draw, double velocity[3])
{
    velocity[0] = velocity[1] = velocity[2] = 0.0;
    const int b = add_body(draw, 0.0, 0.0, velocity);
    RubbingJoint *joint =
        add_joint(draw, -1, b, between(draw, -0.05, 0.05), between(draw, -0.05, 0.05), true);
    const double speed = between(draw, 0.5, 2.0);
    velocity[0] = speed * cos(joint->along);
    velocity[1] = speed * sin(joint->along);
    RubbingBody *body = &draw->truth.bodies[b];
    memcpy(body->v, velocity, sizeof body->v);
    snprintf(draw->bodies, sizeof draw->bodies,
             "  b%d: {mass: %.17g kg, inertia: %.17g kg m^2, at: [0 m, 0 m], velocity: [%.17g m/s, "
             "%.17g m/s]}\n",
             b, body->mass, body->inertia, velocity[0], velocity[1]);
}

// A crank that is driven, with a coupler and a rocker.
static double draw_four_bar(Draw *draw)
{
    const double crank = between(draw, 0.05, 0.1);
    const double ground = between(draw, 0.25, 0.3);
    const double phi = between(draw, 0.0, 6.0);
    const double pin[2] = {crank * cos(phi), crank * sin(phi)};
    const double knee[2] = {between(draw, 0.2, 0.25), between(draw, 0.2, 0.25)};
    const double speed = between(draw, 5.0, 15.0);
    const int first = add_body(draw, 0.5 * pin[0], 0.5 * pin[1], NULL);
    const int second = add_body(draw, 0.5 * (pin[0] + knee[0]), 0.5 * (pin[1] + knee[1]), NULL);
    const int third = add_body(draw, 0.5 * (ground + knee[0]), 0.5 * knee[1], NULL);
    RubbingJoint *driven = add_joint(draw, -1, first, 0.0, 0.0, false);
    driven->is_driven = true;
    driven->drive = speed;
    add_joint(draw, first, second, pin[0], pin[1], false);
    add_joint(draw, second, third, knee[0], knee[1], false);
    add_joint(draw, -1, third, ground, 0.0, false);
    return speed;
}

static const double RANDOM_S = 0.6;

// Runs one against its truth; with a share that its first friction is off by.
static double random_error(unsigned number, double off, int *events, double *unbalanced)
{
    static const double STILL[2] = {0.0, 0.0};
    Draw draw = {.seed = lcg_stirred(number), .truth = {.gravity = G}};
    double velocity[3];
    double speed = 0.0;
    switch (number % 5) {
    case 0:
        add_pendulum(&draw, -1, 0.0, 0.0, STILL);
        break;
    case 1:
        draw_sliding(&draw, velocity);
        break;
    case 2:
        add_pendulum(&draw, -1, 0.0, 0.0, STILL);
        add_pendulum(&draw, 0, 2.0 * draw.truth.bodies[0].q[0], 2.0 * draw.truth.bodies[0].q[1],
                     (double[]){2.0 * draw.truth.bodies[0].v[0], 2.0 * draw.truth.bodies[0].v[1]});
        break;
    case 3:
        speed = draw_four_bar(&draw);
        break;
    default:
        draw_sliding(&draw, velocity);
        add_pendulum(&draw, 0, 0.0, 0.0, velocity);
        break;
    }
    char text[2 * TEXT_SIZE];
    char run_words[256];
    if (speed > 0.0) {
        snprintf(run_words, sizeof run_words,
                 "drive: {joint: j0, speed: %.17g rad/s}\nrun: {revolutions: %.17g, samples: 100, ",
                 speed, speed * RANDOM_S / (2.0 * M_PI));
    } else {
        snprintf(run_words, sizeof run_words, "run: {duration: %.17g s, samples: 100, ", RANDOM_S);
    }
    snprintf(text, sizeof text,
             "bodies:\n%sjoints:\n%sgravity: %.17g m/s^2\n%sbackends: [reference]}\nreference: "
             "{tolerance: 1e-12}\n",
             draw.bodies, draw.joints, G, run_words);
    Trajectory *run = run_text(text);
    const double sample_s = run->times[run->sample_count - 1];
    draw.truth.joints[0].mu *= 1.0 + off;
    rubbing_start(&draw.truth);
    rubbing_run(&draw.truth, sample_s, 1e-4);
    double error = 0.0;
    for (int i = 0; i < draw.truth.body_count; i++) {
        const Motion *motion = motion_at_end(run, (size_t)i);
        const RubbingBody *body = &draw.truth.bodies[i];
        error = fmax(error, fabs(motion->position.x - body->q[0]));
        error = fmax(error, fabs(motion->position.y - body->q[1]));
        error = fmax(error, fabs(motion->velocity.x - body->v[0]));
        error = fmax(error, fabs(motion->velocity.y - body->v[1]));
        error = fmax(error, fabs(motion->omega - body->v[2]));
    }
    // revolutions may end between samples
    rubbing_run(&draw.truth, run->duration_s - sample_s, 1e-4);
    error = fmax(error, fabs(run->energy.friction - draw.truth.lost));
    *events = draw.truth.events;
    *unbalanced = fabs(run->energy.drive_work - run->energy.friction - run->energy.change);
    trajectory_destroy(run);
    return error;
}

static void random_mechanisms_move_as_by_other_equations(void **state)
{
    (void)state;
    const size_t trials = sample_size(20);
    for (size_t i = 0; i < trials; i++) {
        int events;
        double unbalanced;
        const double error =
            random_error((unsigned)(i * sample_stride()), 0.0, &events, &unbalanced);
        print_message("# %zu: error %.3g, %d events, energy %.3g\n", i, error, events, unbalanced);
        assert_true(error <= 1e-7);
        assert_true(unbalanced <= 1e-9);
        assert_true(events > 0);
    }
}

static void another_friction_moves_them_otherwise(void **state)
{
    (void)state;
    for (unsigned i = 0; i < 5; i++) {
        int events;
        double unbalanced;
        assert_true(random_error(i, 1e-4, &events, &unbalanced) > 1e-6);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_holds_on_a_slope_up_to_its_friction),
        cmocka_unit_test(a_lever_holds_inside_the_friction_circle),
        cmocka_unit_test(a_pendulum_stops_at_the_angle_of_the_closed_form),
        cmocka_unit_test(friction_without_an_answer_is_refused),
        cmocka_unit_test(lugre_has_its_published_numbers),
        cmocka_unit_test(a_pin_with_play_holds_inside_its_friction_circle),
        cmocka_unit_test(pivots_rub_in_ode_with_order_two),
        cmocka_unit_test(a_drive_turns_against_friction),
        cmocka_unit_test(other_ways_of_ode_refuse_friction),
        cmocka_unit_test(random_mechanisms_move_as_by_other_equations),
        cmocka_unit_test(another_friction_moves_them_otherwise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
