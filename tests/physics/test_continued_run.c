// Does a run that was saved in the middle of a contact go on as if it had not been stopped?
//
// Every solver is stopped where a pin presses on its wall, its state saved, and another run started
// from that state. The truth is the run that went on. The control starts from the same positions
// and speeds, but forgets what its contacts carry: it takes the speed of the moment for that of an
// impact, which damps the contact otherwise.
#include "load_case.h"

#include "model/solver.h"
#include "model/state.h"

#include <float.h>

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

// How far a run that is started from a state is from the one that went on, after some time.
static double apart_after(const Scenario *scenario, const Solver *solver, const RunState *from,
                          const RunState *to)
{
    Scenario next = scenario_copy(scenario);
    run_state_start(from, &next);
    void *state = NULL;
    Err err = {ERR_NONE, ""};
    if (!solver->open(&next, &state, &err)) {
        fail_msg("%s", err.text);
    }
    double end_s = 0.0;
    const double goal_s = to->time_s - from->time_s;
    stride_to(solver, state, goal_s * (1.0 - 1e-9), &end_s);
    Sample sample = sample_create(&next.linkage);
    solver->observe(state, goal_s, &sample);
    const double apart = difference(&next.linkage, to, &sample);
    sample_free(&sample);
    solver->close(state);
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
    "cases/mechanisms/newtons-cradle.yaml",     // stops
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
            const Apart apart = continue_run(OTHERS[i], SCHEMES[k], BACKEND_ODE, 2e-6, 1e-4);
            assert_true(apart.continued < limit);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_stepping_of_ode_goes_on),
        cmocka_unit_test(the_reference_goes_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
