// Do loads, motors and soft drives move a linkage as they must?
//
// The truths are written out here: the forces in a slider-crank by Newton and Euler one body after
// the other, the run-up of a motor by its one equation of motion, a soft drive by the oscillator
// that it is, and the balance of work. Each has a control: with one number changed it must be
// missed.
#include "complete_run.h"
#include "load_case.h"

#include "base/lcg.h"
#include "base/load_table.h"
#include "measure/chosen_run.h"
#include "model/loads.h"
#include "run/drive_torque.h"

#include <stdio.h>

static const double G = 9.80665;

// A slider-crank whose links' centres are at their middles; its slider's line is the x axis.
typedef struct Mechanism {
    double r, l;       // m, crank and rod
    double m1, m2, m3; // kg
    double j1, j2;     // kg m^2, about the centres
} Mechanism;

// Where it stands and how it moves, as functions of the crank's angle: derivatives by it.
typedef struct Geometry {
    double theta[3]; // rad, of the rod
    double x[3];     // m, of the slider
    double cx[3];    // m, of the rod's centre
    double cy[3];
} Geometry;

static Geometry geometry_at(const Mechanism *of, double phi)
{
    const double s = sin(phi);
    const double c = cos(phi);
    Geometry at;
    at.theta[0] = asin(-of->r * s / of->l);
    const double ct = cos(at.theta[0]);
    const double st = sin(at.theta[0]);
    at.theta[1] = -of->r * c / (of->l * ct);
    at.theta[2] = (of->r * s / of->l + st * at.theta[1] * at.theta[1]) / ct;
    at.x[0] = of->r * c + of->l * ct;
    at.x[1] = -of->r * s - of->l * st * at.theta[1];
    at.x[2] = -of->r * c - of->l * (ct * at.theta[1] * at.theta[1] + st * at.theta[2]);
    at.cx[0] = 0.5 * (of->r * c + at.x[0]);
    at.cx[1] = 0.5 * (-of->r * s + at.x[1]);
    at.cx[2] = 0.5 * (-of->r * c + at.x[2]);
    at.cy[0] = 0.5 * of->r * s;
    at.cy[1] = 0.5 * of->r * c;
    at.cy[2] = -0.5 * of->r * s;
    return at;
}

typedef struct Forces {
    Vec2 pivot;    // N, on the crank
    Vec2 pin;      // N, on the rod
    Vec2 wrist;    // N, on the slider
    double guide;  // N, on the slider, along y
    double torque; // N m, on the crank
} Forces;

// The forces at a constant speed, with a load along x on the slider.
static Forces forces_at(const Mechanism *of, double phi, double omega, double load)
{
    const Geometry at = geometry_at(of, phi);
    const double w2 = omega * omega;
    Forces forces;
    forces.wrist.x = of->m3 * w2 * at.x[2] - load;
    forces.pin.x = of->m2 * w2 * at.cx[2] + forces.wrist.x;
    // moments about the rod's centre: pin at -e, wrist at +e
    const Vec2 e = {0.5 * of->l * cos(at.theta[0]), 0.5 * of->l * sin(at.theta[0])};
    const double vertical = of->m2 * (w2 * at.cy[2] + G); // pin.y less wrist.y
    // (-e) x pin - e x wrist = j2 theta'':  -e.x (pin.y + wrist.y) + e.y (pin.x + wrist.x)
    const double sum = (e.y * (forces.pin.x + forces.wrist.x) - of->j2 * w2 * at.theta[2]) / e.x;
    forces.pin.y = 0.5 * (sum + vertical);
    forces.wrist.y = 0.5 * (sum - vertical);
    forces.guide = of->m3 * G - forces.wrist.y;
    const Vec2 arm = {0.5 * of->r * cos(phi), 0.5 * of->r * sin(phi)};
    forces.pivot.x = -of->m1 * w2 * arm.x + forces.pin.x;
    forces.pivot.y = of->m1 * (G - w2 * arm.y) + forces.pin.y;
    forces.torque = of->m1 * G * arm.x + 2.0 * vec2_cross(arm, forces.pin);
    return forces;
}

static const Mechanism COMPRESSOR = {0.04, 0.14, 0.8, 0.35, 0.3, 4e-4, 9e-4};

