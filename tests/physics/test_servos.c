// Do soft drives hold, swing and saturate as their equations say?
//
// An arm on a pivot is turned by a controller of stiffness k, damping c and a limit L. The truth is
// its one equation,
//     I phi'' = M - m g r cos phi,   M = k (phi_d - phi) + c (phi_d' - phi') within +-L,
// integrated here by the classical Runge-Kutta rule of order 4 in long double, whose steps end
// where the torque reaches its limit or leaves it. At rest it is an equation of angles alone,
// solved here by bisection. Controls: no limit, or another angle, is far off.
#include "complete_run.h"

#include "casefile/casefile.h"
#include "measure/chosen_run.h"
#include "measure/truth.h"
#include "run/drive_torque.h"

#include <stdio.h>
#include <string.h>

static const double G = 9.80665;

static Scenario scenario_of(const char *text, const char *const *settings, size_t count)
{
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    if (!casefile_load_text("servo.yaml", text, strlen(text), settings, count, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return scenario;
}

static void assert_refused(const char *text, const char *setting, const char *words)
{
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    assert_false(
        casefile_load_text("servo.yaml", text, strlen(text), &setting, 1, &scenario, &err));
    if (strstr(err.text, words) == NULL) {
        fail_msg("%s", err.text);
    }
}

// An arm: 2 kg at 0.1 m, of 0.03 kg m^2 about the pivot.
#define ARM                                                                                        \
    "bodies: {arm: {mass: 2 kg, inertia: 0.01 kg m^2, at: [100 mm, 0 mm]}}\n"                      \
    "joints: {shoulder: {between: [ground, arm], at: [0 mm, 0 mm]}}\n"

static const char STEP_ANSWER[] =
    ARM "drive: {joint: shoulder, angle: 60 deg, stiffness: 40 N m/rad, damping: 0.6 N m s/rad,\n"
        "        torque-limit: 8 N m}\n"
        "run: {duration: 1 s, samples: 500, step: 100 us}\n";

static const char TURNING[] =
    ARM "drive: {joint: shoulder, speed: 60 rpm, stiffness: 40 N m/rad, damping: 0.6 N m s/rad}\n"
        "gravity: 0 m/s^2\n"
        "run: {samples: 40}\n";

static double end_angle(const Scenario *scenario)
{
    Trajectory *run = complete_run(scenario, BACKEND_REFERENCE);
    const double angle = trajectory_motion(run, run->sample_count - 1, 0)->angle;
    trajectory_destroy(run);
    return angle;
}

// 60 rpm for 2 revolutions, or for 0.3 s: both are lengths of the run. Samples are those of a turn,
// or with a duration those of the run.
static void a_soft_drive_runs_for_turns_or_for_a_time(void **state)
{
    (void)state;
    static const char *const TURNS[] = {"run.revolutions=2"};
    static const char *const TIME[] = {"run.duration=300 ms"};
    Scenario by_turns = scenario_of(TURNING, TURNS, 1);
    Scenario by_time = scenario_of(TURNING, TIME, 1);
    assert_near(scenario_duration(&by_turns), 2.0, 1e-15);
    assert_near(scenario_duration(&by_time), 0.3, 1e-15);
    assert_int_equal(scenario_sample_count(&by_turns), 2 * 40 + 1);
    assert_int_equal(scenario_sample_count(&by_time), 40 + 1);
    assert_near(end_angle(&by_turns), 4.0 * M_PI, 1e-10);
    assert_near(end_angle(&by_time), 0.6 * M_PI, 1e-10);
    // it starts with the speed that it follows
    assert_near(by_turns.linkage.bodies[0].start.omega, 2.0 * M_PI, 1e-14);
    // the key counts: nobody is warned of it
    CasefileWalk walk = casefile_walk(&by_turns);
    CasefileSetting setting;
    while (casefile_next(&walk, &setting)) {
        assert_true(setting.applies || strcmp(setting.key, "run.revolutions") != 0);
    }
    scenario_free(&by_turns);
    scenario_free(&by_time);
    static const char *const BOTH[] = {"run.duration=300 ms", "run.revolutions=2"};
    Scenario both;
    Err err = {ERR_NONE, ""};
    assert_false(casefile_load_text("x", TURNING, strlen(TURNING), BOTH, 2, &both, &err));
    assert_non_null(strstr(err.text, "the length of the run is given twice"));
}

// A report from one revolution on is one of the drive's, soft or not.
static void a_soft_drive_is_reported_from_a_turn(void **state)
{
    (void)state;
    static const char *const SETTINGS[] = {"run.revolutions=2", "run.report-from=1 revolution"};
    Scenario scenario = scenario_of(TURNING, SETTINGS, 2);
    assert_near(scenario_report_from(&scenario), 1.0, 1e-15);
    scenario_free(&scenario);
}

// Where the arm stands still: k (phi_d - phi) = m g r cos phi.
static double resting_angle(double wanted)
{
    double low = -2.0;
    double high = 2.0;
    for (int i = 0; i < 200; i++) {
        const double middle = 0.5 * (low + high);
        const double left = 40.0 * (wanted - middle) - 2.0 * G * 0.1 * cos(middle);
        low = left > 0.0 ? middle : low;
        high = left > 0.0 ? high : middle;
    }
    return 0.5 * (low + high);
}

// A speed of 0, and one angle, hold: the arm comes to rest where its weight bends the drive.
static void a_soft_drive_holds_where_its_weight_bends_it(void **state)
{
    (void)state;
    static const char *const HOLDS[][1] = {
        {"drive.speed=0 rpm"}, {"drive.angle=0 deg"}, {"drive.angle=30 deg"}};
    static const double WANTED[] = {0.0, 0.0, M_PI / 6.0};
    for (size_t i = 0; i < 3; i++) {
        static const char TEXT[] =
            ARM "drive: {joint: shoulder, stiffness: 40 N m/rad, damping: 0.6 N m s/rad}\n"
                "run: {duration: 4 s, samples: 400}\n";
        Scenario scenario = scenario_of(TEXT, HOLDS[i], 1);
        assert_near(scenario.linkage.bodies[0].start.angle, 0.0, 0.0);
        const double angle = end_angle(&scenario);
        print_message("# held at %.4g rad: %.10f, at rest %.10f\n", WANTED[i], angle,
                      resting_angle(WANTED[i]));
        assert_near(angle, resting_angle(WANTED[i]), 1e-9);
        // control: the angle that is wanted is not where it stands
        assert_true(fabs(angle - WANTED[i]) > 1e-2);
        scenario_free(&scenario);
    }
    // a drive that is not soft has to be told how it gets there, and does not stand
    assert_refused(ARM "drive: {joint: shoulder, speed: 60 rpm}\n", "drive.angle=30 deg",
                   "two points at least; only a soft drive holds one angle");
    assert_refused(ARM "drive: {joint: shoulder, speed: 60 rpm}\n", "drive.speed=0 rpm",
                   "the crank does not turn");
    assert_refused(STEP_ANSWER, "run.revolutions=2", "a soft drive that holds an angle");
    assert_refused(ARM "drive: {joint: shoulder, speed: 60 rpm}\n", "drive.torque-limit=1 N m",
                   "only a soft drive has this");
}

// The truth of the arm.
typedef struct Arm {
    long double angle;
    long double omega;
} Arm;

typedef struct Control {
    long double wanted[4]; // rad: a + b sin(c t + d)
    long double stiffness;
    long double damping;
    long double limit;
} Control;

static long double unlimited(const Control *control, long double t, Arm arm)
{
    const long double at = control->wanted[2] * t + control->wanted[3];
    const long double angle = control->wanted[0] + control->wanted[1] * sinl(at);
    const long double omega = control->wanted[1] * control->wanted[2] * cosl(at);
    return control->stiffness * (angle - arm.angle) + control->damping * (omega - arm.omega);
}

static int side_of(const Control *control, long double t, Arm arm)
{
    const long double torque = unlimited(control, t, arm);
    return torque > control->limit ? 1 : torque < -control->limit ? -1 : 0;
}

// On the side where it is: in a step the torque has no corner.
static Arm rates(const Control *control, int side, long double t, Arm arm)
{
    const long double torque = side == 0 ? unlimited(control, t, arm) : side * control->limit;
    return (Arm){arm.omega, (torque - 2.0L * G * 0.1L * cosl(arm.angle)) / 0.03L};
}

static Arm moved(Arm arm, long double by, Arm rate)
{
    return (Arm){arm.angle + by * rate.angle, arm.omega + by * rate.omega};
}

static Arm stepped(const Control *control, int side, long double t, Arm arm, long double h)
{
    const Arm k1 = rates(control, side, t, arm);
    const Arm k2 = rates(control, side, t + 0.5L * h, moved(arm, 0.5L * h, k1));
    const Arm k3 = rates(control, side, t + 0.5L * h, moved(arm, 0.5L * h, k2));
    const Arm k4 = rates(control, side, t + h, moved(arm, h, k3));
    return (Arm){arm.angle + h / 6.0L * (k1.angle + 2.0L * (k2.angle + k3.angle) + k4.angle),
                 arm.omega + h / 6.0L * (k1.omega + 2.0L * (k2.omega + k3.omega) + k4.omega)};
}

enum { PIECES = 200 }; // steps between two samples

// Goes on to a time; counts the corners.
static Arm followed(const Control *control, long double from, long double to, Arm arm, int *side,
                    int *corners)
{
    const long double h = (to - from) / PIECES;
    for (int i = 0; i < PIECES; i++) {
        long double t = from + i * h;
        long double left = h;
        while (left > 0.0L) {
            Arm next = stepped(control, *side, t, arm, left);
            if (side_of(control, t + left, next) == *side) {
                arm = next;
                break;
            }
            // up to the corner, by bisection
            long double low = 0.0L;
            long double high = left;
            for (int k = 0; k < 70; k++) {
                const long double middle = 0.5L * (low + high);
                next = stepped(control, *side, t, arm, middle);
                *(side_of(control, t + middle, next) == *side ? &low : &high) = middle;
            }
            arm = stepped(control, *side, t, arm, high);
            t += high;
            left -= high;
            *side = side_of(control, t, arm);
            ++*corners;
        }
    }
    return arm;
}

// The largest difference of a run's angle and speed from the truth, each over its own largest.
static double apart_from_truth(const Control *control, const Trajectory *run, int *corners)
{
    Arm arm = {0.0L, trajectory_motion(run, 0, 0)->omega};
    int side = side_of(control, 0.0L, arm);
    double off[2] = {0.0, 0.0};
    double size[2] = {0.0, 0.0};
    *corners = 0;
    for (size_t i = 1; i < run->sample_count; i++) {
        arm = followed(control, run->times[i - 1], run->times[i], arm, &side, corners);
        const Motion *motion = trajectory_motion(run, i, 0);
        off[0] = fmax(off[0], fabs((double)(motion->angle - arm.angle)));
        off[1] = fmax(off[1], fabs((double)(motion->omega - arm.omega)));
        size[0] = fmax(size[0], fabs((double)arm.angle));
        size[1] = fmax(size[1], fabs((double)arm.omega));
    }
    return fmax(off[0] / size[0], off[1] / size[1]);
}

static const Control STEP_CONTROL = {{M_PI / 3.0L, 0.0L, 0.0L, 0.0L}, 40.0L, 0.6L, 8.0L};

static void a_limited_drive_answers_a_step_as_its_equation_says(void **state)
{
    (void)state;
    Scenario scenario = scenario_of(STEP_ANSWER, NULL, 0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    int corners;
    const double off = apart_from_truth(&STEP_CONTROL, run, &corners);
    print_message("# reference, %d corners: off by %.2g\n", corners, off);
    assert_true(corners >= 3);
    assert_true(off < 1e-9);
    // control: without the limit
    Control free_of_limit = STEP_CONTROL;
    free_of_limit.limit = 1e9L;
    assert_true(apart_from_truth(&free_of_limit, run, &corners) > 0.1);
    // the work of the drive is in the energy, and its torque never above the limit
    const Motion *end = trajectory_motion(run, run->sample_count - 1, 0);
    const double energy = 0.5 * 0.03 * end->omega * end->omega + 2.0 * G * 0.1 * sin(end->angle);
    assert_near(run->energy.drive_work, energy, 1e-9);
    double largest = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        largest = fmax(largest, fabs(drive_torque_of(&scenario, trajectory_motion(run, i, 0), NULL,
                                                     run->times[i], 0)));
    }
    assert_true(largest == 8.0);
    trajectory_destroy(run);
    scenario_free(&scenario);
}

// Order 2 of ODE's steps, of both kinds in the plane that have it, and 1 of plain ones.
static void ode_keeps_its_order_over_corners(void **state)
{
    (void)state;
    static const char *const STEPPINGS[] = {"ode.stepping=staggered", "ode.stepping=plain"};
    static const double ORDERS[] = {2.0, 1.0};
    for (size_t k = 0; k < 2; k++) {
        double errors[4];
        for (int i = 0; i < 4; i++) {
            Scenario scenario = scenario_of(STEP_ANSWER, &STEPPINGS[k], 1);
            scenario.run.step = 4e-4 / (1 << i);
            Trajectory *run = complete_run(&scenario, BACKEND_ODE);
            int corners;
            errors[i] = apart_from_truth(&STEP_CONTROL, run, &corners);
            const double residual = fabs(run->energy.residual);
            assert_true(k > 0 || residual < 40.0 * errors[i]);
            trajectory_destroy(run);
            scenario_free(&scenario);
        }
        const double order = log2(errors[0] / errors[3]) / 3.0;
        print_message("# %s: %.3g %.3g %.3g %.3g, order %.2f\n", STEPPINGS[k], errors[0], errors[1],
                      errors[2], errors[3], order);
        assert_true(order > 0.9 * ORDERS[k]);
    }
}

// The chosen step holds the errors that are asked, against the equation and not the reference.
static void a_chosen_step_holds_over_corners(void **state)
{
    (void)state;
    static const double TOLERANCES[] = {1e-4, 1e-5};
    for (size_t i = 0; i < 2; i++) {
        static const char *const AUTO[] = {"run.step=auto"};
        Scenario scenario = scenario_of(STEP_ANSWER, AUTO, 1);
        scenario.run.tolerance = TOLERANCES[i];
        Trajectory *run =
            backend_run(&scenario, BACKEND_ODE, NULL, (ChosenWatch){.begin = NULL}, NULL);
        assert_true(run->is_complete && !run->is_short);
        int corners;
        const double off = apart_from_truth(&STEP_CONTROL, run, &corners);
        print_message("# auto, %.0e wanted: off by %.2g, %zu steps\n", TOLERANCES[i], off,
                      run->steps);
        assert_true(off <= TOLERANCES[i]);
        trajectory_destroy(run);
        scenario_free(&scenario);
    }
}

// A servo whose gear has play holds the arm: the rotor is bent back by m g r cos(a) / k, and the
// arm lies on the flank, half the play and the flank's own depth lower.
static void a_servo_with_backlash_holds_its_arm(void **state)
{
    (void)state;
    static const char TEXT[] =
        "bodies:\n"
        "  rotor: {mass: 0.5 kg, inertia: 0.002 kg m^2, at: [0 mm, 0 mm]}\n"
        "  arm: {mass: 2 kg, inertia: 0.01 kg m^2, at: [100 mm, 0 mm]}\n"
        "joints:\n"
        "  shaft: {between: [ground, rotor], at: [0 mm, 0 mm]}\n"
        "  gear: {between: [rotor, arm], at: [0 mm, 0 mm], backlash: 1 deg,\n"
        "         stiffness: 5000 N m/rad, viscous-coefficient: 5 N m s/rad}\n"
        "drive: {joint: shaft, angle: 20 deg, stiffness: 60 N m/rad, damping: 2 N m s/rad,\n"
        "        torque-limit: 4 N m}\n"
        "run: {duration: 6 s, samples: 600, start: centred}\n";
    Scenario scenario = scenario_of(TEXT, NULL, 0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const size_t last = run->sample_count - 1;
    const double rotor = trajectory_motion(run, last, 0)->angle;
    const double arm = trajectory_motion(run, last, 1)->angle;
    // k (phi_d - rotor) = m g r cos(arm) = K depth,  arm = rotor - b/2 - depth
    double low = -1.0;
    double high = 1.0;
    double depth = 0.0;
    double bent = 0.0;
    for (int i = 0; i < 200; i++) {
        const double guess = 0.5 * (low + high);
        const double torque = 2.0 * G * 0.1 * cos(guess);
        depth = torque / 5000.0;
        bent = torque / 60.0;
        const double follows = M_PI / 9.0 - bent - M_PI / 360.0 - depth;
        low = follows > guess ? guess : low;
        high = follows > guess ? high : guess;
    }
    print_message("# servo: rotor %.9f, wanted %.9f; arm %.9f, wanted %.9f rad\n", rotor,
                  M_PI / 9.0 - bent, arm, low);
    assert_near(rotor, M_PI / 9.0 - bent, 1e-6);
    assert_near(arm, low, 1e-6);
    // the arm is below the angle that is wanted by b/2 + m g r cos(arm) / k, but for the flank
    assert_near(M_PI / 9.0 - arm - depth, M_PI / 360.0 + 2.0 * G * 0.1 * cos(arm) / 60.0, 1e-6);
    // controls: without the play, and without the weight
    assert_true(fabs(arm - (low + M_PI / 360.0)) > 1e-3);
    assert_true(fabs(arm - (M_PI / 9.0 - M_PI / 360.0)) > 1e-2);
    trajectory_destroy(run);
    scenario_free(&scenario);
}

// What its shaft has to hold, over its friction, of a servo that has come to rest; and how fast it
// still goes, rad/s.
static double band_used(double friction, const char *law, double *rate)
{
    char text[2048];
    snprintf(text, sizeof text,
             "bodies:\n"
             "  rotor: {mass: 0.5 kg, inertia: 0.002 kg m^2, at: [0 mm, 0 mm]}\n"
             "  arm: {mass: 2 kg, inertia: 0.01 kg m^2, at: [100 mm, 0 mm]}\n"
             "joints:\n"
             "  shaft: {between: [ground, rotor], at: [0 mm, 0 mm], friction-torque: %.17g N m,\n"
             "          friction-law: %s}\n"
             "  gear: {between: [rotor, arm], at: [0 mm, 0 mm], backlash: 1 deg,\n"
             "         stiffness: 5000 N m/rad, viscous-coefficient: 5 N m s/rad}\n"
             "drive: {joint: shaft, angle: 20 deg, stiffness: 60 N m/rad, damping: 2 N m s/rad,\n"
             "        torque-limit: 4 N m}\n"
             "run: {duration: 4 s, samples: 40, start: centred, backends: [reference]}\n",
             friction, law);
    Scenario scenario = scenario_of(text, NULL, 0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const size_t last = run->sample_count - 1;
    const double rotor = trajectory_motion(run, last, 0)->angle;
    const double arm = trajectory_motion(run, last, 1)->angle;
    *rate = trajectory_motion(run, last, 0)->omega;
    trajectory_destroy(run);
    scenario_free(&scenario);
    return (60.0 * (M_PI / 9.0 - rotor) - 2.0 * G * 0.1 * cos(arm)) / friction;
}

static void a_servo_with_friction_sticks_within_its_band(void **state)
{
    (void)state;
    static const double FRICTIONS[] = {0.1, 0.3, 0.5, 0.8};
    double most = 0.0;
    double rate;
    for (size_t i = 0; i < sizeof FRICTIONS / sizeof *FRICTIONS; i++) {
        const double used = band_used(FRICTIONS[i], "stick", &rate);
        assert_true(fabs(used) <= 1.0);
        assert_near(rate, 0.0, 1e-9);
        most = fmax(most, fabs(used));
    }
    assert_true(most > 0.1);
    // the control: what creeps has come to where nothing is left to hold
    assert_near(band_used(0.5, "regularized", &rate), 0.0, 0.05);
}

// ODE's ways in the plane: the same work of the drive, none of it lost, and the same rest.
static void ode_gives_a_limited_drive_its_work(void **state)
{
    (void)state;
    static const struct {
        const char *settings[3];
        double work; // 1: of the drive's work, what it may be off by
    } WAYS[] = {
        {{"ode.map=impulse", "ode.stepping=staggered", "ode.solver=direct"}, 1e-5},
        {{"ode.map=impulse", "ode.stepping=staggered", "ode.solver=quick"}, 1e-5},
        {{"ode.map=midpoint", "ode.stepping=staggered", "ode.solver=direct"}, 1e-4},
        {{"ode.map=textbook", "ode.stepping=plain", "ode.solver=direct"}, 1e-2},
    };
    Err err = {ERR_NONE, ""};
    for (size_t i = 0; i < sizeof WAYS / sizeof *WAYS; i++) {
        Scenario scenario;
        const char *settings[] = {"run.step=20us", "run.samples=100", WAYS[i].settings[0],
                                  WAYS[i].settings[1], WAYS[i].settings[2]};
        if (!casefile_load("cases/mechanisms/servo-arm.yaml", settings, 5, &scenario, &err)) {
            fail_msg("%s", err.text);
        }
        Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        const double off = run->energy.drive_work / truth->energy.drive_work - 1.0;
        print_message("# %s %s: work off by %.2g, residual %.2g J\n", WAYS[i].settings[0],
                      WAYS[i].settings[2], off, run->energy.residual);
        assert_true(fabs(off) < WAYS[i].work);
        assert_true(fabs(run->energy.residual) < WAYS[i].work * truth->energy.drive_work);
        assert_near(trajectory_motion(run, run->sample_count - 1, 1)->angle,
                    trajectory_motion(truth, run->sample_count - 1, 1)->angle, 1e-8);
        trajectory_destroy(truth);
        trajectory_destroy(run);
        scenario_free(&scenario);
    }
}

// A drive that follows a sinusoid, limited, against the same equation.
static void a_limited_drive_follows_a_sinusoid(void **state)
{
    (void)state;
    static const char TEXT[] =
        ARM "drive: {joint: shoulder, stiffness: 40 N m/rad, damping: 0.6 N m s/rad,\n"
            "        torque-limit: 6 N m,\n"
            "        angle: {mean: 10 deg, amplitude: 25 deg, frequency: 3 Hz, phase: 40 deg}}\n"
            "run: {duration: 1 s, samples: 500, step: auto}\n";
    static const Control CONTROL = {
        {M_PI / 18.0L, 25.0L * M_PI / 180.0L, 6.0L * M_PI, 2.0L * M_PI / 9.0L}, 40.0L, 0.6L, 6.0L};
    Scenario scenario = scenario_of(TEXT, NULL, 0);
    const BackendKind backends[] = {BACKEND_REFERENCE, BACKEND_ODE};
    for (size_t k = 0; k < 2; k++) {
        Trajectory *run =
            backend_run(&scenario, backends[k], NULL, (ChosenWatch){.begin = NULL}, NULL);
        int corners;
        const double off = apart_from_truth(&CONTROL, run, &corners);
        print_message("# swinging, %s, %d corners: off by %.2g\n", run->backend, corners, off);
        assert_true(corners > 4);
        assert_true(off < (k == 0 ? 1e-9 : 1e-4));
        trajectory_destroy(run);
    }
    scenario_free(&scenario);
}

// A limit that the torque passes for a moment only, between two steps that lie below it: by 1e-3 to
// 1e-9 of itself. A corner that is passed over would cost as much of the torque for that while.
static void a_moment_beyond_the_limit_is_seen(void **state)
{
    (void)state;
    static const char TEXT[] =
        ARM "drive: {joint: shoulder, stiffness: 40 N m/rad, damping: 0.6 N m s/rad,\n"
            "        torque-limit: 1e6 N m,\n"
            "        angle: {amplitude: 25 deg, frequency: 3 Hz, phase: 40 deg}}\n"
            "run: {duration: 1 s, samples: 2000}\n";
    Control control = {{-25.0L * M_PI / 180.0L * sinl(2.0L * M_PI / 9.0L), 25.0L * M_PI / 180.0L,
                        6.0L * M_PI, 2.0L * M_PI / 9.0L},
                       40.0L,
                       0.6L,
                       1e6L};
    Scenario scenario = scenario_of(TEXT, NULL, 0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    double largest = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        const Motion *motion = trajectory_motion(run, i, 0);
        largest = fmax(largest, fabs((double)unlimited(&control, run->times[i],
                                                       (Arm){motion->angle, motion->omega})));
    }
    trajectory_destroy(run);
    static const double SHARES[] = {1e-3, 1e-5, 1e-7, 1e-9};
    for (size_t k = 0; k < 4; k++) {
        scenario.linkage.torque.limit = (1.0 - SHARES[k]) * largest;
        control.limit = scenario.linkage.torque.limit;
        run = complete_run(&scenario, BACKEND_REFERENCE);
        int corners;
        const double off = apart_from_truth(&control, run, &corners);
        print_message("# %.0e beyond, %d corners: off by %.2g\n", SHARES[k], corners, off);
        assert_true(corners == 2 && off < 1e-11);
        trajectory_destroy(run);
    }
    scenario_free(&scenario);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_soft_drive_runs_for_turns_or_for_a_time),
        cmocka_unit_test(a_soft_drive_is_reported_from_a_turn),
        cmocka_unit_test(a_soft_drive_holds_where_its_weight_bends_it),
        cmocka_unit_test(a_limited_drive_answers_a_step_as_its_equation_says),
        cmocka_unit_test(ode_keeps_its_order_over_corners),
        cmocka_unit_test(a_chosen_step_holds_over_corners),
        cmocka_unit_test(a_servo_with_backlash_holds_its_arm),
        cmocka_unit_test(a_servo_with_friction_sticks_within_its_band),
        cmocka_unit_test(ode_gives_a_limited_drive_its_work),
        cmocka_unit_test(a_limited_drive_follows_a_sinusoid),
        cmocka_unit_test(a_moment_beyond_the_limit_is_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
