// Does a run that was saved in the middle of a contact go on as if it had not been stopped?
//
// Every solver is stopped where a pin presses on its wall, its state saved, and another run started
// from that state. The truth is the run that went on. The same solver goes on from all that it
// carries, to the last bit; the control, which is to differ, is that solver started from positions,
// speeds and contacts alone, and so chooses its steps anew. A run that is only started there, by
// whatever solver, is as far off as tolerances allow; the control starts from the same positions
// and speeds, but forgets what its contacts carry: it takes the speed of the moment for that of an
// impact, which damps the contact otherwise.
#include "load_case.h"
#include "mechanism.h"

#include "model/solver.h"
#include "model/state.h"

#include <float.h>
#include <stdio.h>

enum { SETTINGS_MOST = 6 };

// Whether a contact has been under way for a while, so that what it carries counts.
static bool has_contact(const RunState *state, double age_s)
{
    for (size_t i = 0; i < state->joint_count; i++) {
        for (size_t k = 0; k < JOINT_PLACES; k++) {
            if (state->contacts[i][k].is_touching && state->contacts[i][k].age_s > age_s) {
                return true;
            }
        }
    }
    return false;
}

static void stride_to(const Solver *solver, void *state, double time_s, double *end_s)
{
    Err err = {ERR_NONE, ""};
    while (*end_s < time_s) {
        if (!solver_stride(solver, state, INFINITY, end_s, &err)) {
            fail_msg("%s", err.text);
        }
    }
}

// The largest difference of the bodies' velocities and of those of their furthest points about
// their centres, over the largest of them.
static double difference(const Linkage *linkage, const RunState *a, const Sample *b)
{
    double most = 0.0;
    double largest = 0.0;
    for (size_t i = 0; i < a->body_count; i++) {
        const Motion *one = &a->sample.bodies[i];
        const Motion *other = &b->bodies[i];
        const double reach = linkage_reach(linkage, (int)i);
        largest = fmax(largest, fmax(vec2_length(one->velocity), reach * fabs(one->omega)));
        most = fmax(most, vec2_length(vec2_sub(one->velocity, other->velocity)));
        most = fmax(most, reach * fabs(one->omega - other->omega));
    }
    return most / largest;
}

// How far the run of a scenario that starts in one state is from the one that went on to another.
static double apart_of(const Scenario *next, const Solver *solver, const RunState *from,
                       const RunState *to)
{
    void *state = NULL;
    Err err = {ERR_NONE, ""};
    if (!solver->open(next, &state, &err)) {
        fail_msg("%s", err.text);
    }
    double end_s = 0.0;
    const double goal_s = to->time_s - from->time_s;
    stride_to(solver, state, goal_s * (1.0 - 1e-9), &end_s);
    Sample sample = sample_create(&next->linkage);
    solver->observe(state, goal_s, &sample);
    const double apart = difference(&next->linkage, to, &sample);
    sample_free(&sample);
    solver->close(state);
    return apart;
}

// How far a run that is started from a state is from the one that went on, after some time.
static double apart_after(const Scenario *scenario, const Solver *solver, const RunState *from,
                          const RunState *to)
{
    Scenario next = scenario_copy(scenario);
    run_state_start(from, &next);
    const double apart = apart_of(&next, solver, from, to);
    scenario_free(&next);
    return apart;
}

typedef struct Apart {
    double continued;
    double forgotten;
} Apart;

static Apart continue_run(const char *path, const char *const *settings, BackendKind backend,
                          double age_s, double further_s)
{
    int count = 0;
    while (count < SETTINGS_MOST && settings[count] != NULL) {
        count++;
    }
    const Scenario scenario = load(path, settings, count);
    const Solver *solver = backend == BACKEND_ODE ? &ODE_SOLVER : &REFERENCE_SOLVER;
    void *state = NULL;
    Err err = {ERR_NONE, ""};
    if (!solver->open(&scenario, &state, &err)) {
        fail_msg("%s", err.text);
    }
    RunState from = run_state_create(&scenario.linkage);
    RunState to = run_state_create(&scenario.linkage);
    double end_s = 0.0;
    do {
        stride_to(solver, state, nextafter(end_s, INFINITY), &end_s);
        run_state_take(solver, state, end_s, &from);
        assert_true(end_s < scenario_duration(&scenario));
    } while (!has_contact(&from, age_s));
    stride_to(solver, state, end_s + further_s, &end_s);
    run_state_take(solver, state, end_s, &to);
    Apart apart = {.continued = apart_after(&scenario, solver, &from, &to)};
    memset(from.contacts, 0, from.joint_count * sizeof *from.contacts);
    apart.forgotten = apart_after(&scenario, solver, &from, &to);
    solver->close(state);
    run_state_free(&from);
    run_state_free(&to);
    print_message("%s, %s %s: %.3g, forgotten %.3g\n", path, solver->name,
                  count > 0 ? settings[count - 1] : "", apart.continued, apart.forgotten);
    return apart;
}

