// Do contacts that are integrated by themselves do what their law's closed forms say?
#include "single_pin.h"

static const double DURATION_S = 2e-4; // flight, contact of 60 us, and flight again

static void run(Kernel *kernel, double duration_s)
{
    assert_true(kernel_run(kernel, duration_s));
    assert_near(kernel->times[kernel->node_count - 1], duration_s, 1e-14 * duration_s);
}

// Speed after one impact over the speed before.
static double restitution(ForceLaw law, double phase)
{
    Kernel pin = single_pin(law, phase);
    run(&pin, DURATION_S);
    assert_false(pin.contacts[0].state.is_touching);
    const double speed = single_pin_speed_after(&pin);
    kernel_finish(&pin);
    return -speed / ONE_IMPACT_SPEED;
}

static void an_undamped_impact_is_hertz_closed_form(void **state)
{
    (void)state;
    Kernel pin = single_pin(single_pin_hertz(0.0), LONE_PIN_PHASE);
    run(&pin, DURATION_S);
    double deepest = 0.0;
    double force = 0.0;
    double begin_s = 0.0;
    double end_s = 0.0;
    for (size_t node = 0; node + 1 < pin.node_count; node++) {
        const double first_s = pin.times[node];
        const double width_s = pin.times[node + 1] - first_s;
        for (int part = 0; part < 16; part++) {
            const double time_s = first_s + part / 16.0 * width_s;
            PinSums sums;
            pin_sums_at(&pin, node, time_s, &sums);
            const KernelPose pose = pin_pose_at(&pin, 0, node, time_s);
            deepest = fmax(deepest, pose.pose.penetration);
            force = fmax(force, vec2_length(pose.force));
        }
        if (width_s == 0.0) {
            (pin.touching[node + 1] != 0 ? (begin_s = first_s) : (end_s = first_s));
        }
    }
    // the method's own error at this phase is 1e-8; sixteenths of a local step see the top to 1e-6
    assert_close(deepest, single_pin_depth(), 2e-6);
    assert_close(force, ONE_IMPACT_HERTZ * pow(single_pin_depth(), 1.5), 3e-6);
    assert_close(end_s - begin_s, single_pin_duration(), 1e-7);
    assert_close(single_pin_speed_after(&pin), -ONE_IMPACT_SPEED, 1e-7);
    // two 10 mm spheres of the literature: 2.943275 is the published duration's factor
    assert_close(single_pin_duration() / single_pin_depth() * ONE_IMPACT_SPEED, 2.943275, 1e-6);
    kernel_finish(&pin);
}

static void each_damping_law_gives_back_what_its_closed_form_says(void **state)
{
    (void)state;
    for (int kind = DAMPING_LANKARANI_NIKRAVESH; kind <= DAMPING_EXACT; kind++) {
        for (double asked = 0.3; asked < 1.0; asked += 0.2) {
            const double chi = damping_factor((DampingKind)kind, asked);
            assert_near(restitution(single_pin_hertz(chi), 0.02), damping_delivered(chi), 1e-6);
            // control: the factor of another restitution
            assert_true(fabs(restitution(single_pin_hertz(1.1 * chi), 0.02) -
                             damping_delivered(chi)) > 1e-3);
        }
    }
}

static void a_linear_damper_never_pulls(void **state)
{
    (void)state;
    for (double asked = 0.3; asked < 1.0; asked += 0.2) {
        const double stiffness = 1e8; // a contact of 100 us
        const double zeta = damping_linear_ratio(asked);
        ForceLaw law = force_law_power(stiffness, 1.0);
        law.viscous = 2.0 * zeta * sqrt(stiffness * ONE_IMPACT_MASS);
        // the force bends to stay at zero inside a local step: second order from there on
        const double delivered = restitution(law, 0.0025);
        assert_near(delivered, asked, 1e-6);
        // control: a damper that pulls until the pin is out
        const double pulled = exp(-acos(-1.0) * zeta / sqrt(1.0 - zeta * zeta));
        assert_true(fabs(delivered - pulled) > 1e-3);
    }
}

