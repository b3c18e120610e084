// Does a pin slide along its hole as Coulomb's law has it, and where does the energy go?
//
// A pin pressed into its hole by gravity, the hole's axis at an angle theta to the horizontal. It
// slides along the axis with
//     v' = g (sin(theta) - mu cos(theta))
// and, since tanh has no corner, creeps at v_s atanh(tan(theta) / mu) where it would stick. The
// wall drags beside the centre: the ends do not carry the same, together they carry the weight.
#include "space_pin.h"

#include "complete_run.h"
#include "load_case.h"

static const double GRAVITY = 9.80665;
static const double CLEARANCE = 50e-6;
static const double STIFFNESS = 1e8; // N/m: the pin stands 1e-7 m in the wall

// The pin starts pressed, with a speed along the axis, m/s, downwards.
static Scenario pressed(double angle, double friction, double speed)
{
    Scenario scenario = space_pin(CLEARANCE, 0.0, 0.0, STIFFNESS);
    scenario.gravity = scenario_downward(GRAVITY);
    space_pin_damp(&scenario, 5e3);
    scenario.contact.friction = friction;
    scenario.contact.friction_speed = 1e-6;
    Body *body = &scenario.linkage.bodies[0];
    Joint *joint = &scenario.linkage.joints[0];
    joint->space.axis = (Vec3){0.0, -sin(angle), cos(angle)};
    // across the axis it is as deep as its weight presses it
    const double radius = CLEARANCE + GRAVITY * cos(angle) / STIFFNESS;
    body->start.position.y = -radius / cos(angle);
    joint->clearance.start = body->start.position;
    body->start.velocity.y = -speed * sin(angle);
    body->space.velocity_z = speed * cos(angle);
    scenario.run.duration = 0.03;
    scenario.run.samples = 300;
    return scenario;
}

static double speed_along(const Trajectory *run, size_t sample, double angle)
{
    const Vec3 velocity = trajectory_space_motion(run, sample, 0)->velocity;
    return vec3_dot(velocity, (Vec3){0.0, -sin(angle), cos(angle)});
}

// The largest distance of the speed from a steady acceleration, m/s, until a time.
static double steady_error(const Trajectory *run, double angle, double speed, double acceleration,
                           double until_s)
{
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count && run->times[k] <= until_s; k++) {
        const double truth = speed + acceleration * run->times[k];
        largest = fmax(largest, fabs(speed_along(run, k, angle) - truth));
    }
    return largest;
}

static void a_pin_slides_down_an_inclined_hole(void **state)
{
    (void)state;
    const double angle = 0.5;
    const Scenario scenario = pressed(angle, 0.3, 0.0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const double rate = GRAVITY * (sin(angle) - 0.3 * cos(angle));
    const double reached = rate * run->duration_s;
    assert_true(steady_error(run, angle, 0.0, rate, 1.0) < 2e-5 * reached);
    // both ends press, and not alike
    const SpaceJointState *joint = trajectory_space_state(run, run->sample_count - 1, 0);
    assert_true(joint->end_forces[0] > 0.0 && joint->end_forces[1] > 1.2 * joint->end_forces[0]);
    assert_near(run->energy.residual, 0.0, 1e-9 * run->energy.friction);
    // control: another coefficient
    const double other = GRAVITY * (sin(angle) - 0.301 * cos(angle));
    assert_true(steady_error(run, angle, 0.0, other, 1.0) > 1e-3 * reached);
    trajectory_destroy(run);
}

static void a_pin_sticks_in_a_flatter_hole(void **state)
{
    (void)state;
    const double angle = 0.25;
    for (double speed = 1e-4; speed > 5e-6; speed *= 0.1) {
        Scenario scenario = pressed(angle, 0.3, 0.0);
        scenario.contact.friction_speed = speed;
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const double creeping = speed_along(run, run->sample_count - 1, angle);
        assert_close(creeping, speed * atanh(tan(angle) / 0.3), 1e-4);
        trajectory_destroy(run);
    }
}

static void a_dragged_pin_stops(void **state)
{
    (void)state;
    const double speed = 0.05;
    const double friction = 0.2;
    const Scenario scenario = pressed(0.0, friction, speed);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const double stop_s = speed / (friction * GRAVITY);
    assert_true(stop_s < 0.9 * run->duration_s);
    assert_true(steady_error(run, 0.0, speed, -friction * GRAVITY, 0.999 * stop_s) < 1e-5 * speed);
    assert_near(speed_along(run, run->sample_count - 1, 0.0), 0.0, 1e-4 * speed);
    const double energy = 0.5 * speed * speed;
    assert_close(run->energy.friction, energy, 1e-5);
    assert_near(run->energy.residual, 0.0, 1e-9 * energy);
    // control: a pin that is not pressed goes on
    Scenario other = pressed(0.0, friction, speed);
    other.gravity = scenario_downward(0.0);
    other.linkage.bodies[0].start.position.y = -0.5 * CLEARANCE;
    Trajectory *free = complete_run(&other, BACKEND_REFERENCE);
    assert_near(speed_along(free, free->sample_count - 1, 0.0), speed, 1e-12);
    trajectory_destroy(free);
    trajectory_destroy(run);
}

// A four-bar whose coupler has its mass beside the plane of its joints and play at both: its pins
// tilt and slide, damp and rub.
static void energy_is_accounted_for_to_a_share_of_1e_9(void **state)
{
    (void)state;
    const char *const frictions[] = {"contact.friction=0", "contact.friction=0.1"};
    for (int i = 0; i < 2; i++) {
        const char *const overrides[] = {
            "space=spatial",
            "four-bar.coupler.offset=5 mm",
            "joints.coupler-follower={radial-clearance: 14.5 um, width: 13 mm, "
            "axial-clearance: 20 um}",
            "run.revolutions=0.2",
            frictions[i],
        };
        const Scenario scenario = load("cases/paper/impact-k66.yaml", overrides, 5);
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const Energy *energy = &run->energy;
        assert_true(run->joints[1].tilt_max.value > 1e-4);
        assert_true(run->joints[2].axial_max.value > 1e-6);
        const double largest = fmax(fabs(energy->drive_work), fabs(energy->change));
        assert_true(fabs(energy->residual) <= 1e-9 * largest);
        // controls: what a loss left out would leave
        assert_true(energy->dissipated > 1e-5 * largest);
        assert_true(i == 0 || energy->friction > 1e-5 * largest);
        trajectory_destroy(run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pin_slides_down_an_inclined_hole),
        cmocka_unit_test(a_pin_sticks_in_a_flatter_hole),
        cmocka_unit_test(a_dragged_pin_stops),
        cmocka_unit_test(energy_is_accounted_for_to_a_share_of_1e_9),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
