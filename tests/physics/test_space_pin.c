// Does a pin in space stand, tilt and bounce in its hole as statics and closed forms have it?
//
// With w the hole's width, c the clearance, phi the tilt and d1, d2 the depths of the two ends:
//     both ends at opposite sides:  sin(phi) = (2 c + d1 + d2) / w
//     moment of the two ends, the pin's axis through the middle:  F(d) w cos(phi),
//     d = (w / 2) sin(phi) - c, F of half of the joint's law
#include "space_pin.h"

#include "close.h"
#include "complete_run.h"

static const double GRAVITY = 9.80665;
static const double CLEARANCE = 50e-6;
static const double AXIAL = 100e-6;

static const SpaceJointState *joint_at_end(const Trajectory *run)
{
    return trajectory_space_state(run, run->sample_count - 1, 0);
}

// A pin whose centre of mass hangs beside its hole, until it has come to rest.
static Trajectory *hang(double along, double stiffness)
{
    Scenario scenario = space_pin(CLEARANCE, AXIAL, along, stiffness);
    scenario.gravity = scenario_downward(GRAVITY);
    space_pin_damp(&scenario, 0.6 * sqrt(stiffness));
    scenario.run.duration = 1.0;
    scenario.run.samples = 50;
    return complete_run(&scenario, BACKEND_REFERENCE);
}

static void a_pin_tilts_to_its_limit(void **state)
{
    (void)state;
    double before = INFINITY;
    for (double stiffness = 1e6; stiffness < 2e8; stiffness *= 10.0) {
        Trajectory *run = hang(30e-3, stiffness);
        const SpaceJointState *joint = joint_at_end(run);
        assert_true(joint->end_gaps[0] < 0.0 && joint->end_gaps[1] < 0.0);
        assert_true(joint->ends[0].y > 0.0 && joint->ends[1].y < 0.0);
        const double depths = -joint->end_gaps[0] - joint->end_gaps[1];
        const double sine = (2.0 * CLEARANCE + depths) / SPACE_PIN_WIDTH;
        assert_near(sin(joint->tilt), sine, 1e-12);
        // of rigid walls
        const double limit = 2.0 * CLEARANCE / SPACE_PIN_WIDTH;
        const double off = fabs(sin(joint->tilt) / limit - 1.0);
        assert_true(off < 0.2 * before);
        assert_near(tan(joint->tilt), sine, 0.51 * sine * sine * sine);
        before = off;
        trajectory_destroy(run);
    }
    assert_true(before < 1e-2);
    // control: with the mass between the ends it does not tilt to any limit
    Trajectory *run = hang(2e-3, 1e6);
    assert_true(sin(joint_at_end(run)->tilt) < 0.1 * 2.0 * CLEARANCE / SPACE_PIN_WIDTH);
    trajectory_destroy(run);
}

// Statics, u the pin's axis, of a pin at rest on both ends and on one collar: the forces of the
// ends are across the pin, that of the collar along the hole.
static void each_end_carries_its_share_by_the_levers(void **state)
{
    (void)state;
    const double along = 30e-3;
    const double stiffness = 1e7;
    Trajectory *run = hang(along, stiffness);
    const SpaceJointState *joint = joint_at_end(run);
    const double phi = joint->tilt;
    // where the hole's middle is along the pin, from the pin's middle
    const double foot = joint->offset.y * sin(phi) - joint->offset.z * cos(phi);
    const double difference = GRAVITY / cos(phi);
    const double sum = 2.0 * GRAVITY / SPACE_PIN_WIDTH * (along - foot / (cos(phi) * cos(phi)));
    assert_close(joint->end_forces[1], 0.5 * (sum + difference), 1e-7);
    assert_close(joint->end_forces[0], 0.5 * (sum - difference), 1e-7);
    assert_close(joint->axial_force, -GRAVITY * tan(phi), 1e-7);
    assert_near(joint->force_on_b.y, GRAVITY, 1e-6);
    // each end has half of the stiffness, the collar all of it
    for (int i = 0; i < 2; i++) {
        assert_close(joint->end_forces[i], -0.5 * stiffness * joint->end_gaps[i], 1e-12);
    }
    assert_close(-joint->axial_force, stiffness * (joint->axial - AXIAL), 1e-9);
    // control: levers of the plane, without the tilt
    assert_true(fabs(joint->end_forces[1] / (GRAVITY * (along / SPACE_PIN_WIDTH + 0.5)) - 1.0) >
                1e-5);
    trajectory_destroy(run);
}