static void the_error_falls_with_the_fourth_power_of_the_phase(void **state)
{
    (void)state;
    const double chi = damping_factor(DAMPING_LANKARANI_NIKRAVESH, 0.9);
    double errors[5];
    double phase = 0.2;
    for (int i = 0; i < 5; i++, phase *= 0.5) {
        errors[i] = fabs(restitution(single_pin_hertz(chi), phase) - damping_delivered(chi));
    }
    // over four halvings, as single ones hang on how the last local step falls
    assert_near(log2(errors[0] / errors[4]) / 4.0, 4.0, 0.5);
}

// Free flight under a constant acceleration: s = v t + a t^2 / 2.
static void an_onset_stands_where_the_flight_meets_the_wall(void **state)
{
    (void)state;
    for (double acceleration = -2000.0; acceleration < 6000.0; acceleration += 1500.0) {
        Kernel pin = single_pin(single_pin_hertz(0.0), LONE_PIN_PHASE);
        pin.free[0] = acceleration;
        run(&pin, 1e-4);
        const double v = ONE_IMPACT_SPEED;
        const double arrival = sqrt(v * v + 2.0 * acceleration * LONE_PIN_GAP);
        assert_true(pin.node_count > 3);
        assert_near(pin.times[1], pin.times[2], 0.0);
        assert_int_equal(pin.touching[1], 0);
        assert_int_equal(pin.touching[2], 1);
        // positions are known to 1e-19 m, and the gap is 1e-5 m
        assert_close(pin.times[1], 2.0 * LONE_PIN_GAP / (v + arrival), 1e-13);
        assert_close(pin.contacts[0].state.impact_speed, arrival, 1e-12);
        // control: the wall a nanometre further away
        const double later = sqrt(v * v + 2.0 * acceleration * (LONE_PIN_GAP + 1e-9));
        assert_true(pin.times[1] < (1.0 - 1e-6) * 2.0 * (LONE_PIN_GAP + 1e-9) / (v + later));
        kernel_finish(&pin);
    }
}

// The flight's top, v^2 / (2 a), at 0.99 of the gap, then at 1.01 of it: the pin is back where it
// started at the end of either, but has touched in the second.
static void a_slow_pin_turns_back_before_the_wall(void **state)
{
    (void)state;
    const double square = ONE_IMPACT_SPEED * ONE_IMPACT_SPEED;
    Kernel pin = single_pin(single_pin_hertz(0.0), LONE_PIN_PHASE);
    pin.free[0] = -square / (2.0 * 0.99 * LONE_PIN_GAP);
    run(&pin, 2.0 * ONE_IMPACT_SPEED / -pin.free[0]);
    assert_int_equal(pin.node_count, 2);
    pin.free[0] = -square / (2.0 * 1.01 * LONE_PIN_GAP);
    run(&pin, 2.0 * ONE_IMPACT_SPEED / -pin.free[0]);
    assert_true(pin.node_count > 3);
    kernel_finish(&pin);
}

// A pin that rounding has leave the wall turns at once: onset after the square root of twice the
// gap over the acceleration.
static void a_pin_that_turns_by_rounding_flies_on(void **state)
{
    (void)state;
    for (double away = 1e-20; away < 1e-12; away *= 1e2) {
        Kernel pin = single_pin(single_pin_hertz(0.0), LONE_PIN_PHASE);
        pin.speed[0] = -away;
        pin.free[0] = 100.0;
        run(&pin, 6e-4);
        size_t node = 0;
        while (node + 1 < pin.node_count && pin.touching[node] == 0) {
            node++;
        }
        assert_close(pin.times[node], sqrt(2.0 * LONE_PIN_GAP / pin.free[0]), 1e-9);
        assert_int_equal(pin.touching[node], 1);
        kernel_finish(&pin);
    }
}

// A bouncing ball within one run: while gravity is small against the contact's force, every arrival
// is as fast as the departure before it, e times slower than the arrival before that.
static void a_pin_that_falls_back_touches_again(void **state)
{
    (void)state;
    Kernel pin = single_pin(single_pin_hertz(0.6), LONE_PIN_PHASE);
    pin.free[0] = 100.0;
    const double e = damping_delivered(0.6);
    // arrivals at 0, and 2 v e / a, 2 v e^2 / a, .. after one another: three of them
    run(&pin, 2.0 * ONE_IMPACT_SPEED / 100.0 * (e + e * e) + 1e-3);
    size_t arrivals = 0;
    for (size_t node = 1; node < pin.node_count; node++) {
        arrivals += pin.touching[node] > pin.touching[node - 1] ? 1 : 0;
    }
    assert_int_equal(arrivals, 3);
    // 0.1 N of gravity against 100 N and more of the contact
    assert_close(pin.contacts[0].state.impact_speed, ONE_IMPACT_SPEED * e * e, 2e-2);
    assert_true(pin.node_count < 3000);
    kernel_finish(&pin);
}

