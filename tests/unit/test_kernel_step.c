// Does the scheme of a step, over a world of one pin on a spring, follow its equations to the
// second order?
//
// Outside truth: classical Runge-Kutta steps, a thousandth as long as the contact, of
//     u'' = -s^2 (u - p) + f(u) / m,   f = -K d^1.5 u / |u| where the pin is d deep in its wall
// The world is pushed off its ideal joint, z = 0, in every step.
#include "single_pin.h"

#include "kernel/step.h"

#include <string.h>

enum { COORDINATES = 3, TRUTH_STEPS = 200000 };

static const double END_S = 4e-4;
static const double SPRING = 6000.0;              // rad/s
static const double REST[2] = {9e-6, 4e-6};       // m, where the spring is relaxed
static const double START[2] = {-2e-6, 5e-6};     // m
static const double START_SPEED[2] = {0.3, -0.1}; // m/s
static const double ASIDE = 0.02;                 // m/s, by which a step leaves the ideal joint

// A pin that moves along x and y, and along z on an ideal joint.
typedef struct Pin {
    KernelStep step;
    double rates[2 * COORDINATES];
    double drift[4];
    double before[2][COORDINATES]; // position and speed
    double middle[COORDINATES];
    double after[2][COORDINATES];
    bool is_late; // whether free accelerations are those of the start, not of mid-step
} Pin;

static double pulled(const double *position, int axis)
{
    return axis < 2 ? -SPRING * SPRING * (position[axis] - REST[axis]) : 0.0;
}

static bool find_start(void *own, double *accelerations)
{
    Pin *pin = own;
    for (int i = 0; i < COORDINATES; i++) {
        accelerations[i] = pulled(pin->before[0], i);
    }
    memcpy(pin->step.kernel.free, accelerations, 2 * sizeof *accelerations);
    return true;
}

static void find_middle(void *own, const double *beyond)
{
    Pin *pin = own;
    for (int i = 0; i < COORDINATES; i++) {
        pin->middle[i] = pin->before[0][i] + 0.5 * pin->step.width_s * pin->before[1][i] +
                         (beyond != NULL ? beyond[i] : 0.0);
    }
}

static bool respond(void *own)
{
    Pin *pin = own;
    Kernel *kernel = &pin->step.kernel;
    for (int i = 0; i < 2; i++) {
        kernel->mobility[3 * i] = 1.0 / ONE_IMPACT_MASS;
        if (pin->step.has_drift) {
            pin->step.columns[0][i * COORDINATES + i] = 1.0 / ONE_IMPACT_MASS;
        }
        kernel->position[i] = pin->before[0][i];
        kernel->speed[i] = pin->before[1][i];
    }
    return true;
}

static void accelerate(void *own, const double *gained)
{
    (void)gained; // the spring does not feel speeds
    Pin *pin = own;
    for (int i = 0; i < 2; i++) {
        pin->step.kernel.free[i] = pulled(pin->is_late ? pin->before[0] : pin->middle, i);
    }
}

static void push(void *own, double after_s, const double *impulses, double *speeds)
{
    (void)own;
    (void)after_s;
    speeds[0] = impulses[0] / ONE_IMPACT_MASS;
    speeds[1] = impulses[1] / ONE_IMPACT_MASS;
    speeds[2] = 0.0;
}

static bool advance(void *own)
{
    Pin *pin = own;
    const double h = pin->step.width_s;
    double pushed[COORDINATES];
    push(pin, 0.0, pin->step.total.impulse, pushed);
    for (int i = 0; i < COORDINATES; i++) {
        const double gained = h * pulled(pin->is_late ? pin->before[0] : pin->middle, i);
        const double aside = i == 2 ? ASIDE : 0.0;
        pin->after[1][i] = pin->before[1][i] + gained + pushed[i] + aside;
        pin->after[0][i] = pin->before[0][i] + 0.5 * h * (pin->before[1][i] + pin->after[1][i]);
    }
    return true;
}

static void shift(void *own, const double *positions, const double *speeds)
{
    Pin *pin = own;
    for (int i = 0; i < COORDINATES; i++) {
        pin->after[0][i] += positions[i];
        pin->after[1][i] += speeds[i];
    }
}

static size_t find_openings(void *own, double *positions, double *rates)
{
    const Pin *pin = own;
    positions[0] = pin->after[0][2];
    rates[0] = pin->after[1][2];
    return 1;
}

static void close_openings(void *own, const double *openings, double *impulses, double *changes)
{
    (void)own;
    changes[0] = changes[1] = 0.0;
    changes[2] = -openings[0];
    impulses[0] = -ONE_IMPACT_MASS * openings[0];
}

static void compare(void *own, double *speeds, double *gained, double *moved)
{
    const Pin *pin = own;
    for (int i = 0; i < COORDINATES; i++) {
        speeds[i] = pin->before[1][i];
        gained[i] = pin->after[1][i] - pin->before[1][i];
        moved[i] = pin->after[0][i] - pin->before[0][i];
    }
}

