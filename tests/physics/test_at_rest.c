// Is a mechanism that is at rest in equilibrium found at rest, and judged as such, at any step?
//
// Outside truth: statics. What hangs straight down below its pivots, or on a spring stretched by
// its weight, stays where it is. A pin dropped onto the wall of its hole by nothing comes to rest
// at the depth m g / k. Control: a pendulum released 1e-6 rad off swings as cos(w t), and is judged
// on that.
#include "close.h"

#include "base/lcg.h"
#include "casefile/casefile.h"
#include "measure/chosen_run.h"
#include "measure/error.h"

#include <stdio.h>
#include <string.h>

enum { TEXT_SIZE = 4096, RANDOM_COUNT = 9, LINK_MOST = 4 };

// m/s: nothing moves
static const double STILL = 1e-11;

// m: what points some metres from the origin are rounded to, which ODE takes back in one step
static const double PLACED = 4e-15;

static const double STEPS[] = {1e-3, 1e-6, 0.0};

static const char PENDULUM[] =
    "bodies:\n"
    "  bob: {mass: 1 kg, inertia: 0.01 kg m^2, at: [100 mm, -400 mm], angle: -90 deg}\n"
    "joints:\n"
    "  pivot: {between: [ground, bob], at: [100 mm, 300 mm]}\n";

static const char PARALLELOGRAM[] =
    "bodies:\n"
    "  left: {mass: 1 kg, inertia: 0.08 kg m^2, at: [0.1 m, -0.2 m], angle: -90 deg}\n"
    "  coupler: {mass: 1 kg, inertia: 0.08 kg m^2, at: [0.6 m, -0.7 m]}\n"
    "  right: {mass: 1 kg, inertia: 0.08 kg m^2, at: [1.1 m, -0.2 m], angle: -90 deg}\n"
    "joints:\n"
    "  a: {between: [ground, left], at: [0.1 m, 0.3 m]}\n"
    "  b: {between: [left, coupler], at: [0.1 m, -0.7 m]}\n"
    "  c: {between: [coupler, right], at: [1.1 m, -0.7 m]}\n"
    "  d: {between: [ground, right], at: [1.1 m, 0.3 m]}\n";

static const char TRAPEZOID[] =
    "bodies:\n"
    "  left: {mass: 1 kg, inertia: 0.08 kg m^2, at: [0.15 m, -0.4 m]}\n"
    "  coupler: {mass: 1 kg, inertia: 0.08 kg m^2, at: [0.5 m, -0.8 m]}\n"
    "  right: {mass: 1 kg, inertia: 0.08 kg m^2, at: [0.85 m, -0.4 m]}\n"
    "joints:\n"
    "  a: {between: [ground, left], at: [0 m, 0 m]}\n"
    "  b: {between: [left, coupler], at: [0.3 m, -0.8 m]}\n"
    "  c: {between: [coupler, right], at: [0.7 m, -0.8 m]}\n"
    "  d: {between: [ground, right], at: [1 m, 0 m]}\n";

// 2 kg stretch 500 N/m by 39.2266 mm
static const char SPRUNG[] =
    "bodies:\n"
    "  mass: {mass: 2 kg, inertia: 0.01 kg m^2, at: [0 m, -0.5 m]}\n"
    "joints:\n"
    "  line: {between: [ground, mass], at: [0 m, 0 m], along: 90 deg}\n"
    "springs:\n"
    "  spring: {between: [ground, mass], at-a: [0 m, 0 m], at-b: [0 m, -0.5 m],\n"
    "           stiffness: 500 N/m, length: 460.7734 mm}\n";

// half a period of the contact is 10 us at the most, and a rebound has a tenth of the speed: the
// sample after 5 ms finds the pin at rest
static const char PRESSED[] =
    "bodies:\n"
    "  bob: {mass: 1 kg, inertia: 0.01 kg m^2, at: [100 mm, -200 mm]%s}\n"
    "joints:\n"
    "  hole: {between: [ground, bob], at: [100 mm, 300 mm], hole: 10.2 mm, pin: 10 mm%s,\n"
    "         start: [0 um, -100 um]}\n"
    "contact: {stiffness: 1e9 N/m, restitution: 0.1}\n";