// Thrown from wall to wall in one run: every 2 c / v and the duration of a contact. A crossing of
// the hole is short beside what is left of the run.
static void a_pin_that_crosses_the_hole_meets_the_other_wall(void **state)
{
    (void)state;
    enum { IMPACTS = 8 };
    const double crossing_s = 2.0 * ONE_IMPACT_CLEARANCE / ONE_IMPACT_SPEED;
    const double cycle_s = crossing_s + single_pin_duration();
    Kernel pin = single_pin(single_pin_hertz(0.0), 0.01);
    run(&pin, (IMPACTS - 0.5) * cycle_s);
    size_t impacts = 0;
    for (size_t node = 1; node < pin.node_count; node++) {
        if (pin.touching[node] > pin.touching[node - 1]) {
            const double first_s = LONE_PIN_GAP / ONE_IMPACT_SPEED;
            assert_close(pin.times[node], first_s + (double)impacts * cycle_s, 1e-6);
            impacts++;
        }
    }
    assert_int_equal(impacts, IMPACTS);
    kernel_finish(&pin);
}

// A contact under way whose pin the step of the world has put into its play: it falls back to the
// wall with the speed that it has gained, and comes off with the energy it had.
static void a_pin_moved_off_its_wall_comes_back_to_it(void **state)
{
    (void)state;
    static const double FREE = 1000.0; // m/s^2
    Kernel pin = single_pin(single_pin_hertz(0.0), 0.01);
    run(&pin, LONE_PIN_GAP / ONE_IMPACT_SPEED + 0.9 * single_pin_duration());
    assert_true(pin.contacts[0].state.is_touching);
    pin.position[0] = ONE_IMPACT_CLEARANCE - 4e-6;
    pin.speed[0] = 5e-3;
    pin.free[0] = FREE;
    run(&pin, 2.3e-4);
    assert_false(pin.contacts[0].state.is_touching);
    const PinSums sums = single_pin_end(&pin);
    const double time_s = pin.times[pin.node_count - 1];
    const double speed = pin.speed[0] + FREE * time_s + sums.impulse[0] / ONE_IMPACT_MASS;
    const double moved =
        (pin.speed[0] + 0.5 * FREE * time_s) * time_s + sums.moment[0] / ONE_IMPACT_MASS;
    assert_true(speed < 0.0);
    assert_close(0.5 * speed * speed, 0.5 * 5e-3 * 5e-3 + FREE * moved, 1e-6);
    kernel_finish(&pin);
}

// Half the period of a weight let go at the wall, in which it goes down to twice and a half m g / K
// to the power of two thirds. Rounding may put the pin to either side of the wall.
static void a_weight_let_go_on_the_wall_sinks_at_once(void **state)
{
    (void)state;
    const double gravity = 9.80665;
    const double depth = pow(2.5 * ONE_IMPACT_MASS * gravity / ONE_IMPACT_HERTZ, 2.0 / 3.0);
    const double rounding[] = {-0x1p-52, 0.0, 0x1p-52};
    for (size_t i = 0; i < sizeof rounding / sizeof *rounding; i++) {
        Kernel pin = single_pin(single_pin_hertz(0.0), LONE_PIN_PHASE);
        pin.position[0] = ONE_IMPACT_CLEARANCE;
        pin.position[1] = 0.0;
        pin.speed[0] = 0.0;
        pin.free[0] = gravity;
        // the gap of a wall nearer by its rounding
        pin.contacts[0].radial_clearance = ONE_IMPACT_CLEARANCE * (1.0 + rounding[i]);
        run(&pin, 0.05);
        double deepest = 0.0;
        for (size_t node = 0; node < pin.node_count; node++) {
            PinSums sums;
            assert_true(node == 0 || pin.times[node] >= pin.times[node - 1]);
            pin_sums_at(&pin, node, pin.times[node], &sums);
            const KernelPose pose = pin_pose_at(&pin, 0, node, pin.times[node]);
            deepest = fmax(deepest, pose.pose.penetration);
        }
        // nodes see the lowest point to the square of half a phase
        assert_close(deepest, depth, 2e-3);
        kernel_finish(&pin);
    }
}

