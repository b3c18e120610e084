// Are the derivatives of a contact's force those of the force?
#include "close.h"
#include "pressed_pin.h"

#include "kernel/friction_law.h"
#include "kernel/internal.h"

enum { ROWS = KERNEL_ROWS_MOST };

static const double NOTHING[2 * ROWS] = {0.0}; // integrals have two for each row

// By central differences: where `at` points into the kernel.
static void differences(Kernel *pin, double *at, double nudge, double *slopes)
{
    double forces[2][ROWS];
    double powers[2];
    const double kept = *at;
    for (int i = 0; i < 2; i++) {
        *at = kept + (i == 0 ? nudge : -nudge);
        kernel_force_find(pin, 0.0, NOTHING, NOTHING, forces[i], powers);
    }
    *at = kept;
    for (size_t i = 0; i < pin->row_count; i++) {
        slopes[i] = (forces[0][i] - forces[1][i]) / (2.0 * nudge);
    }
}

// How far the derivatives by one of the rows are from differences, over the largest.
static double slope_mismatch(Kernel *pin, size_t row, bool of_position)
{
    KernelSlopes slopes;
    kernel_slopes_find(pin, 0, 0.0, NOTHING, NOTHING, 0.0, &slopes);
    double expected[ROWS];
    differences(pin, of_position ? &pin->position[row] : &pin->speed[row],
                of_position ? 1e-3 * PRESSED_DEPTH : 1e-7, expected);
    double largest = 0.0;
    double apart = 0.0;
    for (size_t i = 0; i < pin->row_count; i++) {
        const double found = of_position ? slopes.by_position[i][row] : slopes.by_speed[i][row];
        largest = fmax(largest, fabs(expected[i]));
        apart = fmax(apart, fabs(found - expected[i]));
    }
    return apart / largest;
}

static void slopes_are_those_of_the_force(void **state)
{
    (void)state;
    for (unsigned number = 0; number < 20; number++) {
        uint64_t seed = lcg_stirred(number);
        const size_t rows[3] = {KERNEL_ROWS_PLAIN, KERNEL_ROWS_PLANE, KERNEL_ROWS_MOST};
        Kernel pin = pressed_pin(&seed, number % 3 == 0 ? 0.0 : 0.3, rows[number % 3]);
        KernelSlopes slopes;
        double force[ROWS];
        double powers[2];
        kernel_force_find(&pin, 0.0, NOTHING, NOTHING, force, powers);
        kernel_slopes_find(&pin, 0, 0.0, NOTHING, NOTHING, 0.0, &slopes);
        for (size_t i = 0; i < pin.row_count; i++) {
            assert_near(slopes.force[i], force[i], 1e-13 * hypot(force[0], force[1]));
        }
        for (size_t row = 0; row < pin.row_count; row++) {
            assert_true(slope_mismatch(&pin, row, false) < 1e-7);
            // the depth is a thousandth of the play, and its rounding that much larger
            assert_true(row >= 2 || slope_mismatch(&pin, row, true) < 1e-6);
        }
        kernel_finish(&pin);
    }
}

static void slopes_at_lines_and_discs_are_those_of_the_force(void **state)
{
    (void)state;
    for (unsigned number = 0; number < 20; number++) {
        uint64_t seed = lcg_stirred(number);
        const double friction = number % 2 == 0 ? 0.0 : 0.3;
        const bool is_line = number / 2 % 2 == 0;
        const bool has_turns = !is_line && friction > 0.0;
        Kernel pin =
            pressed_pin(&seed, friction, has_turns ? KERNEL_ROWS_PLANE : KERNEL_ROWS_PLAIN);
        press_elsewhere(&pin, is_line, friction);
        KernelSlopes slopes;
        double force[ROWS];
        double powers[2];
        kernel_force_find(&pin, 0.0, NOTHING, NOTHING, force, powers);
        kernel_slopes_find(&pin, 0, 0.0, NOTHING, NOTHING, 0.0, &slopes);
        assert_true(hypot(force[0], force[1]) > 1.0);
        for (size_t i = 0; i < pin.row_count; i++) {
            assert_near(slopes.force[i], force[i], 1e-13 * hypot(force[0], force[1]));
        }
        for (size_t row = 0; row < pin.row_count; row++) {
            // without friction nothing changes with sliding on a line
            const bool is_idle = is_line && row == 1;
            assert_true((is_idle && friction == 0.0) || slope_mismatch(&pin, row, false) < 1e-7);
            assert_true(row >= 2 || is_idle || slope_mismatch(&pin, row, true) < 1e-6);
        }
        kernel_finish(&pin);
    }
}

