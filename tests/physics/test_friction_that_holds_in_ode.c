// Does ODE hold what friction holds, where it integrates contacts within its steps?
//
// The truth is the reference, which tests/physics/test_friction_that_holds.c holds against others.
// Regularized friction is the control: it creeps.
#include "complete_run.h"
#include "load_case.h"
#include "sample.h"

#include "base/lcg.h"
#include "measure/creep.h"

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

static Trajectory *run_text(const char *text, BackendKind backend)
{
    const Scenario scenario = case_of(text);
    return complete_run(&scenario, backend);
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
        cmocka_unit_test(a_scheme_without_bristles_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