// Force, impulse and moment are each the integral of the one before, by Simpson's rule between
// nodes, and move the pin as Newton says.
static void impulses_are_integrals_of_forces_and_move_the_pin(void **state)
{
    (void)state;
    Kernel pin = single_pin(single_pin_hertz(0.3), LONE_PIN_PHASE);
    pin.free[0] = -300.0;
    pin.free[1] = 200.0;
    pin.speed[1] = -0.1;
    run(&pin, DURATION_S);
    double impulses[2] = {0.0};
    double moments[2] = {0.0};
    for (size_t node = 0; node + 1 < pin.node_count; node++) {
        const double width_s = pin.times[node + 1] - pin.times[node];
        PinSums sums[3];
        for (int i = 0; i < 3; i++) {
            pin_sums_at(&pin, node, pin.times[node] + 0.5 * i * width_s, &sums[i]);
        }
        for (int row = 0; row < 2; row++) {
            impulses[row] += width_s / 6.0 *
                             (sums[0].force[row] + 4.0 * sums[1].force[row] + sums[2].force[row]);
            moments[row] +=
                width_s / 6.0 *
                (sums[0].impulse[row] + 4.0 * sums[1].impulse[row] + sums[2].impulse[row]);
        }
    }
    const PinSums end = single_pin_end(&pin);
    const KernelPose pose = pin_pose_at(&pin, 0, pin.node_count - 1, DURATION_S);
    for (int row = 0; row < 2; row++) {
        const double scale = fabs(end.impulse[0]);
        assert_near(end.impulse[row], impulses[row], 1e-7 * scale);
        assert_near(end.moment[row], moments[row], 1e-7 * scale * DURATION_S);
        const double position = pin.position[row] +
                                DURATION_S * (pin.speed[row] + 0.5 * DURATION_S * pin.free[row]) +
                                moments[row] / ONE_IMPACT_MASS;
        const Vec2 e = pose.pose.eccentricity;
        assert_near(row == 0 ? e.x : e.y, position, 1e-7 * ONE_IMPACT_SPEED * DURATION_S);
    }
    // control: the impulse is no small part of the motion
    assert_true(fabs(end.impulse[0]) > ONE_IMPACT_MASS * ONE_IMPACT_SPEED);
    kernel_finish(&pin);
}

static void the_kinetic_energy_that_is_lost_is_what_the_damping_took(void **state)
{
    (void)state;
    for (double chi = 0.0; chi < 2.0; chi += 0.4) {
        Kernel pin = single_pin(single_pin_hertz(chi), 0.02);
        run(&pin, DURATION_S);
        const double after = single_pin_speed_after(&pin);
        const double before = ONE_IMPACT_SPEED;
        const double kinetic = 0.5 * ONE_IMPACT_MASS * before * before;
        const double lost = kinetic - 0.5 * ONE_IMPACT_MASS * after * after;
        const PinSums end = single_pin_end(&pin);
        assert_near(end.dissipated, lost, 1e-6 * kinetic);
        assert_near(end.friction, 0.0, 0.0);
        // control: damping takes something
        assert_int_equal(lost > 0.1 * kinetic, chi > 0.0);
        kernel_finish(&pin);
    }
}

static const double DISC_CLEARANCE = 0.05; // m
static const double DISC_RADIUS = 5e-3;    // m