// Its gas force over the crank's angle, by straight lines.
static double gas_at(double phi)
{
    static const double POINTS[][2] = {{0.0, -3000.0},  {40.0, -1100.0}, {90.0, -500.0},
                                       {180.0, -500.0}, {250.0, -600.0}, {320.0, -1600.0},
                                       {360.0, -3000.0}};
    const double deg = 180.0 / M_PI * phi - 360.0 * floor(phi / (2.0 * M_PI));
    size_t i = 0;
    while (deg >= POINTS[i + 1][0]) {
        i++;
    }
    const double share = (deg - POINTS[i][0]) / (POINTS[i + 1][0] - POINTS[i][0]);
    return POINTS[i][1] + share * (POINTS[i + 1][1] - POINTS[i][1]);
}

#define STRAIGHT "loads.gas.interpolation=linear"

static Scenario ideal_compressor(const char *speed)
{
    const char *const settings[] = {
        STRAIGHT,          speed,          "run.start=centred", "run.revolutions=1",
        "run.samples=720", "run.step=20us"};
    Scenario scenario = load("cases/mechanisms/compressor.yaml", settings, 6);
    scenario.linkage.joints[2].kind = JOINT_REVOLUTE;
    return scenario;
}

// The largest difference of a run's forces and torque from the closed form's, over the largest.
static double forces_error(const Scenario *scenario, const Trajectory *run, double factor)
{
    const double omega = scenario->linkage.driver.speed;
    double largest = 0.0;
    double apart = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        const double phi = omega * run->times[i];
        const Forces at = forces_at(&COMPRESSOR, phi, omega, factor * gas_at(phi));
        const JointState *joints = trajectory_state(run, i, 0);
        // body b of the pivot is the crank, of the pin the rod, of the wrist and guide the slider
        apart = fmax(apart, vec2_length(vec2_sub(joints[0].force_on_b, at.pivot)));
        apart = fmax(apart, vec2_length(vec2_sub(joints[1].force_on_b, at.pin)));
        apart = fmax(apart, vec2_length(vec2_sub(joints[2].force_on_b, at.wrist)));
        apart = fmax(apart, fabs(joints[3].force_on_b.y - at.guide));
        apart = fmax(apart, fabs(drive_torque_at(scenario, run, 0, i) - at.torque) / COMPRESSOR.r);
        largest = fmax(largest, vec2_length(at.pivot));
    }
    return apart / largest;
}

static void a_gas_force_has_the_forces_of_the_closed_form(void **state)
{
    (void)state;
    static const char *const SPEEDS[] = {"drive.speed=1450rpm", "drive.speed=-600rpm"};
    for (size_t i = 0; i < 2; i++) {
        const Scenario scenario = ideal_compressor(SPEEDS[i]);
        const BackendKind backends[] = {BACKEND_ANALYTIC, BACKEND_REFERENCE};
        for (size_t k = 0; k < 2; k++) {
            Trajectory *run = complete_run(&scenario, backends[k]);
            const double error = forces_error(&scenario, run, 1.0);
            print_message("# %s: %.2g\n", run->backend, error);
            assert_true(error < 1e-10);
            assert_true(forces_error(&scenario, run, 1.0 + 1e-9) > 1e-10);
            assert_true(fabs(run->energy.residual) < 1e-11 * fabs(run->energy.load_work));
            trajectory_destroy(run);
        }
        // whose accelerations belong to the samples; the force bends at its points
        Scenario smooth = scenario;
        smooth.ode.stepping = ODE_EXTRAPOLATED;
        Trajectory *run = complete_run(&smooth, BACKEND_ODE);
        print_message("# ode: %.2g\n", forces_error(&scenario, run, 1.0));
        assert_true(forces_error(&scenario, run, 1.0) < 1e-3);
        trajectory_destroy(run);
    }
}

