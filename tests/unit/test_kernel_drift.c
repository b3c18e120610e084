// Does a kernel whose rows turn while it lasts do what its equations say?
//
// Outside truth: classical Runge-Kutta steps, a thousandth as long as the contact, of
//     u'' = g + g' (t - h/2) + 2 S P + (W + (t - h/2) (S + S^T)) f(u),   P' = f
// for a pin in its hole, and the closed form of the flight before.
#include "single_pin.h"

#include "ode/plane/impulse_curves.h"

static const double DRIFT_DURATION_S = 1e-4; // flight, contact of 60 us, and flight again
static const double SHARE = 0.02;            // of the mobility, that it changes by in the step
static const double SIDE_SPEED = 0.2;        // m/s

enum { DRIFT_STEPS = 200000, STATES = 6 };

// u, u', P, x and y each.
typedef struct State {
    double of[STATES];
} State;

// S, of no symmetry, and g'.
static void find_drift(double drift[4], double rates[2])
{
    const double size = SHARE / (ONE_IMPACT_MASS * DRIFT_DURATION_S);
    const double shares[4] = {0.7, -0.9, 0.4, 1.1};
    for (int i = 0; i < 4; i++) {
        drift[i] = size * shares[i];
    }
    rates[0] = 2e7;
    rates[1] = -3e7;
}

static State rates_of(const State *state, double time_s)
{
    double drift[4];
    double free_rates[2];
    find_drift(drift, free_rates);
    const double off_s = time_s - 0.5 * DRIFT_DURATION_S;
    const double *u = state->of;
    const double size = hypot(u[0], u[1]);
    const double depth = size - ONE_IMPACT_CLEARANCE;
    const double pressing = depth > 0.0 ? ONE_IMPACT_HERTZ * pow(depth, 1.5) : 0.0;
    const double force[2] = {-pressing * u[0] / size, -pressing * u[1] / size};
    State rates = {{u[2], u[3], 0.0, 0.0, force[0], force[1]}};
    for (int i = 0; i < 2; i++) {
        rates.of[2 + i] = off_s * free_rates[i] + force[i] / ONE_IMPACT_MASS;
        for (int k = 0; k < 2; k++) {
            rates.of[2 + i] += 2.0 * drift[2 * i + k] * u[4 + k] +
                               off_s * (drift[2 * i + k] + drift[2 * k + i]) * force[k];
        }
    }
    return rates;
}

static State plus(const State *state, double share, const State *rates)
{
    State sum = *state;
    for (int i = 0; i < STATES; i++) {
        sum.of[i] += share * rates->of[i];
    }
    return sum;
}

static State truth_at_end(void)
{
    State state = {{ONE_IMPACT_CLEARANCE - LONE_PIN_GAP, 0.0, ONE_IMPACT_SPEED, SIDE_SPEED}};
    const double h = DRIFT_DURATION_S / DRIFT_STEPS;
    for (int i = 0; i < DRIFT_STEPS; i++) {
        const double t = i * h;
        const State a = rates_of(&state, t);
        const State at_b = plus(&state, 0.5 * h, &a);
        const State b = rates_of(&at_b, t + 0.5 * h);
        const State at_c = plus(&state, 0.5 * h, &b);
        const State c = rates_of(&at_c, t + 0.5 * h);
        const State at_d = plus(&state, h, &c);
        const State d = rates_of(&at_d, t + h);
        state = plus(&state, h / 6.0, &a);
        state = plus(&state, h / 3.0, &b);
        state = plus(&state, h / 3.0, &c);
        state = plus(&state, h / 6.0, &d);
    }
    return state;
}

static Kernel turning_pin(bool has_drift)
{
    Kernel pin = single_pin(single_pin_hertz(0.0), 0.01);
    pin.speed[1] = SIDE_SPEED;
    if (has_drift) {
        double drift[4];
        kernel_make_drift(&pin);
        find_drift(drift, pin.free_rate);
        kernel_set_drift(&pin, drift, DRIFT_DURATION_S);
    }
    return pin;
}

// Where the pin is and how fast it goes at the end, less what is true, over the clearance and the
// speed.
static void find_errors(Kernel *pin, const State *truth, double errors[2])
{
    assert_true(kernel_run(pin, DRIFT_DURATION_S));
    const PinSums end = single_pin_end(pin);
    KernelSums at = {.impulse = (double *)end.impulse,
                     .moment = (double *)end.moment,
                     .force = (double *)end.force};
    const KernelPose pose = kernel_pose(pin, 0, pin->node_count - 1, DRIFT_DURATION_S, &at);
    const Vec2 off = vec2_sub(pose.pose.eccentricity, (Vec2){truth->of[0], truth->of[1]});
    const double closing = (truth->of[0] * truth->of[2] + truth->of[1] * truth->of[3]) /
                           hypot(truth->of[0], truth->of[1]);
    errors[0] = vec2_length(off) / ONE_IMPACT_CLEARANCE;
    errors[1] = fabs(pose.pose.approach_speed - closing) / ONE_IMPACT_SPEED;
}

