// Do derivatives of accelerations have room for all that these depend on, and for no more than
// bodies and their neighbours?
#include "close.h"
#include "kept.h"
#include "mechanism.h"

#include "base/lcg.h"
#include "reference/integrators.h"
#include "reference/plane/dynamics.h"

#include <string.h>

enum { LINKS = 9, FREEDOMS = 3 };

static const double LINK_LENGTH = 0.1; // m
static const double PLAY = 5e-5;       // m
static const double NUDGE = 1e-3;

// A chain with play in every so many joints, the first one of them; with room for a spring.
static Scenario chain(size_t count, size_t every)
{
    Scenario scenario = kept_default();
    Linkage ideal = mechanism_chain(count, LINK_LENGTH, 1.0);
    scenario.linkage =
        linkage_create((LinkageRoom){.bodies = count, .joints = count, .springs = 1});
    scenario.linkage.body_count = scenario.linkage.joint_count = count;
    memcpy(scenario.linkage.bodies, ideal.bodies, count * sizeof *ideal.bodies);
    memcpy(scenario.linkage.joints, ideal.joints, count * sizeof *ideal.joints);
    linkage_free(&ideal);
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.exponent = 1.5;
    for (size_t i = 0; i < count; i += every) {
        Joint *joint = &scenario.linkage.joints[i];
        joint->kind = JOINT_CLEARANCE;
        joint->clearance =
            (Clearance){.hole_radius = 5e-3 + PLAY, .pin_radius = 5e-3, .width = 0.01};
    }
    return scenario;
}

static Dynamics *begin(const Scenario *scenario)
{
    Dynamics *dynamics = test_calloc(1, sizeof *dynamics);
    Err err = {ERR_NONE, ""};
    assert_true(dynamics_init(scenario, dynamics, &err));
    return dynamics;
}

static void end(Dynamics *dynamics, Scenario *scenario)
{
    dynamics_finish(dynamics);
    test_free(dynamics);
    linkage_free(&scenario->linkage);
}

// A vector of the integrator away from the start; all pins press.
static double *press(Dynamics *dynamics)
{
    const size_t n = dynamics->tree.coordinate_count;
    double *y = test_calloc(system_size(&dynamics->system), sizeof *y);
    Motion *motions = dynamics->room.state->tree.motions;
    linkage_start(dynamics->tree.linkage, motions);
    tree_start(&dynamics->tree, motions, y + n);
    uint64_t seed = 1;
    for (size_t i = 0; i < 2 * n; i++) {
        y[i] = 0.1 * lcg_draw(&seed);
    }
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        dynamics->system.contacts[i].mode = CONTACT_PRESSING;
        dynamics->system.contacts[i].damping_rate = 0.1;
    }
    return y;
}

static void bodies_with_play_feel_their_neighbours_alone(void **state)
{
    (void)state;
    for (size_t count = 4; count <= 256; count *= 8) {
        Scenario scenario = chain(count, 1);
        Dynamics *dynamics = begin(&scenario);
        const Coupling *coupling = dynamics->system.coupling;
        assert_int_equal(coupling->part_count, count);
        // three bodies a row, two in those of the ends: memory in proportion to the chain
        assert_int_equal(coupling_value_count(coupling), FREEDOMS * FREEDOMS * (3 * count - 2));
        // every third body can be moved at once, however many there are
        assert_int_equal(coupling->colour_count, 3);
        end(dynamics, &scenario);
    }
    // control: ideal joints tie all to all
    Scenario scenario = chain(LINKS, LINKS);
    Dynamics *dynamics = begin(&scenario);
    const size_t n = dynamics->tree.coordinate_count;
    assert_int_equal(coupling_value_count(dynamics->system.coupling), n * n);
    end(dynamics, &scenario);
}

