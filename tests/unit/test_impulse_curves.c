// Do the curves inside a step pass through what they are made of, and are their rates their rates?
#include "close.h"

#include "ode/plane/impulse_curves.h"

enum { BODIES = 2, ROWS = 2, DRIVEN = 0, CURVE_NUMBERS = 3 * BODIES * ROWS };

// A step that follows two others of other lengths.
static const double START_S = 2.0e-3;
static const double WIDTH_S = 0.3e-3;
static const double MIDDLES_S[KERNEL_COLUMNS_KNOWN] = {2.15e-3, 1.9e-3, 1.5e-3};

// What a row does, any parabola in time.
static double does(size_t number, double time_s)
{
    const double n = 1.0 + (double)number;
    return n + 1e3 * (2.0 - n) * time_s + 1e6 * n * n * time_s * time_s;
}

static double its_rate(size_t number, double time_s)
{
    const double n = 1.0 + (double)number;
    return 1e3 * (2.0 - n) + 2e6 * n * n * time_s;
}

static const double MEAN[3] = {10.0, -20.0, 300.0};
static const double RATE[3] = {2e4, 1e5, -3e5};
static const double REST[3] = {1e-9, -2e-9, 3e-8};
static const Motion BEFORE = {
    .position = {0.1, 0.2}, .angle = 3.0, .velocity = {5.0, -6.0}, .omega = 70.0};

// Of two bodies, of which one is driven.
static Joint pivot = {.body_a = LINKAGE_GROUND, .body_b = DRIVEN};
static const Linkage LINKAGE = {
    .body_count = BODIES, .joint_count = 1, .joints = &pivot, .driver = {.is_present = true}};

static ImpulseCurves make_curves(void)
{
    double columns[KERNEL_COLUMNS_KNOWN][CURVE_NUMBERS];
    double rates[CURVE_NUMBERS];
    double *all[KERNEL_COLUMNS_KNOWN];
    for (size_t k = 0; k < KERNEL_COLUMNS_KNOWN; k++) {
        for (size_t i = 0; i < CURVE_NUMBERS; i++) {
            columns[k][i] = does(i, MIDDLES_S[k]);
            rates[i] = its_rate(i, MIDDLES_S[0]);
        }
        all[k] = columns[k];
    }
    ImpulseCurves curves = impulse_curves_create(&LINKAGE, 0, ROWS);
    curves.width_s = WIDTH_S;
    impulse_curves_set_body(&curves, 1, &BEFORE, MEAN, RATE, REST);
    impulse_curves_set_columns(&curves, all, MIDDLES_S, rates);
    return curves;
}

// Sums of a force in each row that is constant since the start of the step.
static KernelSums sums_of(const double forces[ROWS], double since_s)
{
    KernelSums sums = kernel_sums(ROWS);
    for (size_t i = 0; i < ROWS; i++) {
        sums.force[i] = forces[i];
        sums.impulse[i] = forces[i] * since_s;
        sums.moment[i] = forces[i] * since_s * since_s / 2.0;
        sums.moment[ROWS + i] = forces[i] * since_s * since_s * since_s / 6.0;
    }
    return sums;
}

static Motion motion_at(const ImpulseCurves *curves, const double forces[ROWS], double since_s)
{
    KernelSums sums = sums_of(forces, since_s);
    Motion motions[BODIES] = {{.angle = 7.0}};
    impulse_curves_at(curves, since_s, &sums, motions);
    // the driven body is left alone
    assert_true(motions[DRIVEN].angle == 7.0);
    kernel_sums_free(&sums);
    return motions[1];
}

static void the_ends_are_those_of_the_step(void **state)
{
    (void)state;
    ImpulseCurves curves = make_curves();
    const double none[ROWS] = {0.0, 0.0};
    const Motion first = motion_at(&curves, none, 0.0);
    assert_true(first.position.x == BEFORE.position.x && first.omega == BEFORE.omega);
    const Motion last = motion_at(&curves, none, WIDTH_S);
    assert_close(last.omega, BEFORE.omega + WIDTH_S * MEAN[2], 1e-15);
    assert_close(last.velocity.y, BEFORE.velocity.y + WIDTH_S * MEAN[1], 1e-15);
    // the rest is what the mean acceleration and its rate leave
    const double bent = -WIDTH_S * WIDTH_S * WIDTH_S / 12.0 * RATE[2];
    assert_near(last.angle,
                BEFORE.angle + WIDTH_S * (BEFORE.omega + 0.5 * WIDTH_S * MEAN[2]) + REST[2] + bent,
                1e-15);
    impulse_curves_finish(&curves);
}

static void rows_do_what_the_last_three_steps_say(void **state)
{
    (void)state;
    ImpulseCurves curves = make_curves();
    const double forces[ROWS] = {3.0, -0.5};
    for (double since_s = 0.0; since_s <= WIDTH_S; since_s += 0.5 * WIDTH_S) {
        const double time_s = START_S + since_s;
        double rates[3 * BODIES];
        impulse_curves_press(&curves, time_s - MIDDLES_S[0], forces, rates);
        const Motion motion = motion_at(&curves, forces, since_s);
        const double alone = MEAN[2] + (since_s - 0.5 * WIDTH_S) * RATE[2];
        for (size_t i = 0; i < 3 * BODIES; i++) {
            const double truth =
                forces[0] * does(i, time_s) + forces[1] * does(3 * BODIES + i, time_s);
            assert_close(rates[i], truth, 1e-12);
        }
        assert_close(motion.alpha, alone + rates[5], 1e-12);
    }
    impulse_curves_finish(&curves);
}

// A difference of the speeds is the acceleration, where a row does the same in all steps; what is
// left is of the second order. Control: the accelerations of another force are not.
static void speeds_change_with_the_accelerations(void **state)
{
    (void)state;
    ImpulseCurves curves = make_curves();
    for (size_t i = 0; i < BODIES * ROWS; i++) {
        for (size_t k = 0; k < IMPULSE_HALVES; k++) {
            curves.columns[i].rate[k] = curves.columns[i].slope[k];
            curves.columns[i].bend[k] = (Double2){0.0, 0.0};
        }
    }
    const double forces[ROWS] = {3.0, -0.5};
    const double middle_s = 0.4 * WIDTH_S;
    const double apart_s = 1e-3 * WIDTH_S;
    const Motion before = motion_at(&curves, forces, middle_s - apart_s);
    const Motion behind = motion_at(&curves, forces, middle_s + apart_s);
    const double rate = (behind.velocity.y - before.velocity.y) / (2.0 * apart_s);
    assert_close(rate, motion_at(&curves, forces, middle_s).acceleration.y, 1e-9);
    const double others[ROWS] = {3.0, -0.5001};
    const double other = motion_at(&curves, others, middle_s).acceleration.y;
    assert_true(fabs(rate - other) > 1e-6 * fabs(rate));
    impulse_curves_finish(&curves);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ends_are_those_of_the_step),
        cmocka_unit_test(rows_do_what_the_last_three_steps_say),
        cmocka_unit_test(speeds_change_with_the_accelerations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
