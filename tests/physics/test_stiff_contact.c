// Does map impulse follow contacts of next to no restitution, whose damping would make explicit
// steps unstable, in steps as long as the motion is smooth?
//
// Outside truths: the closed forms of an impact, of a weight that sinks into a damper, of a disc
// that is braked; in whole runs the reference. The control is the explicit method alone.
#include "mechanism.h"
#include "ode_error.h"
#include "single_pin.h"
#include "sinking.h"

static const double WEIGHT = 9.80665; // m/s^2, towards the wall

static ForceLaw sticking(double restitution)
{
    return single_pin_hertz(damping_factor(DAMPING_FLORES, restitution));
}

static const double BESIDE = 1e-13; // m, next to nothing

// The pin at rest beside its wall.
static Kernel resting(double restitution)
{
    Kernel pin = single_pin(sticking(restitution), LONE_PIN_PHASE);
    pin.position[0] = ONE_IMPACT_CLEARANCE - BESIDE;
    pin.speed[0] = 0.0;
    pin.free[0] = WEIGHT;
    return pin;
}

static double depth_at_end(const Kernel *pin)
{
    const size_t last = pin->node_count - 1;
    return pin_pose_at(pin, 0, last, pin->times[last]).pose.penetration;
}

// Contacts that begin, of the only joint.
static size_t count_contacts(const Kernel *pin)
{
    size_t count = 0;
    for (size_t node = 1; node < pin->node_count; node++) {
        count += pin->touching[node] != 0 && pin->touching[node - 1] == 0;
    }
    return count;
}

// How far a weight's depth after a time is from its closed form, relative.
static double sinking_error(const Kernel *pin, double restitution, double duration_s)
{
    const double at_rest = pow(ONE_IMPACT_MASS * WEIGHT / ONE_IMPACT_HERTZ, 1.0 / 1.5);
    const double rate = 1e-3 / damping_factor(DAMPING_FLORES, restitution);
    // the depth goes with the power 0.4 of the time
    return fabs(sinking_time(depth_at_end(pin), at_rest, rate) / duration_s - 1.0) / 2.5;
}

static void a_weight_sinks_into_its_damper(void **state)
{
    (void)state;
    for (int digits = 6; digits <= 12; digits += 3) {
        const double restitution = pow(10.0, -digits);
        Kernel pin = resting(restitution);
        assert_true(kernel_run(&pin, 0.1));
        assert_true(sinking_error(&pin, restitution, 0.1) < 1e-5);
        assert_true(pin.contacts[0].state.is_touching);
        assert_true(pin.node_count < 400);
        assert_close(single_pin_end(&pin).force[0], -ONE_IMPACT_MASS * WEIGHT, 1e-5);
        kernel_finish(&pin);
    }
    // control: explicit steps throw the weight off the wall again and again, or are too many
    Kernel pin = resting(1e-9);
    pin.stable = INFINITY;
    assert_true(!kernel_run(&pin, 1e-3) || count_contacts(&pin) > 10 ||
                sinking_error(&pin, 1e-9, 1e-3) > 0.1);
    kernel_finish(&pin);
}

static void next_to_no_restitution_is_delivered(void **state)
{
    (void)state;
    for (int digits = 2; digits <= 6; digits += 2) {
        const double asked = pow(10.0, -digits);
        const double chi = damping_factor(DAMPING_FLORES, asked);
        const double depth =
            damping_depth_max(ONE_IMPACT_HERTZ, 1.5, chi, ONE_IMPACT_MASS, ONE_IMPACT_SPEED);
        Kernel pin = single_pin(sticking(asked), LONE_PIN_PHASE);
        // the flight, and three times what the way back takes at the speed given back
        const double duration_s = 1e-4 + 3.0 * depth / (asked * ONE_IMPACT_SPEED);
        assert_true(kernel_run(&pin, duration_s));
        assert_false(pin.contacts[0].state.is_touching);
        const double given_back = -single_pin_speed_after(&pin) / ONE_IMPACT_SPEED;
        assert_near(given_back, damping_delivered(chi), 1e-8);
        double deepest = 0.0;
        for (size_t node = 0; node < pin.node_count; node++) {
            PinSums sums;
            pin_sums_at(&pin, node, pin.times[node], &sums);
            deepest = fmax(deepest, pin_pose_at(&pin, 0, node, pin.times[node]).pose.penetration);
        }
        assert_close(deepest, depth, 1e-4);
        // all that the pin had is lost but for the square of the restitution
        const double kinetic = 0.5 * ONE_IMPACT_MASS * ONE_IMPACT_SPEED * ONE_IMPACT_SPEED;
        assert_close(single_pin_end(&pin).dissipated, kinetic * (1.0 - given_back * given_back),
                     1e-6);
        kernel_finish(&pin);
    }
}