// How far any acceleration changes that is not in the pattern by a coordinate or rate.
static double outside(Dynamics *dynamics)
{
    const size_t n = dynamics->tree.coordinate_count;
    const Coupling *coupling = dynamics->system.coupling;
    const size_t size = system_size(&dynamics->system);
    double *y = press(dynamics);
    double *before = test_calloc(2 * size, sizeof *before);
    double *changed = before + size;
    dynamics_rates(0.0, y, before, dynamics);
    double worst = 0.0;
    for (size_t k = 0; k < 2 * n; k++) {
        const double kept = y[k];
        y[k] += NUDGE;
        dynamics_rates(0.0, y, changed, dynamics);
        y[k] = kept;
        for (size_t i = 0; i < n; i++) {
            const size_t part = coupling->part_of[i];
            if (coupling_column_index(coupling, part, k % n) == coupling_width(coupling, part)) {
                worst = fmax(worst, fabs(changed[n + i] - before[n + i]));
            }
        }
    }
    test_free(y);
    test_free(before);
    return worst;
}

static void what_is_not_coupled_is_not_felt(void **state)
{
    (void)state;
    // three parts, the first and the last of which a spring couples
    Scenario scenario = chain(LINKS, 3);
    scenario.linkage.springs[0] = (Spring){
        .body_a = 0,
        .body_b = LINKS - 1,
        .anchor_a = {0.0, 0.02},
        .anchor_b = {0.0, -0.03},
        .stiffness = 100.0,
        .damping = 10.0,
    };
    Dynamics *dynamics = begin(&scenario);
    scenario.linkage.spring_count = 1;
    Dynamics *sprung = begin(&scenario);
    assert_int_equal(sprung->system.coupling->part_count, 3);
    assert_true(outside(sprung) == 0.0);
    // control: what was found without the spring does not hold with it
    Coupling *const coupling = sprung->system.coupling;
    sprung->system.coupling = dynamics->system.coupling;
    assert_true(outside(sprung) > 0.0);
    sprung->system.coupling = coupling;
    dynamics_finish(dynamics);
    test_free(dynamics);
    end(sprung, &scenario);
}

// The derivatives by the rates, from differences; the evaluations that these take.
static Radau *differentiate(Dynamics *dynamics, const double *y, const Coupling *coupling,
                            Dop853 *integrator, size_t *evaluations)
{
    const System *system = &dynamics->system;
    dop853_init(integrator, system_size(system), system_sum_index(system, 0));
    integrator->rates = dynamics_rates;
    integrator->context = dynamics;
    integrator->coupling = coupling;
    dop853_start(integrator, 0.0, y);
    Radau *radau = radau_create(integrator);
    for (size_t i = 0; i < integrator->motion_size; i++) {
        radau->nudge[i] = NUDGE;
    }
    *evaluations = integrator->evaluations;
    radau_find_decay(radau, integrator);
    *evaluations = integrator->evaluations - *evaluations;
    return radau;
}

static void parts_that_are_moved_at_once_differ_as_one_by_one(void **state)
{
    (void)state;
    for (size_t count = 8; count <= 32; count *= 2) {
        Scenario scenario = chain(count, 1);
        Dynamics *dynamics = begin(&scenario);
        const Coupling *coupling = dynamics->system.coupling;
        const size_t n = coupling->count;
        double *y = press(dynamics);
        Dop853 integrators[2];
        size_t evaluations[2];
        Radau *at_once = differentiate(dynamics, y, coupling, &integrators[0], &evaluations[0]);
        Radau *one_by_one = differentiate(dynamics, y, NULL, &integrators[1], &evaluations[1]);
        for (size_t i = 0; i < n * n; i++) {
            const double of_few =
                coupling_entry(coupling, at_once->newton.by_rate[0], i / n, i % n);
            assert_true(of_few == one_by_one->newton.by_rate[0][i]);
        }
        assert_true(at_once->decay == one_by_one->decay);
        // however long the chain is
        assert_int_equal(evaluations[0], 3 * FREEDOMS);
        assert_int_equal(evaluations[1], n);
        radau_destroy(at_once);
        radau_destroy(one_by_one);
        dop853_finish(&integrators[0]);
        dop853_finish(&integrators[1]);
        test_free(y);
        end(dynamics, &scenario);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bodies_with_play_feel_their_neighbours_alone),
        cmocka_unit_test(what_is_not_coupled_is_not_felt),
        cmocka_unit_test(parts_that_are_moved_at_once_differ_as_one_by_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