// What is damped by the speed of its impact shows whether that was carried; of what is not damped,
// or flies before it is compared, the motion alone is.
static const char *const DAMPED[] = {"cases/paper/impact-k66.yaml",
                                     "cases/mechanisms/slider-crank-both.yaml"};
static const char *const OTHERS[] = {
    "cases/hard/gears-thousands-of-turns.yaml", // an angle with limits
    "cases/mechanisms/newtons-cradle.yaml",     // stops: as above it takes long to touch
    "cases/mechanisms/woodpecker.yaml",         // a sleeve, no drive
    "cases/space/overhung-pin.yaml",            // in space, tilted
};

// of the largest velocity: what tolerances of 1e-12 and rounding leave of 0.1 ms
static const double REFERENCE_APART = 1e-11;

// Of ODE's: contacts within a step go on in local steps of other lengths, whose error is below that
// of the step; rows keep the effective mass of another normal for a while.
static const double INSIDE_APART = 1e-7;
static const double ROWS_APART = 1e-5;

static void the_reference_goes_on(void **state)
{
    (void)state;
    static const char *const NONE[] = {NULL};
    for (int i = 0; i < 2; i++) {
        const Apart apart = continue_run(DAMPED[i], NONE, BACKEND_REFERENCE, 2e-5, 1e-4);
        assert_true(apart.continued > 0.0); // what the solver carries besides does count
        assert_true(apart.continued < REFERENCE_APART);
        assert_true(apart.forgotten > 1e3 * REFERENCE_APART);
    }
    for (int i = 0; i < 4; i++) {
        const Apart apart = continue_run(OTHERS[i], NONE, BACKEND_REFERENCE, 2e-6, 1e-4);
        assert_true(apart.continued < REFERENCE_APART);
    }
}

static void every_stepping_of_ode_goes_on(void **state)
{
    (void)state;
    static const char *const SCHEMES[][SETTINGS_MOST] = {
        {"run.step=10us", "ode.map=impulse", NULL},
        {"run.step=1us", "ode.stepping=plain", "ode.map=exact", NULL},
        {"run.step=1us", "ode.stepping=plain", "ode.map=textbook", NULL},
        {"run.step=1us", "ode.stepping=staggered", "ode.map=midpoint", NULL},
    };
    for (int k = 0; k < 4; k++) {
        const double limit = k == 0 ? INSIDE_APART : ROWS_APART;
        for (int i = 0; i < 2; i++) {
            const Apart apart = continue_run(DAMPED[i], SCHEMES[k], BACKEND_ODE, 2e-5, 1e-4);
            assert_true(apart.continued < limit);
            assert_true(apart.forgotten > apart.continued);
        }
        for (int i = 0; i < 4; i++) {
            const char *settings[SETTINGS_MOST];
            memcpy(settings, SCHEMES[k], sizeof settings);
            settings[0] = i < 2 ? "run.step=10us" : settings[0];
            const Apart apart = continue_run(OTHERS[i], settings, BACKEND_ODE, 2e-6, 1e-4);
            assert_true(apart.continued < limit);
        }
    }
}