static const KernelAdapter ADAPTER = {
    .find_start = find_start,
    .find_middle = find_middle,
    .respond = respond,
    .accelerate = accelerate,
    .push = push,
    .advance = advance,
    .shift = shift,
    .find_openings = find_openings,
    .close = close_openings,
    .compare = compare,
};

static void make(Pin *pin, bool has_drift)
{
    *pin = (Pin){.step = {.adapter = &ADAPTER, .own = pin}};
    pin->step.kernel = single_pin(single_pin_hertz(0.0), 0.01);
    kernel_step_make_room(&pin->step, COORDINATES, 1);
    // mobilities of pairs of rows: no islands and no others
    static const size_t FIRST_PARTNER[] = {0, 0};
    pin->step.coupling = (KernelCoupling){.first_partner = FIRST_PARTNER};
    if (has_drift) {
        kernel_step_make_drift(&pin->step, pin->rates, pin->drift);
    }
    for (int i = 0; i < 2; i++) {
        pin->after[0][i] = START[i];
        pin->after[1][i] = START_SPEED[i];
    }
}

// Where the pin is at the end and how fast it goes there, after so many steps.
static void run(bool has_drift, bool is_late, size_t steps, double end[4])
{
    Pin pin;
    make(&pin, has_drift);
    pin.is_late = is_late;
    for (size_t i = 1; i <= steps; i++) {
        kernel_step_begin(&pin.step);
        memcpy(pin.before, pin.after, sizeof pin.before);
        pin.step.end_s = END_S * (double)i / (double)steps;
        assert_int_equal(kernel_step_take(&pin.step), KERNEL_STEP_TAKEN);
        // back on the ideal joint, at the cost of what threw it off
        assert_near(pin.after[0][2], 0.0, 1e-18);
        assert_near(pin.after[1][2], 0.0, 1e-16);
        assert_close(pin.step.closing[0], -ONE_IMPACT_MASS * ASIDE, 1e-12);
        assert_close(pin.step.closed[2], -ASIDE / pin.step.width_s, 1e-12);
    }
    for (int i = 0; i < 2; i++) {
        end[i] = pin.after[0][i];
        end[2 + i] = pin.after[1][i];
    }
    kernel_step_finish(&pin.step);
}

static void rates_of(const double u[4], double rates[4])
{
    const double size = hypot(u[0], u[1]);
    const double depth = size - ONE_IMPACT_CLEARANCE;
    const double pressing =
        depth > 0.0 ? ONE_IMPACT_HERTZ * pow(depth, 1.5) / ONE_IMPACT_MASS : 0.0;
    for (int i = 0; i < 2; i++) {
        rates[i] = u[2 + i];
        rates[2 + i] = pulled(u, i) - pressing * u[i] / size;
    }
}

static void find_truth(double u[4])
{
    static const double SHARES[4] = {0.0, 0.5, 0.5, 1.0};
    static const double WEIGHTS[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    const double h = END_S / TRUTH_STEPS;
    for (int i = 0; i < 2; i++) {
        u[i] = START[i];
        u[2 + i] = START_SPEED[i];
    }
    for (int n = 0; n < TRUTH_STEPS; n++) {
        double rates[4] = {0.0};
        double sum[4] = {0.0};
        for (int stage = 0; stage < 4; stage++) {
            double at[4];
            for (int i = 0; i < 4; i++) {
                at[i] = u[i] + SHARES[stage] * h * rates[i];
            }
            rates_of(at, rates);
            for (int i = 0; i < 4; i++) {
                sum[i] += WEIGHTS[stage] * rates[i];
            }
        }
        for (int i = 0; i < 4; i++) {
            u[i] += h * sum[i];
        }
    }
}

static double error_of(const double truth[4], bool has_drift, bool is_late, size_t steps)
{
    double end[4];
    run(has_drift, is_late, steps, end);
    return hypot(end[2] - truth[2], end[3] - truth[3]) / hypot(START_SPEED[0], START_SPEED[1]);
}

static void a_step_is_of_the_second_order_whatever_the_contacts_do(void **state)
{
    (void)state;
    double truth[4];
    find_truth(truth);
    for (int has_drift = 0; has_drift < 2; has_drift++) {
        const double coarse = error_of(truth, has_drift, false, 32);
        const double fine = error_of(truth, has_drift, false, 256);
        print_message("# drift %d: %.3g, %.3g\n", has_drift, coarse, fine);
        assert_true(log(coarse / fine) / log(8.0) > 1.8);
        // control: accelerations of the start are of the first
        const double late = error_of(truth, has_drift, true, 256);
        print_message("# late %.3g\n", late);
        assert_true(late > 10.0 * fine);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_is_of_the_second_order_whatever_the_contacts_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