// A pin that turns about a line across its axis until both its ends press.
static void the_moment_of_two_ends_is_that_of_its_closed_form(void **state)
{
    (void)state;
    const double stiffness = 1e7;
    const double clearance = 1e-3; // a limit of 0.1 rad: sines and tangents differ
    Scenario scenario = space_pin(clearance, 0.0, 0.0, stiffness);
    Body *body = &scenario.linkage.bodies[0];
    const double turning = 60.0;
    body->space.omega_x = turning;
    scenario.run.duration = 10e-3;
    scenario.run.samples = 1000;
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    size_t pressed = 0;
    double deepest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const SpaceMotion *motion = trajectory_space_motion(run, k, 0);
        const double phi = trajectory_space_state(run, k, 0)->tilt;
        const double depth = 0.5 * SPACE_PIN_WIDTH * sin(phi) - clearance;
        const double force = 0.5 * stiffness * fmax(depth, 0.0);
        const double moment = force * SPACE_PIN_WIDTH * cos(phi);
        const double sign = quat_rotate(motion->turn, (Vec3){0.0, 0.0, 1.0}).y < 0.0 ? -1.0 : 1.0;
        assert_near(body->space.inertia_x * motion->alpha.x, sign * moment, 1e-9 * 60.0);
        if (depth > 1e-5) {
            pressed++;
            // control: with the levers of a pin that stands straight
            assert_true(fabs(moment - force * SPACE_PIN_WIDTH) > 1e-3 * moment);
        }
        deepest = fmax(deepest, depth);
    }
    assert_true(pressed > 20);
    // all of the energy is in both springs where it turns back
    const double energy = 0.5 * body->space.inertia_x * turning * turning;
    assert_close(run->joints[0].penetration_max.value, sqrt(2.0 * energy / stiffness), 1e-9);
    assert_true(deepest <= run->joints[0].penetration_max.value);
    assert_close(run->joints[0].force_max.value, stiffness * run->joints[0].penetration_max.value,
                 1e-9);
    trajectory_destroy(run);
}

static double speed_at_end(const Trajectory *run)
{
    return trajectory_space_motion(run, run->sample_count - 1, 0)->velocity.z;
}

static void a_pin_bounces_between_its_collars(void **state)
{
    (void)state;
    const double speed = 0.2;
    const double stiffness = 1e7;
    Scenario scenario = space_pin(CLEARANCE, AXIAL, 0.0, stiffness);
    scenario.linkage.bodies[0].space.velocity_z = speed;
    // there and back: twice the play on both sides, and half a swing of the spring at either
    const double period = 4.0 * AXIAL / speed + 2.0 * M_PI * sqrt(1.0 / stiffness);
    scenario.run.duration = 10.0 * period;
    scenario.run.samples = 10;
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    for (size_t k = 0; k < run->sample_count; k++) {
        const SpaceMotion *motion = trajectory_space_motion(run, k, 0);
        assert_near(motion->position.z, 0.0, 1e-9 * AXIAL);
        assert_near(motion->velocity.z, speed, 1e-10 * speed);
        assert_near(motion->position.x, 0.0, 1e-18);
    }
    // the pin has gone no further than the spring lets it
    assert_true(run->joints[0].axial_max.value <= AXIAL + speed * sqrt(1.0 / stiffness) + 1e-12);
    assert_near(run->energy.residual, 0.0, 1e-12 * 0.5 * speed * speed);
    trajectory_destroy(run);
    // control: a damped collar gives back what its law delivers
    scenario.contact.damping = DAMPING_EXACT;
    scenario.contact.restitution = 0.7;
    scenario.run.duration = 1.5 * AXIAL / speed + M_PI * sqrt(1.0 / stiffness);
    run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_close(speed_at_end(run), -0.7 * speed, 1e-9);
    assert_close(run->energy.dissipated, 0.5 * speed * speed * (1.0 - 0.49), 1e-9);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pin_tilts_to_its_limit),
        cmocka_unit_test(each_end_carries_its_share_by_the_levers),
        cmocka_unit_test(the_moment_of_two_ends_is_that_of_its_closed_form),
        cmocka_unit_test(a_pin_bounces_between_its_collars),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
