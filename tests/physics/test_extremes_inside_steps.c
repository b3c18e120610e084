// Are the extremes of a run those that its solver's states have between the ends of its steps?
//
// The truth is the same run, asked at very many instants of each of its records: what such a dense
// row of instants shows must not lie beyond the extreme that the run states, and the extreme not
// beyond what the instants let expect. Looks at one body or joint are compared with those at all.
#include "load_case.h"

#include "../measure/random_case.h"
#include "../measure/random_draw.h"

#include "base/zeroed.h"
#include "measure/chosen_run.h"
#include "run/registry.h"
#include "run/settle.h"
#include "run/tracer.h"

#include <string.h>

static const RunWatch NOBODY = {NULL, NULL};

enum { INSTANTS = 24 }; // of a record

// What a dense row of instants shows, and what lets the run have its own extremes.
typedef struct Dense {
    const Solver *solver;
    const void *state;
    const Linkage *linkage;
    void *tracer;
    Sample all;
    Sample one;
    double (*omega)[2]; // by body, least and most; owned, as all
    double (*alpha)[2];
    double *force;    // by joint, most
    size_t different; // looks at one that differ from those at all
    size_t looks;
} Dense;

static Dense dense; // of the run under way: probes have no context
static bool looks_inside;

static void *dense_begin(const Scenario *scenario, const Solver *solver, const void *state,
                         Recorder *recorder, const void *shared)
{
    const Linkage *linkage = &scenario->linkage;
    dense = (Dense){
        .solver = solver,
        .state = state,
        .linkage = linkage,
        .tracer =
            looks_inside ? TRACER_PROBE.begin(scenario, solver, state, recorder, shared) : NULL,
        .all = sample_create(linkage),
        .one = sample_create(linkage),
        .omega = zeroed(linkage->body_count, sizeof *dense.omega),
        .alpha = zeroed(linkage->body_count, sizeof *dense.alpha),
        .force = zeroed(linkage->joint_count, sizeof *dense.force),
    };
    for (size_t i = 0; i < linkage->body_count; i++) {
        dense.omega[i][0] = dense.alpha[i][0] = INFINITY;
        dense.omega[i][1] = dense.alpha[i][1] = -INFINITY;
    }
    return &dense;
}

static void widen(double range[2], double value)
{
    range[0] = fmin(range[0], value);
    range[1] = fmax(range[1], value);
}

// Looks at one thing that a record says has changed, beside the look at all.
static void compare_one(const StepRecord *step, double time_s, size_t number)
{
    const SolverSome *changed = step->changed;
    const bool is_body = number < changed->body_count;
    const size_t k =
        is_body ? changed->bodies[number] : changed->joints[number - changed->body_count];
    const SolverSome some = {is_body ? 1 : 0, is_body ? 0 : 1, &k, &k};
    dense.solver->observe_some(dense.state, time_s, &some, &dense.one);
    dense.looks++;
    if (is_body) {
        const size_t i = solver_body(step->part, k);
        dense.different += dense.one.bodies[i].alpha != dense.all.bodies[i].alpha ||
                           dense.one.bodies[i].omega != dense.all.bodies[i].omega;
    } else {
        const size_t i = solver_joint(step->part, k);
        dense.different += dense.one.joints[i].force != dense.all.joints[i].force ||
                           dense.one.joints[i].gap != dense.all.joints[i].gap;
    }
}

static void look_at(const StepRecord *step, double time_s)
{
    const SolverPart *part = step->part;
    (part != NULL ? dense.solver->observe_part : dense.solver->observe)(dense.state, time_s,
                                                                        &dense.all);
    for (size_t k = 0; k < solver_body_count(part, dense.linkage); k++) {
        const size_t i = solver_body(part, k);
        widen(dense.omega[i], dense.all.bodies[i].omega);
        widen(dense.alpha[i], dense.all.bodies[i].alpha);
    }
    for (size_t k = 0; k < solver_joint_count(part, dense.linkage); k++) {
        const size_t i = solver_joint(part, k);
        dense.force[i] = fmax(dense.force[i], dense.all.joints[i].force);
    }
}