static void work_goes_into_the_gas_and_friction(void **state)
{
    (void)state;
    const char *const settings[] = {"run.revolutions=2"};
    const Scenario scenario = load("cases/mechanisms/compressor.yaml", settings, 1);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const Energy *energy = &run->energy;
    const double given = energy->drive_work + energy->load_work;
    const double lost = energy->dissipated + energy->friction + energy->change;
    assert_true(energy->load_work < 0.0);
    assert_true(fabs(given - lost) < 1e-9 * energy->drive_work);
    // what friction takes is no part of what would be missed
    assert_true(energy->friction > 1e-3 * energy->drive_work);
    trajectory_destroy(run);
}

// The equation of a motor that turns the press: (J + I(phi)) phi'' + I'(phi) phi'^2 / 2 = Q.
typedef struct Press {
    Mechanism of;
    double shaft; // kg m^2, of flywheel and rotor about the shaft
    double stall, no_load;
    double load; // N, constant, on the ram
} Press;

static double angular_acceleration(const Press *press, double phi, double omega)
{
    const Mechanism *of = &press->of;
    const Geometry at = geometry_at(of, phi);
    const double inertia = press->shaft + of->m3 * at.x[1] * at.x[1] +
                           of->m2 * (at.cx[1] * at.cx[1] + at.cy[1] * at.cy[1]) +
                           of->j2 * at.theta[1] * at.theta[1];
    const double half_slope = of->m3 * at.x[1] * at.x[2] +
                              of->m2 * (at.cx[1] * at.cx[2] + at.cy[1] * at.cy[2]) +
                              of->j2 * at.theta[1] * at.theta[2];
    const double torque = press->stall * (1.0 - omega / press->no_load);
    const double push = press->load * at.x[1] - of->m2 * G * at.cy[1];
    return (torque + push - half_slope * omega * omega) / inertia;
}

// The speed after so long from rest, by Runge and Kutta in so many steps.
static double run_up(const Press *press, double duration_s, size_t steps, double *phi)
{
    const double h = duration_s / (double)steps;
    double y[2] = {0.0, 0.0};
    for (size_t n = 0; n < steps; n++) {
        double k[4][2];
        for (int i = 0; i < 4; i++) {
            const double share = i == 0 ? 0.0 : i == 3 ? h : 0.5 * h;
            const double a = y[0] + (i == 0 ? 0.0 : share * k[i - 1][0]);
            const double w = y[1] + (i == 0 ? 0.0 : share * k[i - 1][1]);
            k[i][0] = w;
            k[i][1] = angular_acceleration(press, a, w);
        }
        for (int c = 0; c < 2; c++) {
            y[c] += h / 6.0 * (k[0][c] + 2.0 * k[1][c] + 2.0 * k[2][c] + k[3][c]);
        }
    }
    *phi = y[0];
    return y[1];
}

static double between(uint64_t *seed, double low, double high)
{
    return low + (high - low) * 0.5 * (1.0 + lcg_draw(seed));
}

enum { SETTINGS = 11, SETTING_SIZE = 80 };

// A press of random masses, flywheel, motor and load.
static Scenario random_press(unsigned number, Press *press)
{
    uint64_t draw = lcg_stirred(number);
    static char texts[SETTINGS][SETTING_SIZE];
    const char *settings[SETTINGS];
    *press = (Press){.of = {0.05, 0.2, between(&draw, 1.0, 6.0), between(&draw, 0.2, 2.0),
                            between(&draw, 1.0, 8.0), between(&draw, 0.01, 0.05),
                            between(&draw, 0.001, 0.01)},
                     .stall = between(&draw, 10.0, 60.0),
                     .no_load = between(&draw, 15.0, 50.0),
                     .load = between(&draw, -200.0, 200.0)};
    const double rotor = between(&draw, 0.0, 0.03);
    press->shaft = press->of.j1 + rotor;
    const struct {
        const char *key;
        double value;
        const char *unit;
    } values[SETTINGS] = {
        {"bodies.crank.mass", press->of.m1, "kg"},
        {"bodies.crank.inertia", press->of.j1, "kg m^2"},
        {"bodies.rod.mass", press->of.m2, "kg"},
        {"bodies.rod.inertia", press->of.j2, "kg m^2"},
        {"bodies.ram.mass", press->of.m3, "kg"},
        {"drive.stall-torque", press->stall, "N m"},
        {"drive.no-load-speed", press->no_load, "rad/s"},
        {"drive.rotor-inertia", rotor, "kg m^2"},
        {"loads.press.force", press->load, "N"},
        {"run.duration", 0.5, "s"},
        {"run.step", 50.0, "us"},
    };
    for (size_t i = 0; i < SETTINGS; i++) {
        snprintf(texts[i], SETTING_SIZE, "%s=%.17g %s", values[i].key, values[i].value,
                 values[i].unit);
        settings[i] = texts[i];
    }
    return load("cases/mechanisms/motor-flywheel.yaml", settings, SETTINGS);
}