// A step of the world starts beside the motion of the contact, by its own error or by rounding: the
// damper takes that up at once, and the forces within the step do not show it.
static void what_dies_away_at_once_is_not_in_the_forces(void **state)
{
    (void)state;
    for (int way = -1; way <= 1; way += 2) {
        Kernel pin = resting(1e-9);
        assert_true(kernel_run(&pin, 1e-3));
        const double settled = depth_at_end(&pin);
        pin.position[0] = ONE_IMPACT_CLEARANCE + settled;
        pin.speed[0] = way * 1e-8; // 1e-2 N s/m and more: 1e5 times that speed in N
        assert_true(kernel_run(&pin, 1e-3));
        assert_true(pin.contacts[0].state.is_touching);
        for (int i = 0; i <= 20; i++) {
            const double time_s = 5e-5 * i;
            PinSums sums;
            pin_sums_at(&pin, kernel_node(&pin, time_s), time_s, &sums);
            // a pin on its way out is let go for a nanosecond
            assert_true(way < 0 && i == 0
                            ? sums.force[0] > -ONE_IMPACT_MASS * WEIGHT
                            : fabs(sums.force[0] / (ONE_IMPACT_MASS * WEIGHT) + 1.0) < 1e-3);
        }
        kernel_finish(&pin);
    }
}

// A disc slides along a wall that hardly bends, pressed against it by N: its rim is braked by
// 3 mu N / m, of which a third is its centre's, and friction takes mu N times the way it slides.
// A viscous damper presses with c v from the first instant, between the nodes as well: with a force
// of zero there the polynomial to the next node rose 12 % above it, at any step.
static void a_damper_presses_hardest_at_its_onset(void **state)
{
    (void)state;
    ForceLaw law = force_law_power(2e7, 1.0);
    law.viscous = 4e3;
    Kernel pin = single_pin(law, LONE_PIN_PHASE);
    assert_true(kernel_run(&pin, 4e-5));
    const double most = law.viscous * ONE_IMPACT_SPEED;
    double highest = 0.0;
    size_t looked_at = 0;
    for (size_t node = 0; node + 1 < pin.node_count; node++) {
        for (int k = 0; pin.touching[node] != 0 && k < 32; k++) {
            const double share = k / 32.0;
            const double time_s = (1.0 - share) * pin.times[node] + share * pin.times[node + 1];
            PinSums sums;
            pin_sums_at(&pin, node, time_s, &sums);
            const KernelPose pose = pin_pose_at(&pin, 0, node, time_s);
            const double depth = fmax(pose.pose.penetration, 0.0);
            const double truth = law.stiffness * depth + law.viscous * pose.pose.approach_speed;
            assert_close(vec2_length(pose.force), truth, 1e-4);
            highest = fmax(highest, vec2_length(pose.force));
            looked_at++;
        }
    }
    assert_true(looked_at > 100);
    assert_close(highest, most, 1e-9);
    kernel_finish(&pin);
}

