// Does a damper in the gap of a joint take what its closed form says, apart and in contact, in the
// reference and in ODE?
#include "bushed.h"
#include "load_case.h"
#include "ode_error.h"

#include <string.h>

static Scenario scenario_of(const char *text)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("gap", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s\n%s", err.text, text);
    }
    scenario.run.start = START_CENTRED;
    return kept_instead(&scenario);
}

// What moves in a gap, with the coefficient of its damper, and how fast its rate dies away, 1/s.
typedef struct Apart {
    const char *text;
    double decay;
    // its rate, of the bodies' speeds at the end: of vx, vy, omega of each
    double row[2][3];
    double start; // m/s or rad/s
    double end_s;
} Apart;

// cos^2 of a pressure angle of 20 deg
static const double SLANT = 0.8830222215594890;

static const char HINGE[] =
    "bodies: {lever: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0 m, 0 m], spin: 3 rad/s}}\n"
    "joints: {hinge: {between: [lever, ground], at: [0 m, 0 m], low: -40 deg, high: 40 deg,\n"
    "                 stiffness: 1e4 N m/rad, gap-damping: 0.02 N m s/rad}}\n"
    "gravity: 0 m/s^2\nrun: {duration: 0.15 s, samples: 50}\n";
static const char SLIDER[] =
    "bodies: {block: {mass: 2 kg, inertia: 0.01 kg m^2, at: [0 m, 0 m], velocity: [0.3 m/s, 0.4 "
    "m/s]}}\n"
    "joints: {rail: {between: [ground, block], at: [0 m, 0 m], along: 53.13010235415598 deg,\n"
    "                low: -1 m, high: 1 m, stiffness: 1e6 N/m, gap-damping: 9 N s/m}}\n"
    "gravity: 0 m/s^2\nrun: {duration: 0.15 s, samples: 50}\n";
static const char GEARS[] =
    "bodies:\n"
    "  pinion: {mass: 0.2 kg, inertia: 4e-5 kg m^2, at: [0 m, 0 m], spin: 8 rad/s}\n"
    "  wheel:  {mass: 1 kg, inertia: 9e-4 kg m^2, at: [0.08 m, 0 m]}\n"
    "joints:\n"
    "  a: {between: [ground, pinion], at: [0 m, 0 m]}\n"
    "  b: {between: [ground, wheel], at: [0.08 m, 0 m]}\n"
    "  mesh: {gears: [a, b], teeth: [20, 60], backlash: 40 mm, stiffness: 1e7 N/m,\n"
    "         pressure-angle: 20 deg, gap-damping: 1.5 N s/m}\n"
    "gravity: 0 m/s^2\nrun: {duration: 0.1 s, samples: 50}\n";
static const char RACK[] =
    "bodies:\n"
    "  bar:    {mass: 0.5 kg, inertia: 1e-3 kg m^2, at: [0 m, 0 m]}\n"
    "  pinion: {mass: 0.2 kg, inertia: 4e-5 kg m^2, at: [0 m, 0.02 m], spin: 8 rad/s}\n"
    "joints:\n"
    "  guide: {between: [ground, bar], at: [0 m, 0 m], along: 0 deg}\n"
    "  pivot: {between: [ground, pinion], at: [0 m, 0.02 m]}\n"
    "  mesh: {rack: [guide, pivot], backlash: 40 mm, stiffness: 1e7 N/m, gap-damping: 1.5 N s/m}\n"
    "gravity: 0 m/s^2\nrun: {duration: 0.1 s, samples: 50}\n";
static const char PIN[] =
    "bodies: {pin: {mass: 0.5 kg, inertia: 1e-3 kg m^2, at: [0 m, 0 m], velocity: [0.03 m/s, 0.04 "
    "m/s]}}\n"
    "joints: {hole: {between: [ground, pin], at: [0 m, 0 m], radial-clearance: 20 mm, pin: 40 mm,\n"
    "                stiffness: 1e6 N/m, gap-damping: 4 N s/m}}\n"
    "gravity: 0 m/s^2\nrun: {duration: 0.1 s, samples: 50}\n";

