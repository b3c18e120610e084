// Does ODE hold what friction holds, where it integrates contacts within its steps?
//
// The truth is the reference, which tests/physics/test_friction_that_holds.c holds against others.
// Regularized friction is the control: it creeps.
#include "complete_run.h"
#include "load_case.h"
#include "sample.h"

#include "base/lcg.h"
#include "measure/chosen_run.h"
#include "measure/creep.h"
#include "run/registry.h"
#include "run/run.h"

#include <stdio.h>
#include <string.h>

enum { TEXT_SIZE = 4096 };

static Scenario case_of(const char *text)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("case.yaml", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

// At the step of the text, or at one that ODE chooses.
static Trajectory *run_text(const char *text, BackendKind backend)
{
    const Scenario scenario = case_of(text);
    if (!backend_run_is_chosen(&scenario, backend)) {
        return complete_run(&scenario, backend);
    }
    Trajectory *run = backend_run(&scenario, backend, NULL, (ChosenWatch){.begin = NULL}, NULL);
    assert_true(run->is_complete);
    return run;
}

// The largest difference of ODE's angular velocities to those of the reference, of another text, in
// the samples, over the largest of each body.
static double apart(const char *text, const char *other)
{
    Trajectory *truth = run_text(other, BACKEND_REFERENCE);
    Trajectory *run = run_text(text, BACKEND_ODE);
    double worst = 0.0;
    for (size_t body = 0; body < truth->body_count; body++) {
        double size = 0.0;
        double off = 0.0;
        for (size_t k = 0; k < truth->sample_count; k++) {
            const double omega = trajectory_motion(truth, k, body)->omega;
            size = fmax(size, fabs(omega));
            off = fmax(off, fabs(trajectory_motion(run, k, body)->omega - omega));
        }
        // a slider on its line does not turn but for rounding
        worst = fmax(worst, size > 1e-9 ? off / size : 0.0);
    }
    trajectory_destroy(truth);
    trajectory_destroy(run);
    return worst;
}

// A lever that hangs from a pin with play, half a millimetre beside it: its friction circle is
// twice that. Returns how far it has turned after a second, rad, and writes in what share it
// creeps.
static double lever_turns(const char *law, BackendKind backend, double *creeps)
{
    char text[TEXT_SIZE];
    snprintf(text, sizeof text,
             "bodies:\n  lever: {mass: 1 kg, inertia: 500 kg mm^2, at: [0.5 mm, -0.1 mm]}\n"
             "joints:\n  pivot: {between: [ground, lever], at: [0 mm, 0 mm], hole: 20.1 mm, pin: "
             "20 mm, width: 15 mm, start: [0 mm, -0.05 mm]}\n"
             "gravity: 9.81 m/s^2\n"
             "contact: {law: johnson, friction: 0.1, friction-law: %s, restitution: 0.5}\n"
             "run: {duration: 1 s, samples: 11, step: 50 us, backends: [reference, ode]}\n",
             law);
    const Scenario scenario = case_of(text);
    Trajectory *run = complete_run(&scenario, backend);
    const double turned = trajectory_motion(run, run->sample_count - 1, 0)->angle;
    *creeps = creep_share(&scenario, run, 0);
    trajectory_destroy(run);
    return turned;
}

static void a_lever_holds_where_the_reference_holds_it(void **state)
{
    (void)state;
    const double presliding = 5e-6 / 10e-3;
    double creeps;
    const double turned = lever_turns("stick", BACKEND_ODE, &creeps);
    assert_true(fabs(turned) < presliding);
    assert_true(isnan(creeps));
    const double wanted = lever_turns("stick", BACKEND_REFERENCE, &creeps);
    assert_near(turned, wanted, 1e-4 * presliding);
    assert_true(isnan(creeps));
    assert_true(fabs(lever_turns("regularized", BACKEND_ODE, &creeps)) > 100.0 * presliding);
    assert_true(creeps > 0.05);
}

// A slider-crank with play at both ends of its rod, drawn from a seed.
static void write_slider_crank(uint64_t seed, const char *law, double step_us, char *text)
{
    double draws[7];
    for (size_t i = 0; i < 7; i++) {
        draws[i] = 0.5 * (1.0 + lcg_draw(&seed));
    }
    snprintf(
        text, TEXT_SIZE,
        "slider-crank:\n"
        "  crank: {length: %.17g mm, mass: 0.3 kg, inertia: 100 kg mm^2}\n"
        "  rod: {length: %.17g mm, mass: 0.2 kg, inertia: 250 kg mm^2}\n"
        "  slider: {mass: %.17g kg, inertia: 100 kg mm^2}\n"
        "joints:\n"
        "  crank-rod: {radial-clearance: %.17g um, width: 20 mm}\n"
        "  rod-slider: {radial-clearance: %.17g um, width: 20 mm}\n"
        "drive: {speed: %.17g rpm}\n"
        "contact: {stiffness: 2e10 N/m^1.5, damping: exact, restitution: 0.3, friction: %.17g, "
        "friction-law: %s, resting-speed: none}\n"
        "run: {start: centred, revolutions: 0.25, samples: 1440, step: %.17g us, backends: "
        "[reference, ode]}\n",
        40.0 + 20.0 * draws[0], 120.0 + 40.0 * draws[1], 0.1 + 0.2 * draws[2],
        20.0 + 60.0 * draws[3], 20.0 + 60.0 * draws[4], 300.0 + 500.0 * draws[5],
        0.05 + 0.2 * draws[6], law, step_us);
}

// Each halving of the step is to leave a quarter of the error, in the mean of many.
static void its_error_is_of_second_order(void **state)
{
    (void)state;
    char text[TEXT_SIZE];
    char other[TEXT_SIZE];
    double exponents = 0.0;
    double least = INFINITY;
    const size_t count = sample_size(10);
    for (uint64_t seed = 1; seed <= count; seed++) {
        write_slider_crank(seed, "stick", 20.0, text);
        const double coarse = apart(text, text);
        write_slider_crank(seed, "stick", 5.0, text);
        const double fine = apart(text, text);
        write_slider_crank(seed, "regularized", 5.0, other);
        least = fmin(least, apart(text, other) / fine);
        exponents += 0.5 * log2(coarse / fine) / (double)count;
    }
    print_message("stick: order %.2f\n", exponents);
    assert_true(exponents > 1.5);
    // the control: another law of friction moves them otherwise
    assert_true(least > 100.0);
}

// A slider-crank of which all joints rub, with play at its crank pin, drawn likewise.
static void write_rubbing(uint64_t seed, const char *law, double friction, double step_us,
                          char *text)
{
    double draws[7];
    for (size_t i = 0; i < 7; i++) {
        draws[i] = 0.5 * (1.0 + lcg_draw(&seed));
    }
    const double crank = 40.0 + 20.0 * draws[0];
    const double slider = crank + 120.0 + 40.0 * draws[1];
    snprintf(text, TEXT_SIZE,
             "bodies:\n"
             "  crank: {mass: 0.3 kg, inertia: 100 kg mm^2, at: [0 mm, 0 mm]}\n"
             "  rod: {mass: 0.2 kg, inertia: 250 kg mm^2, at: [%.17g mm, 0 mm]}\n"
             "  slider: {mass: %.17g kg, inertia: 100 kg mm^2, at: [%.17g mm, 0 mm]}\n"
             "joints:\n"
             "  pivot: {between: [ground, crank], at: [0 mm, 0 mm], friction: %.17g, "
             "friction-radius: 15 mm}\n"
             "  pin: {between: [crank, rod], at: [%.17g mm, 0 mm], radial-clearance: %.17g um, "
             "width: 20 mm, friction: %.17g}\n"
             "  wrist: {between: [rod, slider], at: [%.17g mm, 0 mm], friction: %.17g, "
             "friction-radius: 10 mm}\n"
             "  guide: {between: [ground, slider], at: [%.17g mm, 0 mm], along: 0 deg, friction: "
             "%.17g, friction-length: %.17g mm}\n"
             "drive: {joint: pivot, speed: %.17g rpm}\n"
             "contact: {stiffness: 2e10 N/m^1.5, damping: exact, restitution: 0.3, "
             "friction-law: %s, resting-speed: none}\n"
             "run: {start: centred, revolutions: 0.3, samples: 432, step: %.17g us, backends: "
             "[reference, ode]}\n",
             0.5 * (crank + slider), 0.1 + 0.2 * draws[2], slider, friction, crank,
             20.0 + 60.0 * draws[3], 0.5 * friction, slider, friction, slider, 0.5 * friction,
             30.0 + 40.0 * draws[4], 300.0 + 500.0 * draws[5], law, step_us);
}

static void ideal_joints_rub_beside_one_with_play(void **state)
{
    (void)state;
    static const char *const LAWS[] = {"regularized", "stick"};
    char text[TEXT_SIZE];
    char other[TEXT_SIZE];
    for (size_t i = 0; i < 2; i++) {
        double exponents = 0.0;
        double least = INFINITY;
        const size_t count = sample_size(4);
        for (uint64_t seed = 1; seed <= count; seed++) {
            write_rubbing(seed, LAWS[i], 0.2, 100.0, text);
            const double coarse = apart(text, text);
            write_rubbing(seed, LAWS[i], 0.2, 25.0, text);
            const double fine = apart(text, text);
            write_rubbing(seed, LAWS[i], 0.18, 25.0, other);
            least = fmin(least, apart(text, other) / fine);
            exponents += 0.5 * log2(coarse / fine) / (double)count;
        }
        print_message("%s: order %.2f, less friction %.3g times as far off\n", LAWS[i], exponents,
                      least);
        assert_true(exponents > 1.5);
        // the control: a tenth less friction moves them otherwise
        assert_true(least > 20.0);
    }
}

// Two rods that hang, free but for friction, stick and slide: nothing but it slows them down.
static void write_rods(const char *law, double friction, const char *step, char *text)
{
    snprintf(
        text, TEXT_SIZE,
        "bodies:\n  one: {mass: 1 kg, inertia: 0.02 kg m^2, at: [200 mm, 0 mm]}\n"
        "  two: {mass: 0.5 kg, inertia: 0.01 kg m^2, at: [550 mm, 50 mm]}\n"
        "joints:\n"
        "  pin: {between: [ground, one], at: [0 m, 0 m], friction: 0.3, friction-radius: 20 mm}\n"
        "  elbow: {between: [one, two], at: [400 mm, 0 m], friction: %.17g, friction-radius: "
        "15 mm}\n"
        "gravity: 9.81 m/s^2\ncontact: {friction-law: %s}\n"
        "run: {duration: 1 s, samples: 500, %s, backends: [reference, ode]}\n",
        friction, law, step);
}

static void ideal_joints_alone_rub_with_order_two(void **state)
{
    (void)state;
    static const char *const LAWS[] = {"regularized", "stick"};
    char text[TEXT_SIZE];
    char other[TEXT_SIZE];
    for (size_t i = 0; i < 2; i++) {
        write_rods(LAWS[i], 0.2, "step: 1 ms", text);
        const double coarse = apart(text, text);
        write_rods(LAWS[i], 0.2, "step: 250 us", text);
        const double fine = apart(text, text);
        write_rods(LAWS[i], 0.202, "step: 250 us", other);
        print_message("%s: %.2g, then %.2g\n", LAWS[i], coarse, fine);
        assert_true(coarse < 2e-5 && fine < coarse / 12.0);
        assert_true(apart(text, other) > 100.0 * fine);
        // a step that ODE chooses itself keeps what is asked for
        write_rods(LAWS[i], 0.2, "tolerance: 1e-5", text);
        assert_true(apart(text, text) < 1e-5);
    }
}

// Mechanisms that a generator drew. Of each the friction of one joint and the step are open.
typedef struct Drawn {
    const char *name;
    const char *format;
    double friction;
} Drawn;

#define DRAWN_RUN(duration)                                                                        \
    "run: {duration: " duration ", samples: 500, start: centred, step: %.17g us, "                 \
    "backends: [reference, ode]}\n"

static const Drawn DRAWN[] = {
    {"begins to stick at a dead centre",
     "bodies:\n"
     "  crank: {mass: 0.127 kg, inertia: 6.61e-05 kg m^2, at: [7.18 mm, 31 mm]}\n"
     "  block: {mass: 1.81 kg, inertia: 2.24e-4 kg m^2, at: [14.4 mm, 62 mm]}\n"
     "  rocker: {mass: 1.96 kg, inertia: 0.0206 kg m^2, at: [-57.7 mm, -6.57 mm]}\n"
     "joints:\n"
     "  main: {between: [ground, crank], at: [0 m, 0 m]}\n"
     "  pin: {between: [crank, block], at: [14.4 mm, 62 mm], friction: 0.32, friction-radius: 7.5 "
     "mm, breakaway-ratio: 1.2}\n"
     "  pivot: {between: [ground, rocker], at: [-129.8 mm, -75.2 mm], friction-torque: 0.12 N m}\n"
     "  slot: {between: [rocker, block], at: [14.4 mm, 62 mm], along: 0.7608 rad, friction: "
     "%.17g, presliding: 50 um}\n"
     "drive: {joint: main, stall-torque: -3.6 N m, no-load-speed: -275 rpm}\n"
     "contact: {friction-law: stick}\n" DRAWN_RUN("0.25 s"),
     0.16},
    {"rubs beside a motor, which damps",
     "bodies:\n"
     "  crank: {mass: 0.38 kg, inertia: 1.114e-4 kg m^2, at: [-6.9 mm, 21.7 mm]}\n"
     "  block: {mass: 1.36 kg, inertia: 1.745e-4 kg m^2, at: [-13.8 mm, 43.5 mm]}\n"
     "  rocker: {mass: 1.12 kg, inertia: 0.0112 kg m^2, at: [-13.5 mm, 96.5 mm]}\n"
     "joints:\n"
     "  main: {between: [ground, crank], at: [0 m, 0 m]}\n"
     "  pin: {between: [crank, block], at: [-13.8 mm, 43.5 mm], friction: 0.166, friction-radius: "
     "11 mm}\n"
     "  pivot: {between: [ground, rocker], at: [-13.2 mm, 149.4 mm]}\n"
     "  slot: {between: [rocker, block], at: [-13.8 mm, 43.5 mm], along: -1.5769 rad, friction: "
     "%.17g}\n"
     "drive: {joint: main, stall-torque: 2.78 N m, no-load-speed: 612 rpm}\n" DRAWN_RUN("0.2 s"),
     0.188},
    {"begins on the other face of its guide",
     "bodies:\n"
     "  lever: {mass: 1.58 kg, inertia: 0.0284 kg m^2, at: [-81 mm, 126.3 mm]}\n"
     "  block: {mass: 1.73 kg, inertia: 3.69e-4 kg m^2, at: [-108 mm, 168.3 mm]}\n"
     "  bob: {mass: 1.24 kg, inertia: 1.79e-3 kg m^2, at: [-200.9 mm, 244.3 mm]}\n"
     "joints:\n"
     "  pivot: {between: [ground, lever], at: [0 m, 0 m]}\n"
     "  slot: {between: [lever, block], at: [-108 mm, 168.3 mm], along: 2.1412 rad, friction: "
     "%.17g}\n"
     "  hang: {between: [block, bob], at: [-108 mm, 168.3 mm]}\n"
     "springs: {s: {between: [lever, block], at-a: [0 m, 0 m], at-b: [-108 mm, 168.3 mm], "
     "stiffness: 2800 N/m, damping: 0.17 N s/m}}\n"
     "contact: {friction-law: stick}\n" DRAWN_RUN("0.1 s"),
     0.152},
    {"begins to stick while a limit presses",
     "bodies:\n"
     "  block: {mass: 1.62 kg, inertia: 0.00256 kg m^2, at: [0 m, 0 m]}\n"
     "  arm: {mass: 0.487 kg, inertia: 0.00187 kg m^2, at: [5.66 mm, 80.6 mm]}\n"
     "joints:\n"
     "  way: {between: [ground, block], at: [-8.6 mm, -16.9 mm], along: -1.2458 rad, low: -22.6 "
     "mm, high: 11.2 mm, stiffness: 1.09e5 N/m, viscous-coefficient: 52 N s/m}\n"
     "  hip: {between: [block, arm], at: [0 m, 0 m], low: -0.346 rad, high: 0.397 rad, stiffness: "
     "8440 N m/rad, viscous-coefficient: 0.275 N m s/rad, friction: %.17g, friction-radius: 22.8 "
     "mm, breakaway-ratio: 1.45, presliding: 70 um}\n"
     "drive: {joint: way, force: {amplitude: 56.3 N, frequency: 7.55 Hz}}\n"
     "contact: {friction-law: stick}\n" DRAWN_RUN("0.15 s"),
     0.399},
    {"rubs where a limit knocks on a chain",
     "bodies:\n"
     "  l0: {mass: 0.262 kg, inertia: 4.14e-4 kg m^2, at: [-18.4 mm, -63.2 mm]}\n"
     "  l1: {mass: 0.27 kg, inertia: 5.34e-4 kg m^2, at: [-1 mm, -191.1 mm]}\n"
     "  l2: {mass: 0.22 kg, inertia: 7.67e-4 kg m^2, at: [117.1 mm, -260.2 mm]}\n"
     "  l3: {mass: 0.37 kg, inertia: 0.00286 kg m^2, at: [57.5 mm, -344.2 mm]}\n"
     "joints:\n"
     "  j0: {between: [ground, l0], at: [0 m, 0 m]}\n"
     "  j1: {between: [l0, l1], at: [-36.9 mm, -126.3 mm], low: -0.233 rad, high: 0.304 rad, "
     "stiffness: 2.01e4 N m/rad, viscous-coefficient: 0.19 N m s/rad}\n"
     "  j2: {between: [l1, l2], at: [34.9 mm, -255.8 mm], friction: %.17g, friction-radius: 13.9 "
     "mm}\n"
     "  j3: {between: [l2, l3], at: [199.3 mm, -264.5 mm]}\n" DRAWN_RUN("0.062 s"),
     0.292},
};

static double drawn_apart(const Drawn *drawn, double step_us, double share)
{
    char text[TEXT_SIZE];
    char other[TEXT_SIZE];
    snprintf(text, TEXT_SIZE, drawn->format, drawn->friction, step_us);
    snprintf(other, TEXT_SIZE, drawn->format, share * drawn->friction, step_us);
    return apart(text, other);
}

// Each was off by the same at any step, of first order, or beyond all bounds.
static void drawn_mechanisms_have_order_two(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof DRAWN / sizeof *DRAWN; i++) {
        const double coarse = drawn_apart(&DRAWN[i], 100.0, 1.0);
        const double fine = drawn_apart(&DRAWN[i], 25.0, 1.0);
        print_message("%s: %.2g, then %.2g\n", DRAWN[i].name, coarse, fine);
        assert_true(coarse < 5e-5 && fine < 4e-6 && fine < coarse / 8.0);
        // the control: a hundredth more friction moves them otherwise
        assert_true(drawn_apart(&DRAWN[i], 25.0, 1.01) > 20.0 * fine);
    }
}