static void dense_look(void *own, const StepRecord *step)
{
    (void)own;
    if (dense.tracer != NULL) {
        TRACER_PROBE.look(dense.tracer, step);
    }
    const double width_s = step->end_s - step->start_s;
    for (int k = 0; width_s > 0.0 && k < INSTANTS; k++) {
        const double time_s = step->start_s + (k + 0.5) / INSTANTS * width_s;
        look_at(step, time_s);
        if (step->changed != NULL) {
            const size_t count = step->changed->body_count + step->changed->joint_count;
            compare_one(step, time_s, (size_t)k * 7919 % count);
        }
    }
}

static void dense_end(void *own, Trajectory *trajectory)
{
    (void)own;
    if (dense.tracer != NULL) {
        TRACER_PROBE.end(dense.tracer, trajectory);
    }
    sample_free(&dense.all);
    sample_free(&dense.one);
}

static const RunProbe DENSE_PROBE = {dense_begin, dense_look, dense_end, NULL, NULL};

// How far the two are apart, of a signal's own range.
typedef struct Missed {
    double most;   // the dense instants lie beyond the extreme
    double beyond; // the extreme lies beyond them
} Missed;

// of the largest range of its kind: a signal that moves less is rounding beside it
static const double RANGE_LEAST = 1e-6;

static void note(Missed *missed, double shown, double stated, double range)
{
    missed->most = fmax(missed->most, (shown - stated) / range);
    missed->beyond = fmax(missed->beyond, (stated - shown) / range);
}

// Compares the two ends of a range.
static void note_both(Missed *missed, const double shown[2], const Extreme *least,
                      const Extreme *most, double scale)
{
    const double range = fmax(shown[1] - shown[0], RANGE_LEAST * scale);
    note(missed, shown[1], most->value, range);
    note(missed, -shown[0], -least->value, range);
}

static bool is_free(size_t body)
{
    return (int)body != linkage_driven_body(dense.linkage);
}

static Missed compare(const Trajectory *run)
{
    Missed missed = {0.0, 0.0};
    double omega = 0.0;
    double alpha = 0.0;
    double force = 0.0;
    for (size_t i = 0; i < run->body_count; i++) {
        omega = is_free(i) ? fmax(omega, dense.omega[i][1] - dense.omega[i][0]) : omega;
        alpha = is_free(i) ? fmax(alpha, dense.alpha[i][1] - dense.alpha[i][0]) : alpha;
    }
    for (size_t i = 0; i < run->joint_count; i++) {
        force = fmax(force, dense.force[i]);
    }
    for (size_t i = 0; i < run->body_count; i++) {
        const BodyExtremes *body = &run->bodies[i];
        if (is_free(i)) {
            note_both(&missed, dense.omega[i], &body->omega_min, &body->omega_max, omega);
            note_both(&missed, dense.alpha[i], &body->alpha_min, &body->alpha_max, alpha);
        }
    }
    for (size_t i = 0; i < run->joint_count; i++) {
        note(&missed, dense.force[i], run->joints[i].force_max.value,
             fmax(dense.force[i], RANGE_LEAST * force));
    }
    free(dense.omega);
    free(dense.alpha);
    free(dense.force);
    return missed;
}

static Missed measure(const Scenario *scenario, BackendKind backend, bool is_looking)
{
    looks_inside = is_looking;
    Trajectory *run = run_guarded(scenario, registry_solver(backend), NOBODY, &DENSE_PROBE, NULL);
    assert_string_equal(run->message, "");
    const Missed missed = compare(run);
    trajectory_destroy(run);
    return missed;
}