static const Apart APART[] = {
    {HINGE, 0.02 / 0.01, {{0.0, 0.0, 1.0}}, 3.0, 0.15},
    {SLIDER, 9.0 / 2.0, {{0.6, 0.8, 0.0}}, 0.5, 0.15},
    // m = r cos alpha, r = .02 and .06 m
    {GEARS,
     1.5 * SLANT *(0.02 * 0.02 / 4e-5 + 0.06 * 0.06 / 9e-4),
     {{0.0, 0.0, 0.02}, {0.0, 0.0, 0.06}},
     0.16,
     0.1},
    {RACK, 1.5 * (1.0 / 0.5 + 0.02 * 0.02 / 4e-5), {{-1.0, 0.0, 0.0}, {0.0, 0.0, 0.02}}, 0.16, 0.1},
    {PIN, 4.0 / 0.5, {{0.6, 0.8, 0.0}}, 0.05, 0.1},
};

static double rate_at_end(const Apart *apart, const Trajectory *run)
{
    double rate = 0.0;
    for (size_t i = 0; i < run->body_count; i++) {
        const Motion *at = trajectory_motion(run, run->sample_count - 1, i);
        rate += apart->row[i][0] * at->velocity.x + apart->row[i][1] * at->velocity.y +
                apart->row[i][2] * at->omega;
    }
    return rate;
}

// The error of the rate at the end, over that at the start; the energy must close.
static double apart_error(const Apart *apart, BackendKind backend, OdeStepping stepping,
                          double step_s)
{
    Scenario scenario = scenario_of(apart->text);
    scenario.ode.stepping = stepping;
    scenario.ode.map = stepping == ODE_PLAIN ? ODE_MAP_TEXTBOOK : ODE_MAP_IMPULSE;
    scenario.run.step = step_s;
    Trajectory *run = complete_run(&scenario, backend);
    const double truth = apart->start * exp(-apart->decay * apart->end_s);
    const double error = fabs(rate_at_end(apart, run) - truth) / apart->start;
    if (backend == BACKEND_REFERENCE) {
        assert_near(run->energy.residual / error_energy(run), 0.0, 1e-9);
    }
    trajectory_destroy(run);
    return error;
}

static void in_the_gap_the_rate_dies_away(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof APART / sizeof *APART; i++) {
        const Apart *apart = &APART[i];
        assert_near(apart_error(apart, BACKEND_REFERENCE, ODE_STAGGERED, 1e-3), 0.0, 1e-10);
        const double plain[] = {apart_error(apart, BACKEND_ODE, ODE_PLAIN, 2e-4),
                                apart_error(apart, BACKEND_ODE, ODE_PLAIN, 1e-4)};
        const double staggered[] = {apart_error(apart, BACKEND_ODE, ODE_STAGGERED, 2e-3),
                                    apart_error(apart, BACKEND_ODE, ODE_STAGGERED, 1e-3)};
        assert_near(ode_order(plain[0], plain[1], 2.0), 1.0, 0.1);
        assert_near(ode_order(staggered[0], staggered[1], 2.0), 2.0, 0.1);
        Apart other = *apart;
        other.decay *= 1.01;
        assert_true(apart_error(&other, BACKEND_REFERENCE, ODE_STAGGERED, 1e-3) > 1e-4);
    }
}

// Straight at the wall with friction none: the flight to it, x = v m / c (1 - e^(-c t / m)), the
// contact, d = (v / w) e^(-a t) sin w t with a = c / 2 m and w^2 = K / m - a^2, and the way back.
static void a_pin_meets_its_wall_through_the_film(void **state)
{
    (void)state;
    static const char TEXT[] = "bodies: {pin: {mass: 0.5 kg, inertia: 1e-3 kg m^2, at: [0 m, 0 m], "
                               "velocity: [0.6 m/s, 0.8 "
                               "m/s]}}\n"
                               "joints: {hole: {between: [ground, pin], at: [0 m, 0 m], "
                               "radial-clearance: 1 mm, pin: 40 mm,\n"
                               "                stiffness: 1e6 N/m, gap-damping: 60 N s/m}}\n"
                               "contact: {damping: none}\n"
                               "gravity: 0 m/s^2\nrun: {duration: 4 ms, samples: 50}\n";
    const double m = 0.5;
    const double c = 60.0;
    const double meeting = 1.0 - 1e-3 * c / m; // m/s, since v falls by c / m a metre
    const double meeting_s = -m / c * log(meeting);
    const double a = 0.5 * c / m;
    const double w = sqrt(1e6 / m - a * a);
    const double leaving = meeting * exp(-a * M_PI / w);
    const double left_s = 4e-3 - meeting_s - M_PI / w;
    const double end = -leaving * exp(-c / m * left_s);
    assert_true(left_s > 0.0);
    Scenario scenario = scenario_of(TEXT);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const Motion *at = trajectory_motion(run, run->sample_count - 1, 0);
    assert_near(0.6 * at->velocity.x + 0.8 * at->velocity.y, end, 1e-9);
    assert_near(run->energy.residual / error_energy(run), 0.0, 1e-9);
    trajectory_destroy(run);
    double errors[2];
    for (int i = 0; i < 2; i++) {
        scenario.run.step = i == 0 ? 4e-5 : 1e-5;
        run = complete_run(&scenario, BACKEND_ODE);
        at = trajectory_motion(run, run->sample_count - 1, 0);
        errors[i] = fabs(0.6 * at->velocity.x + 0.8 * at->velocity.y - end);
        trajectory_destroy(run);
    }
    assert_near(ode_order(errors[0], errors[1], 4.0), 2.0, 0.3);
    assert_true(errors[1] < 1e-5);
}