static void rows_that_turn_move_as_their_equations_say(void **state)
{
    (void)state;
    const State truth = truth_at_end();
    double errors[2];
    Kernel pin = turning_pin(true);
    find_errors(&pin, &truth, errors);
    assert_false(pin.contacts[0].state.is_touching);
    kernel_finish(&pin);
    // local steps of errors of 1e-9, and what they know of the third integral
    assert_true(errors[0] < 1e-6);
    assert_true(errors[1] < 1e-6);
    // control: rows that do not turn
    pin = turning_pin(false);
    find_errors(&pin, &truth, errors);
    assert_true(errors[0] > 1e-3);
    assert_true(errors[1] > 1e-3);
    kernel_finish(&pin);
}

// A pin that leaves its wall on a flight that the changing acceleration brings back.
static void a_flight_ends_where_a_changing_acceleration_ends_it(void **state)
{
    (void)state;
    Kernel pin = single_pin(single_pin_hertz(0.0), 0.01);
    const double drift[4] = {0.0};
    pin.position[0] = ONE_IMPACT_CLEARANCE;
    pin.speed[0] = -0.01;
    pin.free[0] = 1000.0;
    kernel_make_drift(&pin);
    pin.free_rate[0] = 1e7;
    kernel_set_drift(&pin, drift, DRIFT_DURATION_S);
    assert_true(kernel_run(&pin, DRIFT_DURATION_S));
    // 0 = v + g t / 2 + g' t (t / 6 - h / 4), without the start
    const double a = 1e7 / 6.0;
    const double b = 500.0 - 1e7 * DRIFT_DURATION_S / 4.0;
    const double back_s = (-b + sqrt(b * b + 4.0 * a * 0.01)) / (2.0 * a);
    assert_true(pin.node_count > 3);
    assert_near(pin.times[1], pin.times[2], 0.0);
    assert_close(pin.times[1], back_s, 1e-11);
    // control: with the acceleration of the start alone
    const double start = 1000.0 - 0.5e7 * DRIFT_DURATION_S;
    assert_true(fabs(0.02 / start - back_s) > 1e-3 * back_s);
    kernel_finish(&pin);
}

// How far the first two rows are from where the kernel has them, over the clearance, at most.
static double curves_off(const ImpulseCurves *curves, const Kernel *pin)
{
    KernelSums sums = kernel_sums(KERNEL_ROWS_PLAIN);
    double most = 0.0;
    for (int i = 0; i <= 20; i++) {
        const double time_s = i * DRIFT_DURATION_S / 20.0;
        const size_t node = kernel_node(pin, time_s);
        kernel_at(pin, node, time_s, &sums);
        const PinHole pose = kernel_pose(pin, 0, node, time_s, &sums).pose;
        double position[2];
        double speed[2];
        impulse_curves_place_at(curves, 0, time_s, &sums, position, speed);
        const Vec2 at = {position[0], position[1]};
        const double closing = -vec2_dot(pose.normal, (Vec2){speed[0], speed[1]});
        most = fmax(most, vec2_length(vec2_sub(at, pose.eccentricity)) / ONE_IMPACT_CLEARANCE);
        most = fmax(most, fabs(closing - pose.approach_speed) / ONE_IMPACT_SPEED);
    }
    kernel_sums_free(&sums);
    return most;
}

static void curves_of_a_step_have_its_rows_where_they_are(void **state)
{
    (void)state;
    Kernel pin = turning_pin(true);
    const Linkage none = {.body_count = 0};
    ImpulseCurves curves = impulse_curves_create(&none, 1, KERNEL_ROWS_PLAIN);
    curves.width_s = DRIFT_DURATION_S;
    assert_true(kernel_run(&pin, DRIFT_DURATION_S));
    impulse_curves_set_places(&curves, &pin);
    assert_true(curves_off(&curves, &pin) < 1e-13);
    // control: another half of the drift that has no part in the mobility's rate
    curves.place_columns[0].late[1] = -curves.place_columns[0].late[1];
    assert_true(curves_off(&curves, &pin) > 1e-6);
    impulse_curves_finish(&curves);
    kernel_finish(&pin);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_that_turn_move_as_their_equations_say),
        cmocka_unit_test(curves_of_a_step_have_its_rows_where_they_are),
        cmocka_unit_test(a_flight_ends_where_a_changing_acceleration_ends_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