// All that moves is given by the drive: nothing is on the bristles, which are not damped, and the
// wrist turns back at 90 degrees. A bend a rounding beyond its limit once had it stick and yield
// for ever there.
static void joints_of_a_driven_loop_stick_and_turn_back(void **state)
{
    (void)state;
    static const char TEXT[] =
        "bodies:\n"
        "  crank: {mass: 0.5 kg, inertia: 2e-4 kg m^2, at: [25 mm, 0 mm]}\n"
        "  rod: {mass: 0.3 kg, inertia: 4e-4 kg m^2, at: [110 mm, 0 mm]}\n"
        "  slider: {mass: 0.4 kg, inertia: 1e-4 kg m^2, at: [170 mm, 0 mm]}\n"
        "joints:\n"
        "  pivot: {between: [ground, crank], at: [0 mm, 0 mm], friction: 0.2, friction-radius: 10 "
        "mm}\n"
        "  pin: {between: [crank, rod], at: [50 mm, 0 mm], friction: 0.2, friction-radius: 8 mm}\n"
        "  wrist: {between: [rod, slider], at: [170 mm, 0 mm], friction: 0.15, friction-radius: 6 "
        "mm}\n"
        "  guide: {between: [ground, slider], at: [170 mm, 0 mm], along: 0 deg, friction: 0.1, "
        "friction-length: 40 mm}\n"
        "drive: {joint: pivot, speed: 600 rpm}\ncontact: {friction-law: stick}\n"
        "run: {revolutions: 1, samples: 100, step: 100 us, backends: [reference, ode]}\n";
    assert_true(apart(TEXT, TEXT) < 1e-8);
}

