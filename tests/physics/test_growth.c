// Does the growth of perturbations belong to the motion, and not to the directions that were run?
#include "close.h"

#include "complete_run.h"
#include "mechanism.h"

#include "model/growth.h"
#include "model/kinematics.h"
#include "run/registry.h"

#include <stdlib.h>

enum { DIRECTIONS = 20 };

typedef struct Bench {
    Scenario scenario;
    Trajectory *beside;
    DistanceMeasure measure;
    PerturbBasis basis;
} Bench;

static void find_basis(const Scenario *scenario, const Trajectory *beside, Bench *bench)
{
    PerturbUnit units[KINEMATICS_BODY_MAX];
    perturb_units(beside, units);
    bench->measure = distance_measure(beside);
    perturb_basis(scenario, &bench->measure, units, &bench->basis);
}

// The paper's mechanism with half a millimetre of play, up to 11 ms: two freedoms, chaotic.
static int set_up(void **state)
{
    Bench *bench = calloc(1, sizeof *bench);
    assert_non_null(bench);
    bench->scenario = mechanism_paper();
    mechanism_loosen(&bench->scenario, "crank-coupler");
    Clearance *clearance = &bench->scenario.linkage.joints[1].clearance;
    clearance->hole_radius = clearance->pin_radius + 0.5e-3;
    bench->scenario.contact.stiffness = 6.6e10;
    bench->scenario.reference.tolerance = 1e-12;
    bench->scenario.run.revolutions = 0.2;
    bench->beside = complete_run(&bench->scenario, BACKEND_REFERENCE);
    find_basis(&bench->scenario, bench->beside, bench);
    *state = bench;
    return 0;
}

static int tear_down(void **state)
{
    Bench *bench = *state;
    distance_finish(&bench->measure);
    trajectory_destroy(bench->beside);
    free(bench);
    return 0;
}

static Growth grow_on(const Bench *bench, const PerturbBasis *basis, double size, size_t threads)
{
    const Growth growth = growth_find(&(GrowthWork){
        .solver = registry_solver(BACKEND_REFERENCE),
        .scenario = &bench->scenario,
        .beside = bench->beside,
        .measure = &bench->measure,
        .basis = basis,
        .size = size,
        .most = 1e5,
        .until_s = INFINITY,
        .threads = threads,
    });
    assert_false(growth.is_failed);
    return growth;
}

static Growth grow(const Bench *bench, const PerturbBasis *basis, double size)
{
    return grow_on(bench, basis, size, 1);
}

// The two directions of the basis, turned into two others.
static PerturbBasis turned(const PerturbBasis *basis, double angle)
{
    PerturbBasis other = *basis;
    const double c = cos(angle);
    const double s = sin(angle);
    for (size_t i = 0; i < KINEMATICS_BODY_MAX; i++) {
        const SpeedChange a = basis->changes[0][i];
        const SpeedChange b = basis->changes[1][i];
        other.changes[0][i] = (SpeedChange){
            .velocity = vec2_add(vec2_scale(c, a.velocity), vec2_scale(s, b.velocity)),
            .omega = c * a.omega + s * b.omega};
        other.changes[1][i] = (SpeedChange){
            .velocity = vec2_sub(vec2_scale(c, b.velocity), vec2_scale(s, a.velocity)),
            .omega = c * b.omega - s * a.omega};
    }
    return other;
}

static void every_freedom_has_a_direction(void **state)
{
    (void)state;
    Bench *bench = calloc(1, sizeof *bench);
    for (size_t joints = 0; joints <= 3; joints++) {
        Scenario scenario = joints == 0 ? mechanism_paper() : mechanism_loose(joints);
        scenario.run.revolutions = 0.01;
        Trajectory *own = complete_run(&scenario, BACKEND_REFERENCE);
        find_basis(&scenario, own, bench);
        assert_int_equal(bench->basis.count, 2 * joints);
        distance_finish(&bench->measure);
        trajectory_destroy(own);
    }
    free(bench);
}

static void the_horizon_is_no_matter_of_directions_or_sizes(void **state)
{
    const Bench *bench = *state;
    assert_int_equal(bench->basis.count, 2);
    const Growth growth = grow(bench, &bench->basis, 1e-10);
    assert_true(growth.is_limited);
    for (int i = 1; i < DIRECTIONS; i++) {
        const PerturbBasis other = turned(&bench->basis, i * M_PI / DIRECTIONS);
        const Growth again = grow(bench, &other, i % 2 == 0 ? 1e-10 : 1e-9);
        assert_close(again.until_s, growth.until_s, 0.01);
        assert_close(again.largest, growth.largest, 0.05);
    }
}

static void threads_change_no_number(void **state)
{
    const Bench *bench = *state;
    const Growth growth = grow_on(bench, &bench->basis, 1e-10, 1);
    for (size_t threads = 2; threads <= 3; threads++) {
        const Growth again = grow_on(bench, &bench->basis, 1e-10, threads);
        assert_true(again.largest == growth.largest && again.until_s == growth.until_s);
    }
}