static void a_pressed_disc_is_braked_by_friction(void **state)
{
    (void)state;
    const double clearance = 0.5;
    const double radius = 5e-3;
    const double load = 1000.0; // m/s^2
    const double friction = 0.1;
    const double sideways = 0.3;
    const double duration_s = 2e-4;
    Kernel pin = kernel_start(LONE_PIN_PHASE);
    const KernelContact joint = {
        .law = force_law_with_friction(sticking(1e-9), friction, 5e-4),
        .radial_clearance = clearance,
        .hole_radius = clearance + radius,
    };
    kernel_add(&pin, &joint, KERNEL_ROWS_PLANE);
    kernel_make_room(&pin, pin.row_count);
    pin.mobility[0] = pin.mobility[5] = 1.0 / ONE_IMPACT_MASS;
    pin.mobility[15] = 2.0 / (ONE_IMPACT_MASS * radius * radius);
    pin.position[0] = clearance - BESIDE;
    pin.free[0] = load;
    pin.speed[1] = sideways;
    assert_true(kernel_run(&pin, duration_s));
    assert_true(pin.contacts[0].state.is_touching);
    assert_true(pin.node_count < 400);
    const PinSums end = single_pin_end(&pin);
    const double braking = friction * load;
    // the wall turns by s t / r = 1e-4, which needs s^2 / r = 2e-4 of the load
    const double within = 1e-3;
    assert_close(end.impulse[1], -ONE_IMPACT_MASS * braking * duration_s, within);
    assert_close(end.impulse[3], -radius * ONE_IMPACT_MASS * braking * duration_s, within);
    const double slid_m = duration_s * (sideways - 1.5 * braking * duration_s);
    assert_close(end.friction, ONE_IMPACT_MASS * braking * slid_m, within);
    kernel_finish(&pin);
}

static void usual_contacts_take_no_implicit_step(void **state)
{
    (void)state;
    for (double asked = 0.5; asked < 1.0; asked += 0.1) {
        Kernel pin = single_pin(sticking(asked), LONE_PIN_PHASE);
        assert_true(kernel_run(&pin, 2e-4));
        assert_true(pin.stages == NULL);
        kernel_finish(&pin);
    }
    // control: the same with next to no restitution
    Kernel pin = single_pin(sticking(1e-6), LONE_PIN_PHASE);
    assert_true(kernel_run(&pin, 2e-4));
    assert_true(pin.stages != NULL);
    kernel_finish(&pin);
}

// A pin slides round its hole under its weight. Its mobility is constant: steps of the world as
// long as a sample are as good as any.
static void a_sliding_pin_is_right_at_any_step(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.1, 1e-4);
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.contact.damping = DAMPING_FLORES;
    scenario.contact.restitution = 1e-9;
    scenario.gravity = scenario_downward(WEIGHT);
    scenario.linkage.bodies[0].start.position = (Vec2){-1e-4, 0.0};
    scenario.linkage.bodies[0].start.velocity.y = 0.03;
    scenario.run.duration = 0.05;
    scenario.run.samples = 20;
    for (double step_s = 2.5e-3; step_s > 1e-4; step_s /= 5.0) {
        assert_true(ode_error_at(scenario, BACKEND_REFERENCE, step_s).omega_max < 1e-5);
    }
}

static void errors_of_a_four_bar_fall_with_the_step(void **state)
{
    (void)state;
    Scenario scenario = mechanism_loose(1);
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.contact.damping = DAMPING_FLORES;
    scenario.contact.restitution = 1e-2;
    const OdeClimb climb = ode_climb(&scenario, BACKEND_REFERENCE, 40e-6, 4.0, 3);
    assert_true(ode_climb_order(&climb, 0, 2) > 1.5);
    assert_true(climb.errors[2].omega_max < 1e-5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_weight_sinks_into_its_damper),
        cmocka_unit_test(next_to_no_restitution_is_delivered),
        cmocka_unit_test(what_dies_away_at_once_is_not_in_the_forces),
        cmocka_unit_test(a_damper_presses_hardest_at_its_onset),
        cmocka_unit_test(a_pressed_disc_is_braked_by_friction),
        cmocka_unit_test(usual_contacts_take_no_implicit_step),
        cmocka_unit_test(a_sliding_pin_is_right_at_any_step),
        cmocka_unit_test(errors_of_a_four_bar_fall_with_the_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