static void friction_without_an_answer_is_refused_in_ode(void **state)
{
    (void)state;
    static const char FORMAT[] =
        "bodies:\n  rod: {mass: 1 kg, inertia: 0.001 kg m^2, at: [0.3 m, 0 m]}\n"
        "joints:\n  pin: {between: [ground, rod], at: [0 m, 0 m], friction: %.17g, "
        "friction-radius: 500 mm, friction-law: stick}\ngravity: 9.80665 m/s^2\n"
        "run: {duration: 1 ms, samples: 2, step: 1 us, backends: [ode]}\n";
    // a friction of 1 N m changes the reaction by m l / (I + m l^2)
    const double most = (0.001 + 0.09) / 0.3 / 0.5;
    for (int i = 0; i < 2; i++) {
        char text[TEXT_SIZE];
        snprintf(text, sizeof text, FORMAT, most * (i == 0 ? 1.0 - 1e-3 : 1.0 + 1e-9));
        const Scenario scenario = case_of(text);
        Trajectory *run =
            run_scenario(&scenario, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
        assert_int_equal(run->is_complete, i == 0);
        assert_true(i == 0 || strstr(run->message, "friction of joint pin has no single answer"));
        trajectory_destroy(run);
    }
}

static void a_scheme_without_bristles_is_refused(void **state)
{
    (void)state;
    static const char *const SETTINGS[] = {"ode.map=midpoint"};
    char text[TEXT_SIZE];
    Scenario scenario;
    Err err = {0};
    write_slider_crank(1, "stick", 20.0, text);
    assert_false(casefile_load_text("case.yaml", text, strlen(text), SETTINGS, 1, &scenario, &err));
    assert_non_null(strstr(err.text, "ode.map: impulse"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lever_holds_where_the_reference_holds_it),
        cmocka_unit_test(its_error_is_of_second_order),
        cmocka_unit_test(ideal_joints_rub_beside_one_with_play),
        cmocka_unit_test(ideal_joints_alone_rub_with_order_two),
        cmocka_unit_test(drawn_mechanisms_have_order_two),
        cmocka_unit_test(joints_of_a_driven_loop_stick_and_turn_back),
        cmocka_unit_test(friction_without_an_answer_is_refused_in_ode),
        cmocka_unit_test(a_scheme_without_bristles_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
