// Do bushings hold their bodies as an integration in the coordinates of all bodies says
// (tests/support/bushed.c), in the reference and in every way of stepping ODE?
#include "bushed.h"
#include "load_case.h"
#include "ode_error.h"

#include "measure/chosen_run.h"

#include <string.h>

enum { SEEDS = 20 };

static Scenario scenario_of(const Bushed *bushed)
{
    char *text = bushed_case(bushed);
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("bushed", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s\n%s", err.text, text);
    }
    free(text);
    return kept_instead(&scenario);
}

static BushedTruth truth_of(const Bushed *bushed)
{
    BushedTruth truth;
    assert_true(bushed_integrate(bushed, &truth));
    return truth;
}

// The truth of a seed's mechanism, found once.
static BushedTruth truth_of_seed(unsigned seed)
{
    static BushedTruth truths[SEEDS];
    static bool is_found[SEEDS];
    if (!is_found[seed]) {
        const Bushed bushed = bushed_random(seed);
        truths[seed] = truth_of(&bushed);
        is_found[seed] = true;
    }
    return truths[seed];
}

// How far the end of a run is from the truth.
static double apart_at_end(const Bushed *bushed, const Trajectory *run, const BushedTruth *truth)
{
    double states[6 * BUSHED_BODIES];
    for (size_t i = 0; i < bushed->body_count; i++) {
        const Motion *at = trajectory_motion(run, run->sample_count - 1, i);
        const double numbers[6] = {at->position.x, at->position.y, at->angle,
                                   at->velocity.x, at->velocity.y, at->omega};
        memcpy(states + 6 * i, numbers, sizeof numbers);
    }
    return bushed_apart(bushed, states, truth);
}

// The same of a run of the reference, whose energy must close.
static double reference_apart(const Bushed *bushed, const BushedTruth *truth)
{
    const Scenario scenario = scenario_of(bushed);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const double apart = apart_at_end(bushed, run, truth);
    assert_near(run->energy.residual / error_energy(run), 0.0, 1e-9);
    trajectory_destroy(run);
    return apart;
}

static double ode_apart(const Bushed *bushed, OdeStepping stepping, double step_s,
                        const BushedTruth *truth)
{
    Scenario scenario = scenario_of(bushed);
    scenario.ode.stepping = stepping;
    scenario.run.step = step_s;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const double apart = apart_at_end(bushed, run, truth);
    trajectory_destroy(run);
    return apart;
}

// Both integrate to some 1e-12 a step; a kink of a curve costs digits.
static const double REFERENCE_WITHIN = 1e-9;

static void the_reference_follows_the_integration(void **state)
{
    (void)state;
    for (unsigned seed = 0; seed < SEEDS; seed++) {
        const Bushed bushed = bushed_random(seed);
        const BushedTruth truth = truth_of_seed(seed);
        assert_near(reference_apart(&bushed, &truth), 0.0, REFERENCE_WITHIN);
    }
}

// What must be seen: a row that is left out, the axes of the wrong body, a force at the wrong
// anchor, each by a small change of the mechanism that the truth has.
static void a_small_change_is_seen(void **state)
{
    (void)state;
    const Bushed bushed = bushed_random(1);
    const BushedTruth truth = truth_of(&bushed);
    for (int row = 0; row < 3; row++) {
        Bushed other = bushed;
        other.mounts[0].damping[row] *= 1.01;
        assert_true(reference_apart(&other, &truth) > 100.0 * REFERENCE_WITHIN);
        other = bushed;
        other.mounts[0].stiffness[row] *= 1.01;
        other.mounts[0].pull[row][1] *= 1.01;
        other.mounts[0].pull[row][3] *= 1.01;
        assert_true(reference_apart(&other, &truth) > 100.0 * REFERENCE_WITHIN);
    }
    Bushed other = bushed;
    other.mounts[0].direction += 1e-3;
    assert_true(reference_apart(&other, &truth) > 100.0 * REFERENCE_WITHIN);
    other = bushed;
    other.mounts[0].at[1][0] += 1e-5;
    assert_true(reference_apart(&other, &truth) > 100.0 * REFERENCE_WITHIN);
}

// Whether a pull is by points: where a step crosses one of them it has an error of second order of
// its own, whose sum does not fall evenly.
static bool has_points(const Bushed *bushed)
{
    bool has = false;
    for (size_t i = 0; i < bushed->mount_count; i++) {
        has = has || bushed->mounts[i].points[0] > 0;
    }
    return has;
}

static void ode_follows_at_its_order(void **state)
{
    (void)state;
    for (unsigned seed = 0; seed < SEEDS; seed++) {
        const Bushed bushed = bushed_random(seed);
        const BushedTruth truth = truth_of_seed(seed);
        const double plain[] = {ode_apart(&bushed, ODE_PLAIN, 2e-4, &truth),
                                ode_apart(&bushed, ODE_PLAIN, 5e-5, &truth)};
        const double staggered[] = {ode_apart(&bushed, ODE_STAGGERED, 2e-4, &truth),
                                    ode_apart(&bushed, ODE_STAGGERED, 5e-5, &truth)};
        const double within = has_points(&bushed) ? 1.0 : 0.1;
        assert_near(ode_order(plain[0], plain[1], 4.0), 1.0, 0.1);
        assert_near(ode_order(staggered[0], staggered[1], 4.0), 2.0, within);
        assert_true(staggered[1] < 3e-6);
        assert_true(ode_apart(&bushed, ODE_EXTRAPOLATED, 5e-5, &truth) < 1e-5);
    }
}

