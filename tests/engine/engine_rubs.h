// Holds the friction of ideal joints in an engine against the reference and ODE.
#pragma once

#include "engine_outcome.h"

enum { RUBS_TEXT = 2048 };

// A crank that turns a rod and a slider by a torque, at any angle of the whole, all joints rubbing;
// of every second one the crank's pin has play.
static inline Scenario random_rubbing(unsigned seed, const char *law, double share, double step_s)
{
    const bool is_loose = seed % 2 == 0;
    Turned turned[7];
    const double angle = drawn(&seed, -3.0, 3.0);
    for (size_t i = 0; i < sizeof turned / sizeof *turned; i++) {
        turned[i].angle = angle;
    }
    const double crank = drawn(&seed, 40.0, 60.0);
    const double start = drawn(&seed, 0.3, 2.8);
    const double off = drawn(&seed, -10.0, 10.0);
    const double rod = drawn(&seed, 120.0, 160.0);
    const double pin[2] = {crank * cos(start), crank * sin(start)};
    const double end = pin[0] + sqrt(rod * rod - (pin[1] - off) * (pin[1] - off));
    char loose[128] = "friction-radius: 8 mm";
    if (is_loose) {
        snprintf(loose, sizeof loose, "radial-clearance: %.15g um, width: 20 mm",
                 drawn(&seed, 20.0, 80.0));
    }
    char text[RUBS_TEXT];
    int size = snprintf(
        text, sizeof text,
        "bodies:\n  crank: {mass: 0.3 kg, inertia: 400 kg mm^2, at: %s, angle: %.15g rad}\n"
        "  rod: {mass: 0.2 kg, inertia: 250 kg mm^2, at: %s}\n"
        "  slider: {mass: %.15g kg, inertia: 100 kg mm^2, at: %s}\n",
        turned_point(&turned[0], 0.3 * pin[0], 0.3 * pin[1]), start,
        turned_point(&turned[1], 0.5 * (pin[0] + end), 0.5 * (pin[1] + off)),
        drawn(&seed, 0.1, 0.3),
        turned_point(&turned[2], end + drawn(&seed, -5.0, 5.0), off + drawn(&seed, -5.0, 5.0)));
    size += snprintf(
        text + size, sizeof text - (size_t)size,
        "joints:\n"
        "  pivot: {between: [ground, crank], at: %s, friction: %.15g, friction-radius: 12 mm}\n"
        "  pin: {between: [crank, rod], at: %s, friction: %.15g, %s}\n"
        "  wrist: {between: [rod, slider], at: %s, friction: %.15g, friction-radius: 10 mm}\n"
        "  guide: {between: [ground, slider], at: %s, along: %.15g rad, friction: %.15g, "
        "friction-length: %.15g mm}\n",
        turned_point(&turned[3], 0.0, 0.0), share * drawn(&seed, 0.1, 0.3),
        turned_point(&turned[4], pin[0], pin[1]), share * drawn(&seed, 0.1, 0.3), loose,
        turned_point(&turned[5], end, off), share * drawn(&seed, 0.1, 0.3),
        turned_point(&turned[6], end, off), angle, share * drawn(&seed, 0.05, 0.15),
        drawn(&seed, 30.0, 70.0));
    snprintf(text + size, sizeof text - (size_t)size,
             "drive: {joint: pivot, torque: %.15g N m}\n"
             "gravity: [%.15g m/s^2, %.15g m/s^2]\n"
             "contact: {stiffness: 2e10 N/m^1.5, damping: exact, restitution: 0.3, friction-law: "
             "%s, resting-speed: none}\n"
             "run: {start: centred, duration: 25 ms, samples: 250, step: %.15g s}\n",
             drawn(&seed, 2.0, 4.0), 9.81 * sin(angle), -9.81 * cos(angle), law, step_s);
    Scenario read;
    Err err = {0};
    if (!casefile_load_text("rubs", text, strlen(text), NULL, 0, &read, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&read);
}

static inline double error_to(Trajectory *run, const Trajectory *truth)
{
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    const TrajectoryError error = error_against(run, truth, INFINITY);
    trajectory_destroy(run);
    return error.max;
}

// Friction of all joints, regularized and that holds, contacts within the step: each as good as
// ODE's own up to a factor of 3 at 20 and 10 us, in the mean at the order of the scheme. The
// control: a tenth less friction.
static inline void hold_random_rubs(const char *engine, unsigned seed, unsigned count)
{
    static const char *const LAWS[] = {"regularized", "stick"};
    static const double STEPS[] = {20e-6, 10e-6};
    const EngineDriver driver = engine_named(engine);
    for (size_t law = 0; law < 2; law++) {
        double order = 0.0;
        for (unsigned i = seed; i < seed + count; i++) {
            double errors[2];
            Scenario scenario = random_rubbing(i, LAWS[law], 1.0, STEPS[0]);
            Trajectory *truth = run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
            for (size_t k = 0; k < 2; k++) {
                scenario.run.step = STEPS[k];
                const double ode =
                    error_to(run_scenario(&scenario, registry_solver(BACKEND_ODE), NOBODY), truth);
                errors[k] =
                    error_to(engine_run(&driver, "kernel", &scenario, LIMIT_S, NULL), truth);
                print_message("# %s, %s %u, %g us: %.2g, ODE %.2g\n", engine, LAWS[law], i,
                              1e6 * STEPS[k], errors[k], ode);
                if (!(errors[k] <= 3.0 * ode)) {
                    fail_msg("%s %u at %g us: %g against ODE's %g", LAWS[law], i, 1e6 * STEPS[k],
                             errors[k], ode);
                }
            }
            order += log2(errors[0] / errors[1]) / count;
            const Scenario less = random_rubbing(i, LAWS[law], 0.9, STEPS[1]);
            const double control =
                error_to(engine_run(&driver, "kernel", &less, LIMIT_S, NULL), truth);
            if (!(control > 20.0 * errors[1])) {
                fail_msg("%s %u: less friction is off by %g, all of it by %g", LAWS[law], i,
                         control, errors[1]);
            }
            trajectory_destroy(truth);
        }
        print_message("# %s, %s: order %.2f\n", engine, LAWS[law], order);
        assert_true(order > 1.5);
    }
}

// Steady friction of a pivot and a slider: a torque and a force in ways that know forces alone, at
// the order of the way, whose error at a step is known; friction that grows is refused there, and
// so is what holds. The control: a tenth less.
static inline void hold_drags(const char *engine, const char *way, double step_s, double order,
                              double error)
{
    static const char TEXT[] =
        "bodies:\n"
        "  arm: {mass: 1 kg, inertia: 0.02 kg m^2, at: [0.2 m, 0 m]}\n"
        "  bead: {mass: 0.5 kg, inertia: 0.01 kg m^2, at: [0.3 m, 0 m]}\n"
        "joints:\n"
        "  pin: {between: [ground, arm], at: [0 m, 0 m], friction-torque: 0.5 N m, friction-speed: "
        "20 mm/s}\n"
        "  rail: {between: [arm, bead], at: [0.3 m, 0 m], along: 0 deg, friction-force: 1 N, "
        "friction-speed: 0.5 m/s}\n"
        "gravity: 9.81 m/s^2\nrun: {duration: 0.2 s, samples: 100}\n";
    static const char *const OTHERS[] = {"joints.pin.friction-torque=0.45 N m",
                                         "joints.pin.friction-law=stick",
                                         "joints.pin.breakaway-ratio=1.2"};
    Scenario read[3];
    Err err = {0};
    for (size_t i = 0; i < 3; i++) {
        const char *const *change = i > 0 ? &OTHERS[i - 1] : NULL;
        const size_t changes = i; // the first by itself, or the other two
        if (!casefile_load_text("drags", TEXT, strlen(TEXT), change, changes, &read[i], &err)) {
            fail_msg("%s", err.text);
        }
    }
    Scenario scenario = kept_instead(&read[0]);
    Scenario less = kept_instead(&read[1]);
    Scenario holds = kept_instead(&read[2]);
    const Refined found = refined(engine, way, &scenario, step_s, 0.5 * step_s);
    if (!(found.order > order - 0.3) || !(found.coarse < error)) {
        fail_msg("%s %s: order %g, error %g", engine, way, found.order, found.coarse);
    }
    less.run.step = holds.run.step = 0.5 * step_s;
    assert_true(omega_error(engine, way, &less, &scenario) > 20.0 * found.fine);
    const EngineDriver driver = engine_named(engine);
    EngineSaid said;
    Trajectory *run = engine_run(&driver, way, &holds, LIMIT_S, &said);
    assert_true(said.is_refused && !run->is_complete);
    assert_non_null(strstr(run->message, "friction of an ideal joint that holds (joint 'pin')"));
    trajectory_destroy(run);
    scenario = random_rubbing(1, "regularized", 1.0, step_s);
    run = engine_run(&driver, way, &scenario, LIMIT_S, &said);
    assert_true(said.is_refused);
    assert_non_null(strstr(run->message, "friction of an ideal joint (joint 'pivot')"));
    trajectory_destroy(run);
}
