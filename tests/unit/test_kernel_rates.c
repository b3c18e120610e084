// Are the rates of a contact's forces those of the forces along the motion?
#include "close.h"
#include "pressed_pin.h"

#include "kernel/internal.h"

static const double APART_S = 2e-9; // in which the depth changes by a few ten thousandths

// Rows that move each other, and accelerations that change the speeds as fast as the forces do.
static void make_mobile(Kernel *pin, uint64_t *seed)
{
    const size_t rows = pin->row_count;
    for (size_t i = 0; i < rows; i++) {
        pin->free[i] = 1e3 * lcg_draw(seed);
        for (size_t k = 0; k <= i; k++) {
            const double entry = i == k ? 10.0 : lcg_draw(seed);
            pin->mobility[i * rows + k] = pin->mobility[k * rows + i] = entry;
        }
    }
}

// The point a little before or after, under the forces there.
static KernelPoint point_beside(Kernel *pin, const KernelPoint *at, double since_s)
{
    KernelPoint beside = kernel_point(pin->row_count, pin->contact_count);
    kernel_point_begin(pin, &beside, at->time_s + since_s);
    for (size_t i = 0; i < pin->row_count; i++) {
        const double rise = 0.5 * since_s * at->rate[i];
        beside.impulse[i] = since_s * (at->force[i] + rise);
        beside.moment[i] = since_s * since_s * (0.5 * at->force[i] + rise / 3.0);
    }
    kernel_force_find(pin, beside.time_s, beside.impulse, beside.moment, beside.force,
                      beside.powers);
    return beside;
}

// How far rates are from central differences, over the largest; `stretched` times as far away as
// the motion leads.
static double mismatch(Kernel *pin, double stretched)
{
    KernelPoint at = kernel_point(pin->row_count, pin->contact_count);
    kernel_rates_find(pin, &at);
    KernelPoint after = point_beside(pin, &at, stretched * APART_S);
    KernelPoint before = point_beside(pin, &at, -stretched * APART_S);
    double largest = 0.0;
    double apart = 0.0;
    for (size_t i = 0; i < pin->row_count; i++) {
        const double expected = (after.force[i] - before.force[i]) / (2.0 * APART_S);
        largest = fmax(largest, fabs(expected));
        apart = fmax(apart, fabs(at.rate[i] - expected));
    }
    for (size_t i = 0; i < 2; i++) {
        const double expected = (after.powers[i] - before.powers[i]) / (2.0 * APART_S);
        // powers are forces times some 0.01 m/s
        apart = fmax(apart, 100.0 * fabs(at.power_rates[i] - expected));
    }
    kernel_point_free(&at);
    kernel_point_free(&after);
    kernel_point_free(&before);
    return apart / largest;
}

static void check(Kernel *pin, uint64_t *seed)
{
    make_mobile(pin, seed);
    KernelPoint at = kernel_point(pin->row_count, pin->contact_count);
    double force[KERNEL_ROWS_MOST];
    double powers[2];
    kernel_rates_find(pin, &at);
    kernel_force_find(pin, 0.0, at.impulse, at.moment, force, powers);
    assert_true(hypot(force[0], force[1]) > 1.0);
    for (size_t i = 0; i < pin->row_count; i++) {
        assert_near(at.force[i], force[i], 1e-13 * hypot(force[0], force[1]));
    }
    assert_near(at.powers[0], powers[0], 1e-13 * fabs(powers[0]));
    assert_near(at.powers[1], powers[1], 1e-13 * fabs(powers[1]));
    kernel_point_free(&at);
    assert_true(mismatch(pin, 1.0) < 1e-5);
    // control: a motion that is a hundredth faster
    assert_true(mismatch(pin, 1.01) > 5e-3);
    kernel_finish(pin);
}

static void rates_are_those_of_the_force_along_the_motion(void **state)
{
    (void)state;
    const size_t rows[3] = {KERNEL_ROWS_PLAIN, KERNEL_ROWS_PLANE, KERNEL_ROWS_MOST};
    for (unsigned number = 0; number < 21; number++) {
        uint64_t seed = lcg_stirred(number);
        Kernel pin = pressed_pin(&seed, number % 3 == 0 ? 0.0 : 0.3, rows[number % 3]);
        check(&pin, &seed);
    }
}

static void rates_at_lines_and_discs_are_too(void **state)
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
        check(&pin, &seed);
    }
}

static void rates_in_slots_are_too(void **state)
{
    (void)state;
    for (unsigned number = 0; number < 20; number++) {
        uint64_t seed = lcg_stirred(number);
        const double friction = number % 2 == 0 ? 0.0 : 0.3;
        Kernel pin =
            pressed_pin(&seed, friction, friction > 0.0 ? KERNEL_ROWS_PLANE : KERNEL_ROWS_PLAIN);
        press_in_slot(&pin, number / 2 % 2 == 0);
        check(&pin, &seed);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_are_those_of_the_force_along_the_motion),
        cmocka_unit_test(rates_at_lines_and_discs_are_too),
        cmocka_unit_test(rates_in_slots_are_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