// A row of four-bars that share their uprights, let go; play in most of its joints.
static void write_row(uint64_t seed, FILE *file)
{
    enum { COUNT = 9 };
    Draw draw = draw_start(seed);
    const double angle = 0.5 * M_PI + draw_between(&draw, -0.3, 0.3);
    const double share = draw_between(&draw, 0.5, 1.2);
    const double x = cos(angle);
    const double y = sin(angle);
    fprintf(file, "bodies:\n");
    for (int i = 0; i <= COUNT; i++) {
        fprintf(file, "  u-%d: {mass: %.6g kg, inertia: 0.09 kg m^2, at: [%.17g m, %.17g m], ", i,
                draw_between(&draw, 0.5, 2.0), i + 0.5 * x, 0.5 * y);
        fprintf(file, "angle: %.17g rad}\n", angle);
        if (i < COUNT) {
            fprintf(file, "  c-%d: {mass: 1 kg, inertia: 0.08 kg m^2, at: [%.17g m, %.17g m]}\n", i,
                    i + 0.5 + x, y);
        }
    }
    fprintf(file, "joints:\n");
    for (int i = 0; i < 3 * COUNT + 1; i++) {
        const int n = i / 3;
        const char *play =
            draw_between(&draw, 0.0, 1.0) < share ? ", radial-clearance: 50 um, pin: 10 mm" : "";
        if (i % 3 == 0) {
            fprintf(file, "  f-%d: {between: [ground, u-%d], at: [%d m, 0 m]%s}\n", n, n, n, play);
        } else if (i % 3 == 1) {
            fprintf(file, "  l-%d: {between: [u-%d, c-%d], at: [%.17g m, %.17g m]%s}\n", n, n, n,
                    n + x, y, play);
        } else {
            fprintf(file, "  r-%d: {between: [c-%d, u-%d], at: [%.17g m, %.17g m]%s}\n", n, n,
                    n + 1, n + 1 + x, y, play);
        }
    }
    fprintf(file, "gravity: 9.81 m/s^2\n"
                  "contact: {stiffness: 1e8 N/m^1.5, restitution: 0.6}\n"
                  "run: {duration: 6 ms, samples: 10, step: 100 us}\n");
}

static Scenario drawn(void (*write)(uint64_t seed, FILE *file), uint64_t seed,
                      const char *const *settings, size_t count)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    assert_non_null(file);
    write(seed, file);
    fclose(file);
    const char *all[LOAD_OVERRIDE_MAX];
    const size_t used = of_one_start(settings, count, all);
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("random case", text, size, all, used, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    free(text);
    return kept_instead(&scenario);
}

// A solver with its settings, and how much of a signal's range its dense instants may lie beyond an
// extreme. Accelerations of impulse stepping jump between its steps, by their error: a maximum next
// to a jump may be missed by as much.
typedef struct Way {
    BackendKind backend;
    const char *settings[3];
    double missed_most;
    uint64_t seeds; // of each kind of random mechanism
} Way;

static const Way WAYS[] = {
    {BACKEND_ODE, {"ode.stepping=staggered", "ode.map=impulse", "ode.solver=direct"}, 2e-4, 1},
    {BACKEND_REFERENCE,
     {"ode.stepping=staggered", "ode.map=impulse", "reference.tolerance=3e-13"},
     1e-8,
     2},
    // steps that are a larger share of a swing
    {BACKEND_REFERENCE,
     {"ode.stepping=staggered", "ode.map=impulse", "reference.tolerance=1e-8"},
     1e-8,
     2},
};

enum { WAY_COUNT = sizeof WAYS / sizeof *WAYS };

// of a signal's range: the square of half the distance of two instants, where a record holds half a
// swing
static const double BEYOND_MOST = 0.01;

// The same run without looks inside its steps misses more than this.
static const double CONTROL_LEAST = 5e-4;