// A disc that turns, in a hole so wide that its wall hardly bends. The turns' rows are the third
// and the fourth; the hole stands still.
static Kernel disc(double friction, double sideways)
{
    Kernel pin = kernel_start(LONE_PIN_PHASE);
    const KernelContact joint = {
        .law = force_law_with_friction(single_pin_hertz(0.3), friction, 5e-3),
        .radial_clearance = DISC_CLEARANCE,
        .hole_radius = DISC_CLEARANCE + DISC_RADIUS,
    };
    kernel_add(&pin, &joint, KERNEL_ROWS_PLANE);
    kernel_make_room(&pin, pin.row_count);
    pin.mobility[0] = pin.mobility[5] = 1.0 / ONE_IMPACT_MASS;
    pin.mobility[15] = 2.0 / (ONE_IMPACT_MASS * DISC_RADIUS * DISC_RADIUS);
    pin.position[0] = DISC_CLEARANCE - LONE_PIN_GAP;
    pin.speed[0] = ONE_IMPACT_SPEED;
    pin.speed[1] = sideways;
    return pin;
}

// Its rim slides with s, and s changes by 3 / m times the impulse along the wall, the disc's
// inertia being m r^2 / 2. It slides to the end where 3 mu P / m < s, else it rolls.
static void a_sliding_disc_is_braked_until_it_rolls(void **state)
{
    (void)state;
    int rolling = 0;
    for (double sideways = -0.3; sideways < 0.31; sideways += 0.2) {
        for (double friction = 0.02; friction < 0.7; friction *= 5.0) {
            Kernel pin = disc(friction, sideways);
            run(&pin, DURATION_S);
            const PinSums end = single_pin_end(&pin);
            const double pressed = -end.impulse[0];
            const double needed = ONE_IMPACT_MASS / 3.0 * fabs(sideways);
            const double braked = fmin(friction * pressed, needed);
            // the wall turns by v t / r = 4e-4 during the contact; the default friction speed is a
            // fifth of the least left in sliding
            const double tolerance = 5e-4 * pressed;
            assert_near(end.impulse[1], copysign(braked, -sideways), tolerance);
            assert_near(end.impulse[3], DISC_RADIUS * copysign(braked, -sideways),
                        DISC_RADIUS * tolerance);
            // what the rim lost in sliding: the mean of both speeds along the impulse
            const double left = fabs(sideways) - 3.0 * braked / ONE_IMPACT_MASS;
            rolling += braked == needed ? 1 : 0;
            assert_near(end.friction, 0.5 * braked * (fabs(sideways) + left),
                        tolerance * fabs(sideways));
            kernel_finish(&pin);
        }
    }
    // the two slow ones roll from 0.1 on, the others from 0.5 on: neither formula would do for all
    assert_int_equal(rolling, 6);
}

// Forces from wall to disc have no moment about the hole's centre that the hole does not feel.
static void the_hole_is_turned_against_the_disc(void **state)
{
    (void)state;
    Kernel pin = disc(0.2, 0.2);
    run(&pin, DURATION_S);
    const PinSums end = single_pin_end(&pin);
    assert_true(end.impulse[2] > 0.0 && end.impulse[3] < 0.0);
    // of the disc: its centre's, at the wall, and its own
    const double own = (DISC_CLEARANCE + single_pin_depth()) * end.impulse[1] + end.impulse[3];
    // the wall turns by a few 1e-4 of it, and the arm is ten times the disc's radius
    assert_close(end.impulse[2], -own, 5e-3);
    // control: the disc's own moment is not all of it
    assert_true(end.impulse[2] > -5.0 * end.impulse[3]);
    kernel_finish(&pin);
}

// One duration in one call or in many, the state handed on from one to the next.
static void many_short_runs_are_one_long_one(void **state)
{
    (void)state;
    const double chi = damping_factor(DAMPING_LANKARANI_NIKRAVESH, 0.9);
    Kernel whole = single_pin(single_pin_hertz(chi), 0.01);
    whole.speed[1] = 0.05;
    Kernel parts = single_pin(single_pin_hertz(chi), 0.01);
    parts.speed[1] = 0.05;
    run(&whole, DURATION_S);
    const PinSums end = single_pin_end(&whole);
    const double lost = end.dissipated;
    double speeds[2];
    for (int row = 0; row < 2; row++) {
        speeds[row] = whole.speed[row] + end.impulse[row] / ONE_IMPACT_MASS;
    }
    enum { PARTS = 37 };
    double dissipated = 0.0;
    for (int part = 0; part < PARTS; part++) {
        const double width_s = DURATION_S / PARTS;
        run(&parts, width_s);
        const PinSums now = single_pin_end(&parts);
        dissipated += now.dissipated;
        for (int row = 0; row < 2; row++) {
            parts.position[row] += width_s * parts.speed[row] + now.moment[row] / ONE_IMPACT_MASS;
            parts.speed[row] += now.impulse[row] / ONE_IMPACT_MASS;
        }
    }
    // local steps fall elsewhere: the method's error at this phase, with room
    assert_near(parts.speed[0], speeds[0], 1e-9 * ONE_IMPACT_SPEED);
    assert_near(parts.speed[1], speeds[1], 1e-9 * ONE_IMPACT_SPEED);
    assert_close(dissipated, lost, 1e-7);
    kernel_finish(&whole);
    kernel_finish(&parts);
}