// A case of those bodies and joints, without a drive, for scenario_free.
static Scenario rest_load(const char *mechanism, const char *space)
{
    char text[2 * TEXT_SIZE];
    snprintf(text, sizeof text,
             "title: At rest\n%s%srun: {duration: 100 ms, samples: 200, backends: [ode]}\n", space,
             mechanism);
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("rest.yaml", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return scenario;
}

// The speed of the fastest point of all bodies from a time on, m/s.
static double fastest(const Trajectory *run, double from_s)
{
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        for (size_t i = 0; run->times[k] >= from_s && i < run->body_count; i++) {
            const Motion *motion = trajectory_motion(run, k, i);
            const double speed = vec2_length(motion->velocity);
            largest = fmax(largest, speed + fabs(motion->omega) * run->reach[i]);
        }
    }
    return largest;
}

// Runs it at a millisecond, a microsecond, and a step that is chosen.
static void stays(Scenario *scenario, double from_s)
{
    Truth truth = truth_make(scenario, (RunWatch){NULL, NULL});
    assert_string_equal(truth.message, "");
    assert_false(truth.is_limited);
    assert_true(fastest(truth.trajectory, from_s) < STILL);
    for (size_t i = 0; i < sizeof STEPS / sizeof *STEPS; i++) {
        scenario->run.step = STEPS[i];
        Trajectory *run =
            backend_run(scenario, BACKEND_ODE, &truth, (ChosenWatch){.begin = NULL}, NULL);
        if (!run->is_complete) {
            fail_msg("%s", run->message);
        }
        TrajectoryError error = error_against(run, truth.trajectory, truth.horizon_s);
        assert_true(error.is_known);
        assert_false(error_fail_unstable(run, truth.trajectory, &error));
        const double moves = STILL + (STEPS[i] > 0.0 ? PLACED / STEPS[i] : 0.0);
        assert_true(fastest(run, from_s) < moves);
        assert_true(error.max <= moves / truth.trajectory->floor.speed);
        assert_true(error.max < 1e-2);
        trajectory_destroy(run);
    }
    truth_finish(&truth);
    scenario_free(scenario);
}

static void stays_at_rest(const char *mechanism)
{
    Scenario scenario = rest_load(mechanism, "");
    stays(&scenario, 0.0);
}

static void a_pendulum_hangs(void **state)
{
    (void)state;
    stays_at_rest(PENDULUM);
}

static void a_parallelogram_hangs(void **state)
{
    (void)state;
    stays_at_rest(PARALLELOGRAM);
}

static void a_trapezoid_hangs(void **state)
{
    (void)state;
    stays_at_rest(TRAPEZOID);
}

static void a_mass_rests_on_its_spring(void **state)
{
    (void)state;
    stays_at_rest(SPRUNG);
}

static void a_pin_rests_in_its_hole(void **state)
{
    (void)state;
    const char *const inertias[] = {"", ", inertia-x: 0.01 kg m^2, inertia-y: 0.01 kg m^2"};
    const char *const widths[] = {"", ", width: 20 mm"};
    const char *const spaces[] = {"", "space: spatial\n"};
    for (int i = 0; i < 2; i++) {
        char text[TEXT_SIZE];
        snprintf(text, sizeof text, PRESSED, inertias[i], widths[i]);
        Scenario scenario = rest_load(text, spaces[i]);
        stays(&scenario, 5e-3);
    }
}