static void a_motor_runs_up_as_its_one_equation_says(void **state)
{
    (void)state;
    for (unsigned number = 1; number <= 10; number++) {
        Press press;
        const Scenario scenario = random_press(number, &press);
        double phi;
        double rough_phi;
        const double omega = run_up(&press, 0.5, 40000, &phi);
        const double rough = run_up(&press, 0.5, 20000, &rough_phi);
        assert_true(fabs(rough - omega) < 1e-10 * press.no_load); // the truth has converged
        Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
        const Motion *end = trajectory_motion(truth, truth->sample_count - 1, 0);
        const double error = fabs(end->omega - omega) / press.no_load;
        print_message("# press %u: %.2g rad/s, off by %.2g\n", number, omega, error);
        assert_true(error < 1e-9);
        assert_true(fabs(end->angle - phi) < 1e-9 * fabs(phi));
        press.stall *= 1.0 + 1e-7;
        assert_true(fabs(run_up(&press, 0.5, 20000, &rough_phi) - end->omega) >
                    1e-9 * press.no_load);
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        const Motion *seen = trajectory_motion(run, run->sample_count - 1, 0);
        assert_true(fabs(seen->omega - end->omega) < 3e-4 * press.no_load);
        assert_true(fabs(truth->energy.residual) < 1e-9 * fabs(truth->energy.drive_work));
        assert_true(fabs(run->energy.residual) < 1e-2 * fabs(truth->energy.drive_work));
        trajectory_destroy(truth);
        trajectory_destroy(run);
    }
}