// A rotor with a load over two turns.
static Scenario rotor(const char *drive, const char *length)
{
    char text[1024];
    const int size = snprintf(
        text, sizeof text,
        "bodies:\n  rotor: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0 m, 0 m]}\n"
        "joints:\n  pivot: {between: [ground, rotor], at: [0 m, 0 m]}\n"
        "drive: {joint: pivot, %s}\n"
        "loads:\n  gas: {body: rotor, over: crank-angle, period: 720 deg, torque: [[0 deg, 0 "
        "N m], [90 deg, -0.4 N m], [180 deg, 0 N m]]}\n"
        "run: {%s, samples: 10}\n",
        drive, length);
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    if (!casefile_load_text("rotor.yaml", text, (size_t)size, NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return scenario;
}

// Once it has made three turns and a part of one it is turned back: the load and a soft drive keep
// count all the same. The control forgets the turns.
static void check_turns(Scenario scenario)
{
    void *of = NULL;
    Err err = {ERR_NONE, ""};
    assert_true(REFERENCE_SOLVER.open(&scenario, &of, &err));
    RunState from = run_state_create(&scenario.linkage);
    RunState to = run_state_create(&scenario.linkage);
    double end_s = 0.0;
    do {
        stride_to(&REFERENCE_SOLVER, of, nextafter(end_s, INFINITY), &end_s);
        run_state_take(&REFERENCE_SOLVER, of, end_s, &from);
    } while (from.sample.bodies[0].angle < 6.1 * M_PI);
    stride_to(&REFERENCE_SOLVER, of, end_s + 0.5, &end_s);
    run_state_take(&REFERENCE_SOLVER, of, end_s, &to);
    assert_true(apart_after(&scenario, &REFERENCE_SOLVER, &from, &to) < 1e-9);
    Scenario forgets = scenario_copy(&scenario);
    run_state_start(&from, &forgets);
    forgets.linkage.loads[0].shift = 0.0;
    assert_true(apart_of(&forgets, &REFERENCE_SOLVER, &from, &to) > 1e-3);
    scenario_free(&forgets);
    REFERENCE_SOLVER.close(of);
    run_state_free(&from);
    run_state_free(&to);
    scenario_free(&scenario);
}

static void what_counts_turns_goes_on(void **state)
{
    (void)state;
    check_turns(rotor("stall-torque: 1 N m, no-load-speed: 120 rpm", "duration: 3 s"));
    check_turns(
        rotor("speed: 100 rpm, stiffness: 0.4 N m/rad, damping: 0.05 N m s/rad", "revolutions: 5"));
}

// What is the same to the last bit in two runs some steps after a state was taken of one and put
// into the other: bodies and joints where each step ended.
enum { STEPS_ON = 40 };

// s, less than any step: of several mechanisms each is to take one
static const double NEXT_S = 2e-7;

// Number by number: what is between them in memory says nothing.
static bool are_same_joints(const JointState *a, const JointState *b, size_t count)
{
    bool are_same = true;
    for (size_t i = 0; i < count; i++) {
        const double one[] = {
            a[i].eccentricity.x, a[i].eccentricity.y, a[i].gap,         a[i].force_on_b.x,
            a[i].force_on_b.y,   a[i].force,          a[i].moment_on_b, a[i].tilt};
        const double other[] = {
            b[i].eccentricity.x, b[i].eccentricity.y, b[i].gap,         b[i].force_on_b.x,
            b[i].force_on_b.y,   b[i].force,          b[i].moment_on_b, b[i].tilt};
        are_same =
            are_same && memcmp(one, other, sizeof one) == 0 && a[i].is_touching == b[i].is_touching;
    }
    return are_same;
}

static void compare_bits(const Scenario *scenario, const Solver *solver, double from_s, void *one,
                         void *other, const char *what)
{
    const Linkage *linkage = &scenario->linkage;
    Sample a = sample_create(linkage);
    Sample b = sample_create(linkage);
    double ends_s[2] = {from_s, from_s};
    for (int i = 0; i < STEPS_ON && ends_s[0] < scenario_duration(scenario); i++) {
        stride_to(solver, one, ends_s[0] + NEXT_S, &ends_s[0]);
        stride_to(solver, other, ends_s[1] + NEXT_S, &ends_s[1]);
        solver->observe(one, ends_s[0], &a);
        solver->observe(other, ends_s[1], &b);
        const bool is_same =
            ends_s[0] == ends_s[1] &&
            memcmp(a.bodies, b.bodies, linkage->body_count * sizeof *a.bodies) == 0 &&
            are_same_joints(a.joints, b.joints, linkage->joint_count);
        if (!is_same) {
            fail_msg("%s: step %d after the state was taken differs", what, i + 1);
        }
    }
    assert_int_equal(solver->model(one).steps, solver->model(other).steps);
    assert_int_equal(solver->model(one).evaluations, solver->model(other).evaluations);
    sample_free(&a);
    sample_free(&b);
}

// Runs up to a contact that has lasted for some steps, or without contacts up to a time, and goes
// on twice.
static void go_on_exactly(const Scenario *scenario, const Solver *solver, const char *what)
{
    const double last_s = fmin(2e-3, 0.3 * scenario_duration(scenario));
    void *one = NULL;
    void *other = NULL;
    Err err = {ERR_NONE, ""};
    if (!solver->open(scenario, &one, &err)) {
        fail_msg("%s", err.text);
    }
    RunState from = run_state_create(&scenario->linkage);
    double end_s = 0.0;
    do {
        stride_to(solver, one, nextafter(end_s, INFINITY), &end_s);
        run_state_save(solver, one, end_s, &from);
    } while (from.carry.size == 0 || (!has_contact(&from, 1e-5) && end_s < last_s));
    if (!run_state_resume(&from, solver, scenario, &other, &err)) {
        fail_msg("%s: %s", what, err.text);
    }
    compare_bits(scenario, solver, end_s, one, other, what);
    solver->close(one);
    solver->close(other);
    run_state_free(&from);
}

typedef struct Scheme {
    const char *name;
    const Solver *solver;
    const char *settings[SETTINGS_MOST];
} Scheme;

static const Scheme SCHEMES[] = {
    {"reference", &REFERENCE_SOLVER, {NULL}},
    {"impulse", &ODE_SOLVER, {"run.step=10us", "ode.map=impulse", NULL}},
    {"plain", &ODE_SOLVER, {"run.step=1us", "ode.stepping=plain", "ode.map=exact", NULL}},
    {"staggered", &ODE_SOLVER, {"run.step=1us", "ode.map=midpoint", NULL}},
    {"extrapolated", &ODE_SOLVER, {"run.step=10us", "ode.stepping=extrapolated", NULL}},
};

static void go_on_from(const char *path, const Scheme *scheme)
{
    int count = 0;
    while (scheme->settings[count] != NULL) {
        count++;
    }
    const Scenario scenario = load(path, scheme->settings, count);
    char what[256];
    snprintf(what, sizeof what, "%s, %s", path, scheme->name);
    go_on_exactly(&scenario, scheme->solver, what);
}

static void every_solver_goes_on_to_the_last_bit(void **state)
{
    (void)state;
    static const char *const CASES[] = {
        "cases/paper/impact-k66.yaml",
        "cases/literature/three-clearances.yaml",
        "cases/mechanisms/slider-crank-both.yaml",
        "cases/mechanisms/gear-pair.yaml",
        "cases/mechanisms/rack-and-pinion.yaml",
        "cases/mechanisms/cam-roller.yaml",
        "cases/mechanisms/pin-slot.yaml",
        "cases/mechanisms/newtons-cradle.yaml",
        "cases/mechanisms/woodpecker.yaml",
        "cases/mechanisms/compressor.yaml",
        "cases/mechanisms/run-up.yaml",
        "cases/mechanisms/servo-backlash.yaml",
        "cases/hard/gears-thousands-of-turns.yaml",
        "cases/hard/friction-1.yaml",
        "cases/hard/restitution-0.yaml",
        "cases/space/overhung-pin.yaml",
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        for (size_t k = 0; k < 4; k++) {
            go_on_from(CASES[i], &SCHEMES[k]);
        }
    }
    static const char *const IDEAL[] = {
        "cases/paper/ideal-stackup.yaml", "cases/mechanisms/andrews.yaml",
        "cases/mechanisms/motor-flywheel.yaml", "cases/mechanisms/five-bar.yaml",
        "cases/space/bennett.yaml"};
    for (size_t i = 0; i < sizeof IDEAL / sizeof *IDEAL; i++) {
        for (size_t k = 0; k < sizeof SCHEMES / sizeof *SCHEMES; k++) {
            const bool is_in_space = strstr(IDEAL[i], "space") != NULL;
            // extrapolated stepping is for constant speeds in the plane
            const bool has_angles = strstr(IDEAL[i], "five-bar") != NULL;
            if (is_in_space ? SCHEMES[k].solver == &REFERENCE_SOLVER || k == 2
                            : !has_angles || k != 4) {
                go_on_from(IDEAL[i], &SCHEMES[k]);
            }
        }
    }
}

// Links in a row, or as many pendula side by side, with play in every pin.
static Scenario make_links(size_t count, bool is_row)
{
    Scenario scenario = kept_default();
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.exponent = 1.5;
    scenario.contact.friction = 0.1;
    scenario.linkage = mechanism_chain(count, 0.1, 0.1);
    for (size_t i = 0; i < count; i++) {
        Joint *joint = &scenario.linkage.joints[i];
        scenario.linkage.bodies[i].start.omega = 0.1 * (double)(i % 7) - 0.3;
        joint->kind = JOINT_CLEARANCE;
        joint->clearance =
            (Clearance){5.01e-3 + 1e-7 * (double)(i % 5), 5e-3, 0.01, {0.0, 0.0}, false};
        if (!is_row) {
            joint->anchor_a = (Vec2){0.1 * (double)i, 0.0};
            joint->body_a = LINKAGE_GROUND;
        }
    }
    scenario.run.duration = 0.02;
    scenario.run.step = 4e-5;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    return scenario;
}

static void many_contacts_go_on_to_the_last_bit(void **state)
{
    (void)state;
    const Scenario row = make_links(60, true);
    const Scenario pendula = make_links(20, false);
    go_on_exactly(&row, &REFERENCE_SOLVER, "60 links, reference");
    go_on_exactly(&row, &ODE_SOLVER, "60 links, ode");
    go_on_exactly(&pendula, &ODE_SOLVER, "20 pendula, ode");
    Scenario freed = row;
    linkage_free(&freed.linkage);
    freed = pendula;
    linkage_free(&freed.linkage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_solver_goes_on_to_the_last_bit),
        cmocka_unit_test(many_contacts_go_on_to_the_last_bit),
        cmocka_unit_test(every_stepping_of_ode_goes_on),
        cmocka_unit_test(the_reference_goes_on),
        cmocka_unit_test(what_counts_turns_goes_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
