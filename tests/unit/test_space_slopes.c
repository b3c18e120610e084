// In space, are the derivatives that the implicit integrator works with those of the accelerations,
// and are these not numbers where nothing determines them?
#include "close.h"
#include "mechanism.h"

#include "base/lcg.h"
#include "reference/space/space_dynamics.h"

enum {
    SLOPES_BODIES = 3,
    COORDINATES = 6 * SLOPES_BODIES,
    SIZE = 2 * COORDINATES + SYSTEM_IMPULSES + 4 * PIN_SPACE_PLACES,
};

static const double DEPTH = 1e-6; // m
static const double MOVED = 1e-5; // m or rad, that coordinates are away from the start
static const double RATE = 1e-4;  // m/s or rad/s

// The paper's crank-rocker lifted into space with play, collars and friction, its drive at a stand.
// Every end presses on its wall and every collar too, and each slides as its pins tilt.
typedef struct Pressed {
    Scenario scenario;
    SpaceDynamics dynamics;
    double y[SIZE];
} Pressed;

static Pressed *press(size_t joints)
{
    Pressed *pressed = test_calloc(1, sizeof *pressed);
    Scenario *scenario = &pressed->scenario;
    *scenario = mechanism_loose(joints);
    scenario->gravity = scenario_downward(0.0);
    scenario->contact.friction = 0.2;
    scenario->linkage.driver.speed = 1e-9;
    scenario->linkage.is_spatial = true;
    space_complete(&scenario->linkage);
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        scenario->linkage.joints[i].space.axis = (Vec3){0.0, 0.0, 1.0};
        // one loose pin cannot slide
        scenario->linkage.joints[i].space.axial_clearance = joints > 1 ? 1e-4 : 0.0;
    }
    SpaceDynamics *dynamics = &pressed->dynamics;
    Err err = {ERR_NONE, ""};
    assert_true(space_dynamics_init(scenario, dynamics, &err));
    const size_t n = dynamics->tree.coordinate_count;
    SpaceMotion motions[SLOPES_BODIES];
    space_start(&scenario->linkage, motions);
    space_tree_start(&dynamics->tree, motions, pressed->y + n);
    space_loops_start(&dynamics->tree, dynamics->loops, pressed->y, pressed->y + n,
                      &dynamics->scratch->tree);
    uint64_t seed = 1;
    for (size_t k = 0; k < n; k++) {
        pressed->y[k] = MOVED * lcg_draw(&seed);
        pressed->y[n + k] = RATE * lcg_draw(&seed);
    }
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        space_contact_rebase(&dynamics->tree, &dynamics->contacts[i]);
        Contact *contact = &dynamics->system.contacts[i];
        contact->damping_rate = 1e3;
        contact->clearance += space_dynamics_press(dynamics, i, 0.0, pressed->y).depth - DEPTH;
        contact->mode = CONTACT_PRESSING;
    }
    return pressed;
}

static void release_slopes(Pressed *pressed)
{
    space_dynamics_finish(&pressed->dynamics);
    test_free(pressed);
}

// The difference of an acceleration, over the nudge of a coordinate or rate on both sides.
static void differences(Pressed *pressed, size_t k, double nudge, double *column)
{
    const size_t n = pressed->dynamics.tree.coordinate_count;
    double rates[2][SIZE];
    const double kept = pressed->y[k];
    for (int side = 0; side < 2; side++) {
        pressed->y[k] = kept + (side == 0 ? -nudge : nudge);
        space_dynamics_rates(0.0, pressed->y, rates[side], &pressed->dynamics);
    }
    pressed->y[k] = kept;
    for (size_t i = 0; i < n; i++) {
        column[i] = (rates[1][n + i] - rates[0][n + i]) / (2.0 * nudge);
    }
}

// The largest error of any derivative by a coordinate or by a rate, over the largest in its column;
// the accelerations that are differenced are those at another sliding speed, by a factor.
static double worst(Pressed *pressed, bool is_rate, double factor)
{
    const size_t n = pressed->dynamics.tree.coordinate_count;
    double(*slopes)[COORDINATES * COORDINATES] = test_calloc(2, sizeof *slopes);
    double worst = 0.0;
    space_slopes(0.0, pressed->y, slopes[0], slopes[1], &pressed->dynamics);
    for (size_t k = 0; k < pressed->dynamics.system.contact_count; k++) {
        pressed->dynamics.system.contacts[k].law.friction_speed *= factor;
    }
    for (size_t k = is_rate ? n : 0; k < (is_rate ? 2 * n : n); k++) {
        double column[COORDINATES];
        double error = 0.0;
        double largest = 0.0;
        differences(pressed, k, k < n ? 1e-4 * DEPTH : 1e-4 * RATE, column);
        for (size_t i = 0; i < n; i++) {
            const double slope =
                coupling_entry(pressed->dynamics.system.coupling, slopes[k < n ? 0 : 1], i, k % n);
            error = fmax(error, fabs(slope - column[i]));
            largest = fmax(largest, fabs(column[i]));
        }
        worst = fmax(worst, largest > 0.0 ? error / largest : 0.0);
    }
    test_free(slopes);
    return worst;
}

static void derivatives_are_those_of_the_places_forces(void **state)
{
    (void)state;
    for (size_t joints = 1; joints <= 3; joints++) {
        Pressed *pressed = press(joints);
        assert_true(worst(pressed, true, 1.0) < 1e-6);
        // the frozen geometry leaves out how forces turn, which roll a slender coupler that can
        assert_true(worst(pressed, false, 1.0) < (joints > 1 ? 1e-2 : 1e-4));
        // control: the accelerations of another friction
        assert_true(worst(pressed, true, 1.1) > 1e-2);
        release_slopes(pressed);
    }
}

// Bodies without mass can have any accelerations.
static void rates_that_are_not_determined_are_not_numbers(void **state)
{
    (void)state;
    Pressed *pressed = press(2);
    const size_t size = system_size(&pressed->dynamics.system);
    double rates[SIZE] = {0.0};
    space_dynamics_rates(0.0, pressed->y, rates, &pressed->dynamics);
    for (size_t i = 0; i < size; i++) {
        assert_true(isfinite(rates[i]));
    }
    for (size_t i = 0; i < pressed->scenario.linkage.body_count; i++) {
        pressed->scenario.linkage.bodies[i].mass = 0.0;
    }
    space_dynamics_rates(0.0, pressed->y, rates, &pressed->dynamics);
    for (size_t i = 0; i < size; i++) {
        assert_true(isnan(rates[i]));
    }
    release_slopes(pressed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_are_those_of_the_places_forces),
        cmocka_unit_test(rates_that_are_not_determined_are_not_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