// A chain of links that hangs straight down from anywhere.
static void random_chain(unsigned seed, bool is_spatial, char text[TEXT_SIZE])
{
    uint64_t draws = lcg_stirred(seed);
    const int links = 1 + (int)(LINK_MOST * 0.5 * (1.0 + lcg_draw(&draws)));
    const double x = 2.0 * lcg_draw(&draws);
    double y = 2.0 * lcg_draw(&draws);
    size_t length = (size_t)snprintf(text, TEXT_SIZE, "bodies:\n");
    char joints[TEXT_SIZE / 2] = "joints:\n";
    size_t joints_length = strlen(joints);
    for (int i = 0; i < links; i++) {
        const double size = pow(10.0, -0.5 + 0.5 * lcg_draw(&draws));
        const double mass = pow(10.0, lcg_draw(&draws));
        const double centre = size * (0.5 + 0.4 * lcg_draw(&draws));
        char across[96] = "";
        snprintf(across, sizeof across, ", inertia-x: %.17g kg m^2, inertia-y: %.17g kg m^2",
                 0.1 * mass * size * size, 0.1 * mass * size * size);
        length += (size_t)snprintf(
            text + length, TEXT_SIZE - length,
            "  b%d: {mass: %.17g kg, inertia: %.17g kg m^2, at: [%.17g m, %.17g m], angle: %.17g "
            "deg%s}\n",
            i, mass, 0.1 * mass * size * size, x, y - centre, 180.0 * lcg_draw(&draws),
            is_spatial ? across : "");
        char above[8] = "ground";
        if (i > 0) {
            snprintf(above, sizeof above, "b%d", (i - 1) % 10);
        }
        joints_length += (size_t)snprintf(joints + joints_length, sizeof joints - joints_length,
                                          "  j%d: {between: [%s, b%d], at: [%.17g m, %.17g m]}\n",
                                          i, above, i, x, y);
        y -= size;
    }
    snprintf(text + length, TEXT_SIZE - length, "%s", joints);
}

static void random_chains_hang(void **state)
{
    (void)state;
    for (unsigned seed = 1; seed <= RANDOM_COUNT; seed++) {
        const bool is_spatial = seed % 3 == 0;
        char text[TEXT_SIZE];
        random_chain(seed, is_spatial, text);
        Scenario scenario = rest_load(text, is_spatial ? "space: spatial\n" : "");
        stays(&scenario, 0.0);
    }
}

// I = .01 + .49 kg m^2 about the pivot: w^2 = m g .7 / I.
static void a_pendulum_a_millionth_off_is_judged_on_its_swing(void **state)
{
    (void)state;
    static const double OFF = 1e-6;
    Scenario scenario = rest_load(PENDULUM, "");
    scenario.run.duration = 1.0;
    // turned about the pivot, which the body's frame says
    Body *bob = &scenario.linkage.bodies[0];
    bob->start.angle += OFF;
    bob->start.position = vec2_add(bob->start.position,
                                   (Vec2){0.7 * sin(OFF), 1.4 * sin(0.5 * OFF) * sin(0.5 * OFF)});
    Truth truth = truth_make(&scenario, (RunWatch){NULL, NULL});
    const double w = sqrt(9.80665 * 0.7 / (0.01 + 0.49));
    for (size_t k = 0; k < truth.trajectory->sample_count; k++) {
        const double omega = -OFF * w * sin(w * truth.trajectory->times[k]);
        // the reference is right to 1e-11 of the speed of a fall, a millionth of which this is
        assert_near(trajectory_motion(truth.trajectory, k, 0)->omega, omega, 1e-6 * OFF * w);
    }
    scenario.run.step = 0.0;
    Trajectory *run =
        backend_run(&scenario, BACKEND_ODE, &truth, (ChosenWatch){.begin = NULL}, NULL);
    assert_true(run->is_complete);
    TrajectoryError error = error_against(run, truth.trajectory, truth.horizon_s);
    assert_true(error.max < scenario.run.tolerance && !error.is_floor);
    // control: a motion that is 1e-3 too large is off by that, and one that stands still by 1
    for (size_t k = 0; k < run->sample_count; k++) {
        run->motions[k] = *trajectory_motion(truth.trajectory, k, 0);
        run->motions[k].omega *= 1.001;
    }
    assert_close(error_against(run, truth.trajectory, INFINITY).max, 1e-3, 1e-6);
    memset(run->motions, 0, run->sample_count * sizeof *run->motions);
    assert_close(error_against(run, truth.trajectory, INFINITY).max, 1.0, 1e-6);
    trajectory_destroy(run);
    truth_finish(&truth);
    scenario_free(&scenario);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pendulum_hangs),
        cmocka_unit_test(a_parallelogram_hangs),
        cmocka_unit_test(a_trapezoid_hangs),
        cmocka_unit_test(a_mass_rests_on_its_spring),
        cmocka_unit_test(a_pin_rests_in_its_hole),
        cmocka_unit_test(random_chains_hang),
        cmocka_unit_test(a_pendulum_a_millionth_off_is_judged_on_its_swing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