// Returns how many looks at one body or joint were compared with looks at all.
//
// Compares a run with its dense instants, and with itself as it is where nobody looks inside its
// steps: the control, which is to miss more.
static size_t ask(const Scenario *scenario, const Way *way, const char *name, double *control)
{
    const Missed missed = measure(scenario, way->backend, true);
    const size_t looks = dense.looks;
    assert_int_equal(dense.different, 0);
    const Missed without = measure(scenario, way->backend, false);
    if (!(missed.most <= way->missed_most && missed.beyond <= BEYOND_MOST)) {
        fail_msg("%s, %s: missed by %.3g, beyond by %.3g", name, OPTIONS_BACKENDS[way->backend],
                 missed.most, missed.beyond);
    }
    *control = fmax(*control, without.most);
    return looks;
}

static void rows_of_four_bars_show_their_extremes(void **state)
{
    (void)state;
    for (int k = 0; k < WAY_COUNT; k++) {
        double control = 0.0;
        for (uint64_t seed = 1; seed <= 2; seed++) {
            Scenario scenario = drawn(write_row, seed, WAYS[k].settings, 3);
            const size_t looks = ask(&scenario, &WAYS[k], "a row", &control);
            assert_true((looks > 0) == (WAYS[k].backend == BACKEND_ODE));
            scenario_free(&scenario);
        }
        assert_true(control > CONTROL_LEAST);
    }
}

static void random_mechanisms_show_their_extremes(void **state)
{
    (void)state;
    static const CaseKind *const KINDS[] = {&CASE_FOUR_BAR, &CASE_BODIES, &CASE_SLIDERS,
                                            &CASE_LIMITS,   &CASE_ROTORS, &CASE_PENDULA};
    for (int k = 0; k < WAY_COUNT; k++) {
        double control = 0.0;
        for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
            for (uint64_t seed = 1; seed <= WAYS[k].seeds; seed++) {
                const char *const settings[] = {WAYS[k].settings[0], WAYS[k].settings[1],
                                                WAYS[k].settings[2], "run.step=50 us"};
                Scenario scenario = drawn(KINDS[i]->write, seed, settings, 4);
                ask(&scenario, &WAYS[k], KINDS[i]->name, &control);
                scenario_free(&scenario);
            }
        }
        assert_true(control > CONTROL_LEAST);
    }
}

static void shipped_cases_show_their_extremes(void **state)
{
    (void)state;
    static const char *const CASES[] = {
        "cases/paper/impact-k66.yaml",
        "cases/paper/stackup-impact.yaml",
        "cases/literature/three-clearances.yaml",
    };
    for (int k = 0; k < WAY_COUNT; k++) {
        double control = 0.0;
        for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
            const char *const settings[] = {WAYS[k].settings[0],    WAYS[k].settings[1],
                                            WAYS[k].settings[2],    "run.step=2 us",
                                            "run.revolutions=0.04", "run.samples=100"};
            Scenario scenario = load(CASES[i], settings, 6);
            ask(&scenario, &WAYS[k], CASES[i], &control);
            scenario_free(&scenario);
        }
        assert_true(control > CONTROL_LEAST);
    }
}

// A disc of radius R that is dropped on a plate while it goes sideways, without damping:
//     m y'' = N - m g,   m x'' = -T,   J w' = -R T,   N = K d^1.5,   T = mu N tanh((x' + R w) /
//     v_s)
// The largest force, hypot(N, T), is that of friction's turn, at none of the solver's steps.
static const char SLIDING[] =
    "title: A disc that slides on a plate\n"
    "bodies:\n"
    "  disc: {mass: 0.35 kg, inertia: 41.5 kg mm^2, at: [0 mm, 17.4 mm],\n"
    "         velocity: [-0.102 m/s, 0 m/s]}\n"
    "joints:\n"
    "  plate: {between: [ground, disc], at-a: [0 mm, 0 mm], at-b: [0 mm, 17.4 mm],\n"
    "          normal: 90 deg, radius: 15.4 mm}\n"
    "contact: {stiffness: 1.3991e9 N/m^1.5, friction: 0.3, friction-speed: 100 mm/s, damping: "
    "none}\n"
    "run: {duration: 25 ms, samples: 100, step: auto, backends: [ode], tolerance: 1e-4,\n"
    "      tolerance-of: peaks}\n";