// Times in the middle of the contact, between nodes, against a run of a fiftieth of the phase:
// errors of force, impulse and moment over their largest. Next to the onset local steps do not go
// with the phase.
static void between_nodes_it_is_as_good_as_at_them(void **state)
{
    (void)state;
    static const double WANTED_S[] = {4.1e-5, 4.7e-5, 5.3e-5, 6.3e-5, 7.2e-5};
    enum { TIMES = sizeof WANTED_S / sizeof *WANTED_S };
    Kernel fine = single_pin(single_pin_hertz(0.2), 0.001);
    run(&fine, DURATION_S);
    double errors[2][3] = {{0.0}};
    for (int i = 0; i < 2; i++) {
        Kernel pin = single_pin(single_pin_hertz(0.2), i == 0 ? 0.2 : LONE_PIN_PHASE);
        run(&pin, DURATION_S);
        const PinSums end = single_pin_end(&pin);
        for (int k = 0; k < TIMES; k++) {
            PinSums truth;
            PinSums now;
            pin_sums_at(&fine, kernel_node(&fine, WANTED_S[k]), WANTED_S[k], &truth);
            pin_sums_at(&pin, kernel_node(&pin, WANTED_S[k]), WANTED_S[k], &now);
            const double differences[3] = {
                (now.force[0] - truth.force[0]) / 3000.0,
                (now.impulse[0] - truth.impulse[0]) / end.impulse[0],
                (now.moment[0] - truth.moment[0]) / end.moment[0],
            };
            for (int which = 0; which < 3; which++) {
                errors[i][which] = fmax(errors[i][which], fabs(differences[which]));
            }
        }
        kernel_finish(&pin);
    }
    // the force is the moment's second derivative, whose error is h^5 at nodes and h^3 there
    for (int which = 0; which < 3; which++) {
        assert_true(errors[1][which] < (which == 0 ? 1e-5 : 1e-6));
        assert_true(log2(errors[0][which] / errors[1][which]) / 2.0 > (which == 0 ? 2.5 : 3.5));
    }
    kernel_finish(&fine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_undamped_impact_is_hertz_closed_form),
        cmocka_unit_test(each_damping_law_gives_back_what_its_closed_form_says),
        cmocka_unit_test(a_linear_damper_never_pulls),
        cmocka_unit_test(the_error_falls_with_the_fourth_power_of_the_phase),
        cmocka_unit_test(an_onset_stands_where_the_flight_meets_the_wall),
        cmocka_unit_test(a_slow_pin_turns_back_before_the_wall),
        cmocka_unit_test(a_pin_that_crosses_the_hole_meets_the_other_wall),
        cmocka_unit_test(a_pin_moved_off_its_wall_comes_back_to_it),
        cmocka_unit_test(a_pin_that_turns_by_rounding_flies_on),
        cmocka_unit_test(a_weight_let_go_on_the_wall_sinks_at_once),
        cmocka_unit_test(a_pin_that_falls_back_touches_again),
        cmocka_unit_test(impulses_are_integrals_of_forces_and_move_the_pin),
        cmocka_unit_test(the_kinetic_energy_that_is_lost_is_what_the_damping_took),
        cmocka_unit_test(a_sliding_disc_is_braked_until_it_rolls),
        cmocka_unit_test(the_hole_is_turned_against_the_disc),
        cmocka_unit_test(many_short_runs_are_one_long_one),
        cmocka_unit_test(between_nodes_it_is_as_good_as_at_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