// A disc that a soft drive turns, and a torque from time zero on: the angle by which it is behind
// is a step's answer.
static void a_soft_drive_is_an_oscillator(void **state)
{
    (void)state;
    static const double J = 0.02;
    static const double K = 50.0;
    static const double C = 0.3;
    static const double TORQUE = -2.0;
    static const char TEXT[] =
        "bodies: {disc: {mass: 1 kg, inertia: 0.02 kg m^2, at: [0 mm, 0 mm]}}\n"
        "joints: {shaft: {between: [ground, disc], at: [0 mm, 0 mm]}}\n"
        "drive: {joint: shaft, speed: 20 rad/s, stiffness: 50 N m/rad, damping: 0.3 N m s/rad}\n"
        "loads: {brake: {body: disc, torque: -2 N m}}\n"
        "run: {revolutions: 2, samples: 500, step: 50 us}\n";
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    if (!casefile_load_text("disc", TEXT, sizeof TEXT - 1, NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    assert_false(scenario.linkage.driver.is_present);
    const double speed = scenario.linkage.torque.followed.speed;
    const double decay = 0.5 * C / J;
    const double w = sqrt(K / J - decay * decay);
    const BackendKind backends[] = {BACKEND_REFERENCE, BACKEND_ODE};
    for (size_t k = 0; k < 2; k++) {
        Trajectory *run = complete_run(&scenario, backends[k]);
        double apart = 0.0;
        for (size_t i = 0; i < run->sample_count; i++) {
            const double t = run->times[i];
            const double behind =
                TORQUE / K * (1.0 - exp(-decay * t) * (cos(w * t) + decay / w * sin(w * t)));
            apart = fmax(apart, fabs(trajectory_motion(run, i, 0)->angle - speed * t - behind));
        }
        print_message("# soft drive, %s: %.2g rad\n", run->backend, apart);
        assert_true(apart < (k == 0 ? 1e-11 : 1e-4 * fabs(TORQUE / K) * 10.0));
        trajectory_destroy(run);
    }
    scenario_free(&scenario);
}

// The pieces of a table: each shape between its points, periods to both sides, means by parts.
static void tables_keep_to_their_points(void **state)
{
    (void)state;
    LoadTable table = {.count = 4,
                       .at = {0.0, 1.0, 2.5, 3.0},
                       .values = {1.0, 3.0, 3.5, -1.0},
                       .period = 4.0,
                       .shape = LOAD_SMOOTH};
    load_table_settle(&table);
    for (int shape = 0; shape < LOAD_SHAPE_COUNT; shape++) {
        table.shape = (LoadShape)shape;
        for (int i = -2000; i < 2000; i++) {
            const double at = 0.013 * i;
            const LoadPiece up = load_table_piece(&table, at, 1.0);
            const LoadPiece down = load_table_piece(&table, at, -1.0);
            const double value = load_piece_at(&up, at);
            assert_true(value >= -1.0 - 1e-12 && value <= 3.5 + 1e-12);
            assert_true(shape == LOAD_STEPS || fabs(value - load_piece_at(&down, at)) < 1e-9);
            assert_true(load_table_next(&table, at, 1.0) > at);
            assert_true(load_table_next(&table, at, -1.0) < at);
        }
        // the mean of a period by many small parts
        double sum = 0.0;
        for (int i = 0; i < 4000; i++) {
            sum += load_table_mean(&table, -7.0 + 1e-3 * i, -7.0 + 1e-3 * (i + 1));
        }
        assert_true(fabs(sum / 4000.0 - load_table_mean(&table, -7.0, -3.0)) < 1e-10);
        assert_true(fabs(load_table_mean(&table, -3.0, -7.0) -
                         load_table_mean(&table, -7.0, -3.0)) < 1e-12);
    }
}

// A rotor of .01 kg m^2 on a spring of 2 N m/rad under a torque that jumps at 100, 300 and 600 ms,
// each a sample of 1000 in a second; of 997 none is.
enum { JUMPS = 3 };
static const double JUMP_AT[JUMPS + 1] = {0.1, 0.3, 0.6, INFINITY}; // s
static const double JUMP_TO[JUMPS] = {0.2, -0.4, 0.3};              // N m

static Scenario jumping(size_t samples, double step_s)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = linkage->joint_count = linkage->torsion_count = linkage->load_count = 1;
    linkage->bodies[0] = (Body){.name = "rotor", .mass = 1.0, .inertia = 0.01};
    linkage->bodies[0].start.omega = 1.0;
    linkage->joints[0] = (Joint){.name = "pivot", .body_a = LINKAGE_GROUND, .body_b = 0};
    linkage->torsions[0] = (TorsionSpring){.joint = 0, .stiffness = 2.0};
    Load *load = &linkage->loads[0];
    *load = (Load){.kind = LOAD_ALONG, .joint = 0};
    load->table = (LoadTable){.count = JUMPS + 1, .at = {0.0}, .shape = LOAD_STEPS};
    for (size_t i = 0; i < JUMPS; i++) {
        load->table.at[i + 1] = JUMP_AT[i];
        load->table.values[i + 1] = JUMP_TO[i];
    }
    load_table_settle(&load->table);
    scenario.gravity = scenario_downward(0.0);
    scenario.run.duration = 1.0;
    scenario.run.samples = samples;
    scenario.run.step = step_s;
    scenario.ode.stepping = ODE_STAGGERED;
    return scenario;
}

// The rotor's omega: an oscillator about M / k, from jump to jump.
static double jumping_omega(double time_s)
{
    const double w = sqrt(2.0 / 0.01);
    double angle = 0.0;
    double omega = 1.0;
    double from_s = 0.0;
    double rest = 0.0;
    for (size_t i = 0; i <= JUMPS && from_s < time_s; i++) {
        const double since_s = fmin(JUMP_AT[i], time_s) - from_s;
        const double off = angle - rest;
        angle = rest + off * cos(w * since_s) + omega / w * sin(w * since_s);
        omega = omega * cos(w * since_s) - off * w * sin(w * since_s);
        from_s += since_s;
        rest = i < JUMPS ? JUMP_TO[i] / 2.0 : 0.0;
    }
    return omega;
}

static double jumping_error(const Trajectory *run)
{
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const double truth = jumping_omega(run->times[k]);
        largest = fmax(largest, fabs(trajectory_motion(run, k, 0)->omega - truth));
    }
    return largest;
}