typedef struct Disc {
    double y, vy, vx, w; // height over the plate's touch, m; m/s; rad/s
} Disc;

static const double DISC_MASS = 0.35, DISC_INERTIA = 41.5e-6, DISC_RADIUS = 15.4e-3;

// Writes the normal force and friction, and the rates.
static Disc disc_rates(const Disc *at, double *size)
{
    const double depth = fmax(0.0, -at->y);
    const double normal = 1.3991e9 * depth * sqrt(depth);
    const double arm = DISC_RADIUS;
    const double friction = 0.3 * normal * tanh((at->vx + arm * at->w) / 0.1);
    *size = hypot(normal, friction);
    return (Disc){at->vy, normal / DISC_MASS - 9.80665, -friction / DISC_MASS,
                  -arm * friction / DISC_INERTIA};
}

static Disc disc_moved(Disc at, Disc by, double step)
{
    return (Disc){at.y + step * by.y, at.vy + step * by.vy, at.vx + step * by.vx,
                  at.w + step * by.w};
}

// The largest force of the first impact, by Runge and Kutta's method from the touch on, N.
static double disc_largest(void)
{
    const double step_s = 2e-8;
    Disc at = {0.0, -sqrt(2.0 * 9.80665 * 2e-3), -0.102, 0.0};
    double largest = 0.0;
    do {
        double size, unused;
        const Disc a = disc_rates(&at, &size);
        largest = fmax(largest, size);
        const Disc second = disc_moved(at, a, 0.5 * step_s);
        const Disc b = disc_rates(&second, &unused);
        const Disc third = disc_moved(at, b, 0.5 * step_s);
        const Disc c = disc_rates(&third, &unused);
        const Disc fourth = disc_moved(at, c, step_s);
        const Disc d = disc_rates(&fourth, &unused);
        at = disc_moved(at, a, step_s / 6.0);
        at = disc_moved(at, b, step_s / 3.0);
        at = disc_moved(at, c, step_s / 3.0);
        at = disc_moved(at, d, step_s / 6.0);
    } while (at.y <= 0.0);
    return largest;
}

static Scenario loaded(const char *text, size_t size)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("inside.yaml", text, size, NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return scenario;
}