static void slopes_in_slots_are_those_of_the_force(void **state)
{
    (void)state;
    for (unsigned number = 0; number < 20; number++) {
        uint64_t seed = lcg_stirred(number);
        const double friction = number % 2 == 0 ? 0.0 : 0.3;
        const bool is_at_end = number / 2 % 2 == 0;
        Kernel pin =
            pressed_pin(&seed, friction, friction > 0.0 ? KERNEL_ROWS_PLANE : KERNEL_ROWS_PLAIN);
        press_in_slot(&pin, is_at_end);
        KernelSlopes slopes;
        double force[ROWS];
        double powers[2];
        kernel_force_find(&pin, 0.0, NOTHING, NOTHING, force, powers);
        kernel_slopes_find(&pin, 0, 0.0, NOTHING, NOTHING, 0.0, &slopes);
        assert_true(hypot(force[0], force[1]) > 1.0);
        for (size_t i = 0; i < pin.row_count; i++) {
            assert_near(slopes.force[i], force[i], 1e-13 * hypot(force[0], force[1]));
        }
        // friction turns both bodies alike: the pin's centre is where its rows are
        assert_true(friction == 0.0 || force[2] == -force[3]);
        for (size_t row = 0; row < pin.row_count; row++) {
            // between the ends nothing changes along the slot
            const bool is_idle = !is_at_end && row == 1;
            assert_true((is_idle && friction == 0.0) || slope_mismatch(&pin, row, false) < 1e-7);
            assert_true(row >= 2 || is_idle || slope_mismatch(&pin, row, true) < 1e-6);
            assert_true(!is_idle || slopes.by_position[0][1] == 0.0);
        }
        kernel_finish(&pin);
    }
}

// Going out so fast that the damper would pull.
static void a_force_that_would_pull_is_none_unless_it_is_smooth(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(1);
    Kernel pin = pressed_pin(&seed, 0.3, KERNEL_ROWS_MOST);
    for (size_t i = 0; i < 2; i++) {
        pin.speed[i] = -1e4 * pin.position[i];
    }
    KernelSlopes slopes;
    kernel_slopes_find(&pin, 0, 0.0, NOTHING, NOTHING, 0.0, &slopes);
    for (size_t i = 0; i < ROWS; i++) {
        assert_near(slopes.force[i], 0.0, 0.0);
        assert_near(slopes.by_speed[i][0], 0.0, 0.0);
    }
    // outwards is the way of the position: a force along it pulls the pin into the wall
    kernel_slopes_find(&pin, 0, 0.0, NOTHING, NOTHING, 0.5 * PRESSED_DEPTH, &slopes);
    assert_true(slopes.force[0] * pin.position[0] + slopes.force[1] * pin.position[1] > 0.0);
    assert_true(slopes.by_speed[0][0] < 0.0);
    kernel_finish(&pin);
}

// Smooth forces go on below a depth without a jump, and even outside the wall.
static void a_smooth_force_goes_on_below_a_depth(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(2);
    Kernel pin = pressed_pin(&seed, 0.0, KERNEL_ROWS_PLAIN);
    const double outward[2] = {pin.position[0] / (PRESSED_CLEARANCE + PRESSED_DEPTH),
                               pin.position[1] / (PRESSED_CLEARANCE + PRESSED_DEPTH)};
    double along[3];
    const double depths[3] = {PRESSED_DEPTH * (1.0 + 1e-9), PRESSED_DEPTH * (1.0 - 1e-9),
                              -PRESSED_DEPTH};
    for (int i = 0; i < 3; i++) {
        pin.position[0] = (PRESSED_CLEARANCE + depths[i]) * outward[0];
        pin.position[1] = (PRESSED_CLEARANCE + depths[i]) * outward[1];
        KernelSlopes slopes;
        kernel_slopes_find(&pin, 0, 0.0, NOTHING, NOTHING, PRESSED_DEPTH, &slopes);
        along[i] = -(slopes.force[0] * outward[0] + slopes.force[1] * outward[1]);
    }
    assert_close(along[0], along[1], 1e-8);
    const double tangent = force_law_tangent(&pin.contacts[0].law, PRESSED_DEPTH);
    assert_close(along[1] - along[2], 2.0 * PRESSED_DEPTH * tangent, 1e-6);
    kernel_finish(&pin);
}

// By central differences, from far below the border of the series to far above it.
static void friction_bends_as_it_says(void **state)
{
    (void)state;
    const double speed = 5e-3;
    for (double size = 1e-6 * speed; size < 10.0 * speed; size *= 1.9) {
        const double nudge = 1e-3 * fmax(size, 1e-2 * speed);
        const FrictionHold hold = friction_hold(size, speed);
        const double rise =
            friction_hold(size + nudge, speed).held - friction_hold(size - nudge, speed).held;
        assert_near(hold.slope, rise / (2.0 * nudge), 1e-5 / speed);
        const FrictionGrip grip = friction_grip(size, speed);
        assert_close(grip.share * size, hold.held, 1e-15);
        const double own_nudge = 1e-3 * size;
        const double bent = friction_grip(size + own_nudge, speed).share -
                            friction_grip(size - own_nudge, speed).share;
        // where the closed form's difference is more than rounding
        if (size > 0.1 * speed) {
            assert_close(grip.bend * size, bent / (2.0 * own_nudge), 1e-4);
        }
        const double cube = speed * speed * speed;
        assert_true(size > 1e-2 * speed || fabs(grip.bend + 2.0 / (3.0 * cube)) < 1e-3 / cube);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slopes_are_those_of_the_force),
        cmocka_unit_test(friction_bends_as_it_says),
        cmocka_unit_test(slopes_at_lines_and_discs_are_those_of_the_force),
        cmocka_unit_test(slopes_in_slots_are_those_of_the_force),
        cmocka_unit_test(a_force_that_would_pull_is_none_unless_it_is_smooth),
        cmocka_unit_test(a_smooth_force_goes_on_below_a_depth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
