// Do steps keep their order beside ODE's own contacts with friction, and where is it ODE that ends
// it?
#include "cart.h"
#include "close.h"
#include "pressed_base.h"
#include "pushed_box.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <ode/ode.h>

static const CartOptions RESTS = {
    .mass = 30.0, .friction = 0.8, .restitution = 0.8, .duration = 0.4};
static const CartOptions SLIDES = {
    .mass = 20.0, .friction = 0.1, .speed = 2.0, .restitution = 0.8, .duration = 0.4};
static const CartOptions KNOCKED = {
    .mass = 20.0, .friction = 0.1, .restitution = 1.0, .duration = 0.4};
static const CartOptions KNOCKED_AND_DAMPED = {
    .mass = 20.0, .friction = 0.1, .restitution = 0.8, .duration = 0.4};

static CartErrors measure_cart(const CartOptions *cart, JpStepping stepping, double step)
{
    CartErrors errors;
    JpError error;
    if (!cart_errors(*cart, stepping, step, &errors, &error)) {
        fail_msg("%s", error.text);
    }
    return errors;
}

static double order(double coarse, double fine, double factor)
{
    return log(coarse / fine) / log(factor);
}

// Impacts of 1.7 ms in steps from 4 ms to a fourteenth of one.
static void order_two_holds(const CartOptions *cart, int changes)
{
    const CartErrors coarse = measure_cart(cart, JP_STEPPING_IMPULSE, 4e-3);
    const CartErrors fine = measure_cart(cart, JP_STEPPING_IMPULSE, 0.125e-3);
    assert_int_equal(coarse.changes, changes);
    assert_int_equal(coarse.stats.fallbacks + fine.stats.fallbacks, 0);
    assert_true(order(coarse.angle, fine.angle, 32.0) > 1.9);
    // the control: rows do not resolve the impacts
    assert_true(measure_cart(cart, JP_STEPPING_STAGGERED, 4e-3).angle > 100.0 * coarse.angle);
}

static void friction_that_rests_or_slides_leaves_order_two(void **state)
{
    (void)state;
    order_two_holds(&RESTS, 0);
    order_two_holds(&SLIDES, 0);
    // what the friction does is no small thing: a cart that it does not hold back ends elsewhere
    int changes;
    CartOptions free = SLIDES;
    free.friction = 0.0;
    assert_true(cart_truth(&free, &changes).position - cart_truth(&SLIDES, &changes).position >
                0.05);
    assert_true(measure_cart(&SLIDES, JP_STEPPING_IMPULSE, 4e-3).position < 1e-6);
}

static void a_box_that_is_knocked_loose_has_order_two_once_steps_resolve_that(void **state)
{
    (void)state;
    const CartErrors coarse = measure_cart(&KNOCKED, JP_STEPPING_IMPULSE, 0.25e-3);
    const CartErrors fine = measure_cart(&KNOCKED, JP_STEPPING_IMPULSE, 0.03125e-3);
    assert_true(coarse.changes > 8 * CART_STARTS);
    assert_true(coarse.stats.fallbacks + fine.stats.fallbacks <= 2);
    assert_near(order(coarse.angle, fine.angle, 8.0), 2.0, 0.3);
    assert_true(order(coarse.position, fine.position, 8.0) > 1.7);
}

// With dampers the force jumps within a step, and ODE's friction, which knows one bound a step,
// acts from the step's start on.
static void a_force_that_sets_in_within_a_step_ends_the_order_of_odes_friction(void **state)
{
    (void)state;
    const CartErrors coarse = measure_cart(&KNOCKED_AND_DAMPED, JP_STEPPING_IMPULSE, 0.25e-3);
    const CartErrors fine = measure_cart(&KNOCKED_AND_DAMPED, JP_STEPPING_IMPULSE, 0.03125e-3);
    assert_near(order(coarse.position, fine.position, 8.0), 1.2, 0.3);
    // ODE alone does the same
    const double step = 1e-3;
    const double within = pushed_box_error(step, 0.02 + 0.75 * step);
    assert_near(within / pushed_box_error(0.5 * step, 0.02 + 0.375 * step), 2.0, 0.1);
    // the control: a force that sets in with a step
    assert_true(within > 1e-5 && pushed_box_error(step, 0.02) < 1e-14);
}

static PressedBase pressed(JpStepping stepping, double layer, double step)
{
    PressedBase end;
    assert_true(pressed_base_run(stepping, layer, step, 0.04, &end, NULL));
    return end;
}

static void a_surface_layer_keeps_contacts_that_rounding_makes_and_breaks(void **state)
{
    (void)state;
    const double layer = 1e-4;
    // rows at two steps, extrapolated by their order of 1
    PressedBase truth = pressed(JP_STEPPING_STAGGERED, layer, 1e-6);
    const PressedBase half = pressed(JP_STEPPING_STAGGERED, layer, 2e-6);
    for (int i = 0; i < 6; i++) {
        double *at = &truth.position[i / 3][i % 3];
        *at += *at - half.position[i / 3][i % 3];
    }
    const PressedBase kept = pressed(JP_STEPPING_IMPULSE, layer, 25e-6);
    const PressedBase lost = pressed(JP_STEPPING_IMPULSE, 0.0, 25e-6);
    assert_near(kept.contacts, 4.0, 0.0);
    assert_int_equal(kept.stats.fallbacks, 0);
    assert_true(pressed_base_apart(&kept, &truth) < 3e-8);
    assert_true(lost.contacts < 3.99);
    assert_true(lost.stats.fallbacks > 0);
    assert_true(pressed_base_apart(&lost, &truth) > 3.0 * pressed_base_apart(&kept, &truth));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(friction_that_rests_or_slides_leaves_order_two),
        cmocka_unit_test(a_box_that_is_knocked_loose_has_order_two_once_steps_resolve_that),
        cmocka_unit_test(a_force_that_sets_in_within_a_step_ends_the_order_of_odes_friction),
        cmocka_unit_test(a_surface_layer_keeps_contacts_that_rounding_makes_and_breaks),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