// Control: accelerations are what it leaves out.
static void a_glance_sees_bodies_move_as_observing_does(void **state)
{
    const Bench *bench = *state;
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    const Linkage *linkage = &bench->scenario.linkage;
    Sample whole = sample_create(linkage);
    Sample glanced = sample_create(linkage);
    void *run = NULL;
    Err err = {ERR_NONE, ""};
    assert_true(solver->open(&bench->scenario, &run, &err));
    for (int i = 0; i < 200; i++) {
        assert_true(solver->step(run, INFINITY, &err));
        const StepRecord record = solver->record(run);
        const double time_s = 0.5 * (record.start_s + record.end_s);
        solver->glance(run, time_s, &glanced);
        solver->observe(run, time_s, &whole);
        for (size_t k = 0; k < linkage->body_count; k++) {
            const Motion *a = &whole.bodies[k];
            const Motion *b = &glanced.bodies[k];
            assert_true(a->position.x == b->position.x && a->position.y == b->position.y);
            assert_true(a->velocity.x == b->velocity.x && a->velocity.y == b->velocity.y);
            assert_true(a->angle == b->angle && a->omega == b->omega);
        }
    }
    assert_true(whole.bodies[1].alpha != glanced.bodies[1].alpha);
    solver->close(run);
    sample_free(&whole);
    sample_free(&glanced);
}

// Each direction by itself, as brute force has it: the fastest of many is the one that was found.
// Control: not every one is, so that a few at random are a matter of luck.
static void the_fastest_of_many_single_directions_is_as_fast(void **state)
{
    const Bench *bench = *state;
    const Growth growth = grow(bench, &bench->basis, 1e-10);
    double first_s = INFINITY;
    double last_s = 0.0;
    for (int i = 0; i < DIRECTIONS; i++) {
        PerturbBasis single = turned(&bench->basis, i * M_PI / DIRECTIONS);
        single.count = 1;
        const Growth own = grow(bench, &single, 1e-10);
        assert_true(own.until_s >= 0.99 * growth.until_s);
        first_s = fmin(first_s, own.until_s);
        last_s = fmax(last_s, own.until_s);
    }
    assert_close(first_s, growth.until_s, 0.02);
    assert_true(last_s > 1.1 * first_s);
}

// Pins that fall in holes of their own, one of them or both.
static Growth grow_pins(bool with_first, bool with_second, size_t *runs)
{
    Scenario scenario = mechanism_pin(0.1, 1e-4);
    Linkage *linkage = &scenario.linkage;
    Body bodies[2] = {linkage->bodies[0], linkage->bodies[0]};
    bodies[1].mass = 0.3;
    for (size_t i = 0; i < 2; i++) {
        // aside, so that they bounce round their holes
        bodies[i].start.position.x = i == 0 ? 3e-5 : 5e-5;
    }
    const Joint joint = linkage->joints[0];
    linkage->body_count = linkage->joint_count = 0;
    for (size_t i = with_first ? 0 : 1; i < (with_second ? 2 : 1); i++) {
        linkage->joints[linkage->joint_count] = joint;
        linkage->joints[linkage->joint_count++].body_b = (int)linkage->body_count;
        linkage->bodies[linkage->body_count++] = bodies[i];
    }
    scenario.gravity = scenario_downward(9.80665);
    scenario.contact.stiffness = 6.6e10;
    scenario.run.duration = 0.03;
    Bench bench = {.scenario = scenario};
    bench.beside = complete_run(&scenario, BACKEND_REFERENCE);
    find_basis(&scenario, bench.beside, &bench);
    const Growth growth = grow(&bench, &bench.basis, 1e-8);
    *runs = bench.basis.count;
    distance_finish(&bench.measure);
    trajectory_destroy(bench.beside);
    return growth;
}

static void mechanisms_that_nothing_connects_share_their_runs(void **state)
{
    (void)state;
    size_t runs[3];
    const Growth first = grow_pins(true, false, &runs[0]);
    const Growth second = grow_pins(false, true, &runs[1]);
    const Growth both = grow_pins(true, true, &runs[2]);
    assert_int_equal(runs[0], 3);
    assert_int_equal(runs[1], 3);
    assert_int_equal(runs[2], 3);
    assert_true(first.largest > 2.0 && second.largest > 2.0);
    // the control: they do not grow alike
    assert_true(fabs(first.largest / second.largest - 1.0) > 1e-2);
    assert_close(both.largest, fmax(first.largest, second.largest), 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_freedom_has_a_direction),
        cmocka_unit_test(the_horizon_is_no_matter_of_directions_or_sizes),
        cmocka_unit_test(threads_change_no_number),
        cmocka_unit_test(a_glance_sees_bodies_move_as_observing_does),
        cmocka_unit_test(the_fastest_of_many_single_directions_is_as_fast),
        cmocka_unit_test(mechanisms_that_nothing_connects_share_their_runs),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