// Control: the contact's largest force at the ends of the steps alone.
static void a_contact_has_its_largest_force_between_steps(void **state)
{
    (void)state;
    Scenario scenario = loaded(SLIDING, sizeof SLIDING - 1);
    const double truth = disc_largest();
    Trajectory *run = tracer_run(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
    Trajectory *bare = run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
    assert_true(run->is_complete && bare->is_complete && run->joints[0].spike_count > 0);
    assert_close(run->joints[0].force_max.value, truth, 1e-8);
    assert_close(run->joints[0].spikes[0].force_max, truth, 1e-8);
    assert_true(bare->joints[0].spikes[0].force_max < (1.0 - 1e-6) * truth);
    trajectory_destroy(bare);
    trajectory_destroy(run);
    // the uncertainty of peaks is then far below a tolerance of 1e-4
    run = backend_run(&scenario, BACKEND_ODE, NULL, (ChosenWatch){.begin = NULL}, &TRACER_PROBE);
    if (!run->is_complete || run->is_short) {
        fail_msg("%s", run->message);
    }
    assert_close(run->joints[0].spikes[0].force_max, truth, 1e-4);
    trajectory_destroy(run);
    scenario_free(&scenario);
}

// Between two corners of a drive's acceleration motion is smooth, and the closed form looks on both
// sides of each.
static void ideal_joints_show_both_sides_of_every_corner(void **state)
{
    (void)state;
    static const char TEXT[] =
        "title: A crank-rocker that a drive turns by a trapezoid\n"
        "four-bar:\n"
        "  ground:   {length: 254 mm}\n"
        "  crank:    {length: 108 mm,   mass: 0.12 kg, inertia: 173.92 kg mm^2}\n"
        "  coupler:  {length: 279.4 mm, mass: 0.29 kg, inertia: 2070.46 kg mm^2}\n"
        "  follower: {length: 270.5 mm, mass: 0.28 kg, inertia: 1988.39 kg mm^2}\n"
        "drive: {angle: [[0 s, 0 deg], [0.3 s, 200 deg], [0.5 s, 100 deg]], profile: trapezoid}\n"
        "run: {duration: 500 ms, samples: 97, backends: [reference]}\n";
    Scenario scenario = loaded(TEXT, sizeof TEXT - 1);
    Trajectory *truth = run_scenario(&scenario, registry_solver(BACKEND_ANALYTIC), NOBODY);
    for (size_t samples = 97; samples < 2000; samples += 903) {
        scenario.run.samples = samples;
        Trajectory *run = tracer_run(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
        Trajectory *bare = run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
        assert_true(run->is_complete && bare->is_complete && truth->is_complete);
        for (size_t i = 1; i < run->body_count; i++) {
            const BodyExtremes *is = &run->bodies[i];
            const BodyExtremes *as = &truth->bodies[i];
            assert_close(is->omega_max.value, as->omega_max.value, 1e-9);
            assert_close(is->omega_min.value, as->omega_min.value, 1e-9);
            assert_close(is->alpha_max.value, as->alpha_max.value, 1e-9);
            assert_close(is->alpha_min.value, as->alpha_min.value, 1e-9);
        }
        // control: the coupler's, at the ends of steps and at samples alone
        assert_false(
            fabs(bare->bodies[1].alpha_max.value / truth->bodies[1].alpha_max.value - 1.0) < 1e-4);
        trajectory_destroy(bare);
        trajectory_destroy(run);
    }
    trajectory_destroy(truth);
    scenario_free(&scenario);
}

// The truth is the run of a period from the settled start, looked into.
static void a_settled_motion_has_the_largest_force_of_its_period(void **state)
{
    (void)state;
    const char *path = "cases/mechanisms/compressor.yaml";
    Scenario scenario;
    Err err = {0};
    // the gas presses hardest at top dead centre, where a run from there would have samples
    const char *overrides[] = {"run.settle-starts=2", "run.revolutions=1", "run.samples=20",
                               "drive.start=9 deg"};
    if (!casefile_load(path, overrides, 4, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    settle_scenario(&scenario, NOBODY);
    assert_int_equal(scenario.settled.motions[0].period, 1);
    Trajectory *run = tracer_run(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
    assert_true(run->is_complete);
    for (size_t i = 0; i < run->joint_count; i++) {
        if (linkage_has_play(&scenario.linkage.joints[i])) {
            const double force = scenario.settled.motions[0].joints[i].force.headline;
            assert_close(force, run->joints[i].force_max.value, 1e-8);
            // control: the samples alone miss it
            double sampled = 0.0;
            for (size_t k = 0; k < run->sample_count; k++) {
                sampled = fmax(sampled, trajectory_state(run, k, i)->force);
            }
            assert_true(sampled < (1.0 - 1e-6) * force);
        }
    }
    trajectory_destroy(run);
    scenario_free(&scenario);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_of_four_bars_show_their_extremes),
        cmocka_unit_test(random_mechanisms_show_their_extremes),
        cmocka_unit_test(shipped_cases_show_their_extremes),
        cmocka_unit_test(a_contact_has_its_largest_force_between_steps),
        cmocka_unit_test(ideal_joints_show_both_sides_of_every_corner),
        cmocka_unit_test(a_settled_motion_has_the_largest_force_of_its_period),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