static double jumping_error_of(size_t samples, BackendKind backend, double step_s)
{
    const Scenario scenario = jumping(samples, step_s);
    Trajectory *run = complete_run(&scenario, backend);
    const double error = jumping_error(run);
    trajectory_destroy(run);
    return error;
}

static size_t steps_for_tolerance(const Scenario *scenario)
{
    Trajectory *run = backend_run(scenario, BACKEND_ODE, NULL, (ChosenWatch){.begin = NULL}, NULL);
    if (!run->is_complete || run->is_short) {
        fail_msg("%s", run->message);
    }
    const size_t steps = run->steps;
    trajectory_destroy(run);
    return steps;
}

// Control: where no sample meets a jump nothing is to be read beside one.
static void a_load_that_jumps_at_a_sample_costs_no_steps(void **state)
{
    (void)state;
    assert_near(jumping_error_of(1000, BACKEND_REFERENCE, 0.0), 0.0, 1e-10);
    // 24.9 us end at no jump, 25 us at all
    const double at_jumps = jumping_error_of(1000, BACKEND_ODE, 25e-6);
    assert_true(at_jumps < 1e-6);
    assert_true(jumping_error_of(1000, BACKEND_ODE, 24.9e-6) < 3.0 * at_jumps);
    assert_true(jumping_error_of(1000, BACKEND_ODE, 24e-6) < 1.1 * at_jumps);
    // half a step without the jump is what was read there
    assert_true(0.5 * 25e-6 * 0.6 / 0.01 > 100.0 * at_jumps);
    const Scenario with = jumping(1000, 0.0);
    const Scenario without = jumping(997, 0.0);
    const size_t steps = steps_for_tolerance(&with);
    assert_true(2 * steps <= 3 * steps_for_tolerance(&without));
    assert_true(steps < 10000);
}

// Plain steps, whose error is one of first order anyway. Control: half a step of a jump, which was
// read at a sample in its step, is several times as much.
static void plain_steps_know_where_loads_jump(void **state)
{
    (void)state;
    double errors[2];
    for (int i = 0; i < 2; i++) {
        Scenario scenario = jumping(i == 0 ? 1000 : 997, 24.9e-6);
        scenario.ode.stepping = ODE_PLAIN;
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        errors[i] = jumping_error(run);
        trajectory_destroy(run);
    }
    assert_true(errors[0] < 1.1 * errors[1]);
    assert_true(0.5 * 24.9e-6 * 0.6 / 0.01 > 3.0 * errors[0]);
}

// The same rotor without a spring, under a torque that jumps over its angle: two points are 1e-5
// rad apart, which a step passes many times over. The truth is the work done to each angle,
//     omega^2 = omega_0^2 + 2 / I  integral of M d phi
// Control: half a step of a jump, which a step read that holds what it has at its middle.
static void a_torque_that_jumps_over_an_angle_does_its_work(void **state)
{
    (void)state;
    static const double STEP = 1e-4;
    Scenario scenario = jumping(1000, STEP);
    Linkage *linkage = &scenario.linkage;
    linkage->torsion_count = 0;
    linkage->bodies[0].start.omega = 20.0;
    LoadTable table = {.count = 2 * JUMPS + 1, .at = {0.0}, .shape = LOAD_LINEAR};
    for (size_t i = 0; i < JUMPS; i++) {
        table.at[2 * i + 1] = 10.0 * JUMP_AT[i];
        table.at[2 * i + 2] = 10.0 * JUMP_AT[i] + 1e-5;
        table.values[2 * i + 1] = i > 0 ? JUMP_TO[i - 1] : 0.0;
        table.values[2 * i + 2] = JUMP_TO[i];
    }
    linkage->loads[0].table = table;
    linkage->loads[0].over = LOAD_OVER_POSITION;
    load_table_settle(&linkage->loads[0].table);
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const Motion *rotor = trajectory_motion(run, k, 0);
        const double work =
            rotor->angle > 0.0 ? rotor->angle * load_table_mean(&table, 0.0, rotor->angle) : 0.0;
        const double truth = sqrt(400.0 + 2.0 / 0.01 * work);
        largest = fmax(largest, fabs(rotor->omega - truth));
    }
    trajectory_destroy(run);
    print_message("over an angle: off by %.2g rad/s\n", largest);
    assert_true(100.0 * largest < 0.5 * STEP * 0.7 / 0.01);
}