// What a step is chosen for holds against the integration, too.
static void a_chosen_step_holds_its_tolerance(void **state)
{
    (void)state;
    for (unsigned seed = 0; seed < SEEDS; seed++) {
        const Bushed bushed = bushed_random(seed);
        const BushedTruth truth = truth_of_seed(seed);
        const Scenario scenario = scenario_of(&bushed);
        Trajectory *run =
            backend_run(&scenario, BACKEND_ODE, NULL, (ChosenWatch){.begin = NULL}, NULL);
        assert_true(run->is_complete && run->error_estimate <= 1e-4);
        assert_true(apart_at_end(&bushed, run, &truth) < 1e-4);
        trajectory_destroy(run);
    }
}

// A curve whose points are on one line, not all of one distance, is that line, also beyond them.
static void points_on_a_line_are_a_stiffness(void **state)
{
    (void)state;
    Bushed bushed = bushed_random(3);
    bushed.mount_count = 1;
    BushedMount *mount = &bushed.mounts[0];
    const double stiffness[3] = {2000.0, 5000.0, 40.0};
    memcpy(mount->stiffness, stiffness, sizeof stiffness);
    memset(mount->points, 0, sizeof mount->points);
    const BushedTruth truth = truth_of(&bushed);
    for (int smooth = 0; smooth < 2; smooth++) {
        mount->is_smooth = smooth == 1;
        for (int row = 0; row < 3; row++) {
            static const double OVER[] = {-1e-3, -2e-4, 5e-4, 6e-4};
            mount->points[row] = 4;
            for (size_t i = 0; i < 4; i++) {
                mount->over[row][i] = OVER[i];
                mount->pull[row][i] = stiffness[row] * OVER[i];
            }
        }
        assert_near(reference_apart(&bushed, &truth), 0.0, REFERENCE_WITHIN);
    }
}

// A four-bar of 4 m, 20 kg links over 2 m of ground, which falls from where its crank stands
// upright; so many of its pins are bushings of 3e4 N/m and 800 N s/m, from the coupler's second on.
static Bushed four_bar(size_t mounts)
{
    const double corner[2] = {3.4641016151377544 * 0.89442719099991588 + 1.0,
                              3.4641016151377544 * 0.44721359549995794 + 2.0};
    const double pins[4][2] = {{0.0, 0.0}, {0.0, 4.0}, {corner[0], corner[1]}, {2.0, 0.0}};
    static const int BODIES[4][2] = {{-1, 0}, {0, 1}, {1, 2}, {2, -1}};
    static const size_t ORDER[4] = {2, 1, 3, 0};
    Bushed bushed = {.body_count = 3, .gravity = 9.81, .end_s = 2.0};
    for (size_t i = 0; i < 3; i++) {
        const double *from = pins[i];
        const double *to = pins[i + 1];
        bushed.bodies[i] = (BushedBody){
            .mass = 20.0,
            .inertia = 20.0 * 16.0 / 12.0,
            .state = {0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]),
                      atan2(to[1] - from[1], to[0] - from[0])},
        };
    }
    for (size_t i = 0; i < 4; i++) {
        const double *at = pins[ORDER[i]];
        const int a = BODIES[ORDER[i]][0];
        const int b = BODIES[ORDER[i]][1];
        if (i < mounts) {
            BushedMount *mount = &bushed.mounts[bushed.mount_count++];
            *mount = (BushedMount){.bodies = {a, b},
                                   .at = {{at[0], at[1]}, {at[0], at[1]}},
                                   .stiffness = {3e4, 3e4},
                                   .damping = {800.0, 800.0}};
            mount->angle = (b < 0 ? 0.0 : bushed.bodies[b].state[2]) -
                           (a < 0 ? 0.0 : bushed.bodies[a].state[2]);
        } else {
            bushed.pins[bushed.pin_count++] = (BushedPin){{a, b}, {at[0], at[1]}};
        }
    }
    return bushed;
}

static void a_four_bar_with_bushings_falls_as_integrated(void **state)
{
    (void)state;
    for (size_t mounts = 1; mounts <= 3; mounts++) {
        const Bushed bushed = four_bar(mounts);
        const BushedTruth truth = truth_of(&bushed);
        assert_near(reference_apart(&bushed, &truth), 0.0, REFERENCE_WITHIN);
        const double coarse = ode_apart(&bushed, ODE_STAGGERED, 1e-3, &truth);
        const double fine = ode_apart(&bushed, ODE_STAGGERED, 5e-4, &truth);
        assert_near(ode_order(coarse, fine, 2.0), 2.0, 0.1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_reference_follows_the_integration),
        cmocka_unit_test(a_small_change_is_seen),
        cmocka_unit_test(ode_follows_at_its_order),
        cmocka_unit_test(a_chosen_step_holds_its_tolerance),
        cmocka_unit_test(points_on_a_line_are_a_stiffness),
        cmocka_unit_test(a_four_bar_with_bushings_falls_as_integrated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