// A pin that stays apart moves as by a bushing that has a damper alone, on bodies that turn, too.
static void a_pin_in_its_film_is_a_damper_of_both_directions(void **state)
{
    (void)state;
    Bushed bushed = {.body_count = 2, .gravity = 0.0, .end_s = 0.1};
    bushed.bodies[0] = (BushedBody){1.0, 0.02, {0.1, 0.0, 0.0, 0.0, 0.0, 0.0}};
    bushed.bodies[1] = (BushedBody){0.5, 0.01, {0.3, 0.1, 0.5, 0.05, -0.03, 0.6}};
    bushed.mount_count = 2;
    bushed.mounts[0] = (BushedMount){
        .bodies = {BUSHED_GROUND, 0}, .at = {{0.0, 0.0}, {0.0, 0.0}}, .damping = {15.0, 15.0, 0.0}};
    bushed.mounts[1] =
        (BushedMount){.bodies = {1, 0}, .at = {{0.2, 0.0}, {0.2, 0.0}}, .damping = {8.0, 8.0, 0.0}};
    BushedTruth truth;
    assert_true(bushed_integrate(&bushed, &truth));
    static const char TEXT[] =
        "bodies:\n"
        "  one: {mass: 1 kg, inertia: 0.02 kg m^2, at: [0.1 m, 0 m]}\n"
        "  two: {mass: 0.5 kg, inertia: 0.01 kg m^2, at: [0.3 m, 0.1 m], angle: 0.5 rad,\n"
        "        velocity: [0.05 m/s, -0.03 m/s], spin: 0.6 rad/s}\n"
        "joints:\n"
        "  root: {between: [ground, one], at: [0 m, 0 m], radial-clearance: 30 mm, pin: 10 mm,\n"
        "         stiffness: 1e6 N/m, gap-damping: 15 N s/m}\n"
        "  knee: {between: [two, one], at: [0.2 m, 0 m], radial-clearance: 30 mm, pin: 10 mm,\n"
        "         stiffness: 1e6 N/m, gap-damping: 8 N s/m}\n"
        "gravity: 0 m/s^2\nrun: {duration: 0.1 s, samples: 50}\n";
    const Scenario scenario = scenario_of(TEXT);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    double states[12];
    for (size_t i = 0; i < 2; i++) {
        const Motion *at = trajectory_motion(run, run->sample_count - 1, i);
        const double numbers[6] = {at->position.x, at->position.y, at->angle,
                                   at->velocity.x, at->velocity.y, at->omega};
        memcpy(states + 6 * i, numbers, sizeof numbers);
    }
    trajectory_destroy(run);
    assert_near(bushed_apart(&bushed, states, &truth), 0.0, 1e-10);
    bushed.mounts[1].damping[1] *= 1.01;
    assert_true(bushed_integrate(&bushed, &truth));
    assert_true(bushed_apart(&bushed, states, &truth) > 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_the_gap_the_rate_dies_away),
        cmocka_unit_test(a_pin_meets_its_wall_through_the_film),
        cmocka_unit_test(a_pin_in_its_film_is_a_damper_of_both_directions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