// A world that flies apart passes periods without number in a step: its load is that in the middle.
static void a_load_passed_over_many_periods_is_that_in_the_middle(void **state)
{
    (void)state;
    static const double OMEGAS[] = {1.0, 1e15, INFINITY};
    Scenario scenario = jumping(1000, 1e-3);
    Linkage *linkage = &scenario.linkage;
    Load *load = &linkage->loads[0];
    load->over = LOAD_OVER_POSITION;
    load->table.shape = LOAD_LINEAR;
    load->table.period = 2.0 * M_PI;
    load_table_settle(&load->table);
    for (size_t i = 0; i < 3; i++) {
        // no point is within a step at 1 rad/s, either
        const Motion motions[1] = {{.angle = 0.45, .omega = OMEGAS[i]}};
        const double mean = load_mean(linkage, load, motions, 0.0, 1e-3);
        assert_true(mean == load_value(linkage, load, motions, 5e-4, 0.0));
    }
    // the control: three points are
    const Motion near[1] = {{.angle = 0.3, .omega = 700.0}};
    assert_true(load_mean(linkage, load, near, 0.0, 1e-3) !=
                load_value(linkage, load, near, 5e-4, 0.0));
}

// The same of teeth with play, whose contacts are integrated within the steps.
static void teeth_under_a_load_that_jumps_cost_no_steps(void **state)
{
    (void)state;
    static const char TEXT[] =
        "title: Gears\n"
        "bodies:\n"
        "  small: {mass: 0.1 kg, inertia: 20 kg mm^2, at: [0 mm, 0 mm], spin: 20 rad/s}\n"
        "  large: {mass: 0.5 kg, inertia: 400 kg mm^2, at: [80 mm, 0 mm]}\n"
        "joints:\n"
        "  pinion: {between: [ground, small], at: [0 mm, 0 mm]}\n"
        "  wheel:  {between: [ground, large], at: [80 mm, 0 mm]}\n"
        "  mesh:   {gears: [pinion, wheel], teeth: [20, 60], backlash: 0.1 mm, stiffness: 1e8 "
        "N/m}\n"
        "loads:\n"
        "  push: {joint: pinion, interpolation: steps,\n"
        "         torque: [[0 s, 0.2 N m], [50 ms, -0.4 N m], [150 ms, 0.3 N m]]}\n"
        "contact: {restitution: 0.5}\n"
        "run: {duration: 200 ms, samples: 1000, step: auto, backends: [ode]}\n";
    size_t steps[2];
    for (int i = 0; i < 2; i++) {
        const char *samples = i == 0 ? "run.samples=1000" : "run.samples=997";
        Scenario scenario;
        Err err = {0};
        if (!casefile_load_text("gears.yaml", TEXT, sizeof TEXT - 1, &samples, 1, &scenario,
                                &err)) {
            fail_msg("%s", err.text);
        }
        steps[i] = steps_for_tolerance(&scenario);
        scenario_free(&scenario);
    }
    assert_true(2 * steps[0] <= 3 * steps[1]);
    assert_true(steps[0] < 10000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_keep_to_their_points),
        cmocka_unit_test(a_gas_force_has_the_forces_of_the_closed_form),
        cmocka_unit_test(work_goes_into_the_gas_and_friction),
        cmocka_unit_test(a_motor_runs_up_as_its_one_equation_says),
        cmocka_unit_test(a_soft_drive_is_an_oscillator),
        cmocka_unit_test(a_load_that_jumps_at_a_sample_costs_no_steps),
        cmocka_unit_test(plain_steps_know_where_loads_jump),
        cmocka_unit_test(a_torque_that_jumps_over_an_angle_does_its_work),
        cmocka_unit_test(a_load_passed_over_many_periods_is_that_in_the_middle),
        cmocka_unit_test(teeth_under_a_load_that_jumps_cost_no_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
