// Does a pin stick, slide and come to rest in its hole as Coulomb's law has it?
//
// A block, a pin too heavy to turn, in a hole that is 0.2 m wide: with orbit radius R, angle phi
// from the lowest point and w = (R phi')^2, sliding against friction mu obeys a linear equation,
//     dw/dx = 2 g R (sin phi - mu cos phi) - 2 mu w,    x: angle travelled downwards,
// which has the closed form below. Against it the reference to the depth of the contact, and ODE's
// rows with their order. The controls have another coefficient.
#include "close.h"

#include "complete_run.h"
#include "mechanism.h"
#include "ode_error.h"

static const double GRAVITY = 9.80665;
static const double CLEARANCE = 0.1;      // m
static const double STIFFNESS = 1e13;     // N/m^1.5: the block stands 1e-8 m in the wall
static const double VISCOUS = 2e4;        // N s/m: a third of the critical damping
static const double STEEP = 1.2;          // rad, from the lowest point
static const double SLIDING_SPEED = 1e-6; // m/s, over which the reference's friction sets in

// A block that starts pressed against the wall, at an angle from the lowest point and with a speed
// up the wall, m/s.
static Scenario block(double friction, double angle, double speed)
{
    Scenario scenario = mechanism_pin(1.0, CLEARANCE);
    Body *body = &scenario.linkage.bodies[0];
    body->inertia = 1e9;
    const double pressing = GRAVITY * cos(angle) + speed * speed / CLEARANCE;
    const double radius = CLEARANCE + pow(pressing / STIFFNESS, 1.0 / 1.5);
    body->start.position = (Vec2){radius * sin(angle), -radius * cos(angle)};
    body->start.velocity = (Vec2){speed * cos(angle), speed * sin(angle)};
    scenario.linkage.joints[0].clearance.start = body->start.position;
    scenario.gravity = scenario_downward(GRAVITY);
    scenario.contact.stiffness = STIFFNESS;
    scenario.contact.exponent = 1.5;
    scenario.contact.damping = DAMPING_VISCOUS;
    scenario.contact.viscous_coefficient = VISCOUS;
    scenario.contact.friction = friction;
    scenario.contact.friction_speed = SLIDING_SPEED;
    scenario.run.duration = 0.1;
    scenario.run.samples = 100;
    return scenario;
}

static double angle_of(Vec2 position)
{
    return atan2(position.x, -position.y);
}

// w of a block that friction pushes one way along the wall: up it where the sign is 1. At an angle,
// having had w_start at another.
static double sliding_square(double friction, double sign, double start, double w_start,
                             double angle)
{
    const double mu = sign * friction;
    const double scale = 2.0 * GRAVITY * CLEARANCE / (1.0 + 4.0 * mu * mu);
    const double cosine = scale * (1.0 - 2.0 * mu * mu);
    const double sine = scale * 3.0 * mu;
    const double rest = w_start - cosine * cos(start) - sine * sin(start);
    return cosine * cos(angle) + sine * sin(angle) + rest * exp(2.0 * mu * (angle - start));
}

// The angle at which a block that starts at the lowest point with a speed comes to rest, by
// bisection below a bound.
static double rest_angle(double friction, double sign, double speed, double bound)
{
    double low = 1e-3;
    double high = bound;
    for (int i = 0; i < 100; i++) {
        const double middle = 0.5 * (low + high);
        const bool is_moving = sliding_square(friction, sign, 0.0, speed * speed, middle) > 0.0;
        *(is_moving ? &low : &high) = middle;
    }
    return low;
}

// The largest distance of the speeds from the closed form, m/s, of a block that slides down.
static double slide_error(const Trajectory *run, double friction, double angle)
{
    double largest = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        const Motion *motion = trajectory_motion(run, i, 0);
        const double square = sliding_square(friction, 1.0, angle, 0.0, angle_of(motion->position));
        const double error = fabs(vec2_length(motion->velocity) - sqrt(fmax(square, 0.0)));
        largest = fmax(largest, error);
    }
    return largest;
}

static const Motion *at_end(const Trajectory *run)
{
    return trajectory_motion(run, run->sample_count - 1, 0);
}

static void assert_balance(const Trajectory *run)
{
    assert_true(run->energy.friction > 0.0);
    assert_near(run->energy.residual, 0.0, 1e-9 * run->energy.friction);
}

static void a_block_slides_down_as_its_closed_form(void **state)
{
    (void)state;
    const Scenario scenario = block(0.3, STEEP, 0.0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(vec2_length(at_end(run)->velocity) > 0.6);
    // the contact is as deep as 1e-7 of the orbit, and friction sets in over 1e-6 m/s
    assert_true(slide_error(run, 0.3, STEEP) < 1e-7);
    assert_true(slide_error(run, 0.3001, STEEP) > 1e-5);
    assert_balance(run);
    trajectory_destroy(run);
}

// tanh has no corner: below the angle of friction the block creeps at v_s atanh(tan phi / mu).
static void a_block_sticks_below_the_angle_of_friction(void **state)
{
    (void)state;
    for (double speed = 1e-3; speed > 1e-6; speed *= 0.1) {
        Scenario scenario = block(0.3, 0.25, 0.0);
        scenario.contact.friction_speed = speed;
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const double slope = tan(angle_of(at_end(run)->position));
        // but for the inertia of what creeps ever more slowly
        assert_close(vec2_length(at_end(run)->velocity), speed * atanh(slope / 0.3), 3e-4);
        trajectory_destroy(run);
    }
    // control: just above it the block slides
    const Scenario scenario = block(0.3, atan(0.3) + 0.01, 0.0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(vec2_length(at_end(run)->velocity) > 1e3 * SLIDING_SPEED);
    trajectory_destroy(run);
}

static void a_block_thrown_up_the_wall_stays_where_it_comes_to_rest(void **state)
{
    (void)state;
    const Scenario scenario = block(0.5, 0.0, 0.6);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_near(angle_of(at_end(run)->position), rest_angle(0.5, -1.0, 0.6, 1.0), 1e-6);
    assert_true(vec2_length(at_end(run)->velocity) < SLIDING_SPEED);
    assert_true(fabs(rest_angle(0.501, -1.0, 0.6, 1.0) - rest_angle(0.5, -1.0, 0.6, 1.0)) > 1e-4);
    assert_balance(run);
    trajectory_destroy(run);
}

// The hole in a drum that turns about the hole's centre, its wall at 10 m/s: friction drags the
// block up from the lowest point, and on its way back still pushes upwards.
static Scenario drum(double friction, double angle)
{
    Scenario scenario = block(friction, angle, 0.0);
    Linkage *linkage = &scenario.linkage;
    linkage->bodies[linkage->body_count++] = (Body){.name = "drum", .mass = 1.0, .inertia = 0.01};
    linkage->joints[0].body_a = 1;
    linkage->joints[linkage->joint_count++] = (Joint){
        .name = "axle",
        .kind = JOINT_REVOLUTE,
        .body_a = LINKAGE_GROUND,
        .body_b = 1,
    };
    linkage->driver = (Driver){.is_present = true, .joint = 1, .speed = 100.0};
    scenario.run.revolutions = 8.0;
    scenario.run.samples = 1000;
    return scenario;
}

static void a_block_is_dragged_up_a_turning_wall_as_far_as_its_closed_form(void **state)
{
    (void)state;
    const Scenario scenario = drum(0.3, 0.0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    double highest = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        highest = fmax(highest, angle_of(trajectory_motion(run, i, 0)->position));
    }
    // the samples stand 63 us apart, in which the block turns back from 1e-8 m
    assert_near(highest, rest_angle(0.3, 1.0, 0.0, 1.5), 1e-7);
    assert_true(angle_of(at_end(run)->position) < 0.5 * highest);
    assert_balance(run);
    trajectory_destroy(run);
}

static void a_block_stays_on_a_turning_wall_at_the_angle_of_friction(void **state)
{
    (void)state;
    for (int k = 1; k <= 3; k++) {
        const double friction = 0.3 * k;
        const Scenario scenario = drum(friction, atan(friction));
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        assert_near(angle_of(at_end(run)->position), atan(friction), 1e-9);
        trajectory_destroy(run);
    }
}

// Coulomb's law has a corner in ODE's rows. A slide does not see it.
static void the_rows_of_ode_slide_as_the_closed_form(void **state)
{
    (void)state;
    Scenario scenario = block(0.3, STEEP, 0.0);
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_MIDPOINT;
    scenario.run.step = 1e-5;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    assert_true(slide_error(run, 0.3, STEEP) < 1e-7);
    assert_true(slide_error(run, 0.3001, STEEP) > 1e-5);
    trajectory_destroy(run);
}

static void the_rows_of_ode_stick_as_the_reference_does(void **state)
{
    (void)state;
    Scenario scenario = block(0.3, 0.25, 0.0);
    scenario.contact.friction_speed = 1e-3;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_MIDPOINT;
    scenario.run.step = 1e-5;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const double slope = tan(angle_of(at_end(run)->position));
    const double speed = vec2_length(at_end(run)->velocity);
    assert_close(speed, 1e-3 * atanh(slope / 0.3), 3e-4);
    assert_true(fabs(speed - 1e-3 * atanh(slope / 0.301)) > 5e-3 * speed);
    trajectory_destroy(run);
}

// The errors in omega at 4 us and 1 us against the reference, with another coefficient in ODE.
static void climb(Scenario scenario, double friction_of_ode, double errors[2])
{
    static const double STEPS_S[] = {4e-6, 1e-6};
    scenario.run.revolutions = 0.1;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_MIDPOINT;
    scenario.contact.friction = 0.1;
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    for (size_t i = 0; i < 2; i++) {
        scenario.contact.friction = friction_of_ode;
        scenario.run.step = STEPS_S[i];
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        errors[i] = error_against(run, truth, INFINITY).omega_max;
        trajectory_destroy(run);
    }
    trajectory_destroy(truth);
}

// In a linkage friction changes what presses, in its own joint and in others, and pins stop and
// turn back. ODE's own bound, with a corner at rest, gave 7e-5, 8e-4 and 1e-2 at 1 us.
static void the_rows_of_ode_converge_to_the_reference_with_order_2(void **state)
{
    (void)state;
    for (size_t joints = 1; joints <= 3; joints++) {
        double errors[2];
        double missed[2];
        climb(mechanism_loose(joints), 0.1, errors);
        assert_true(ode_order(errors[0], errors[1], 4.0) > 1.9);
        assert_true(errors[1] < 5e-5);
        climb(mechanism_loose(joints), 0.102, missed);
        assert_true(ode_order(missed[0], missed[1], 4.0) < 1.0);
        assert_true(missed[1] > 4.0 * errors[1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_slides_down_as_its_closed_form),
        cmocka_unit_test(a_block_sticks_below_the_angle_of_friction),
        cmocka_unit_test(a_block_thrown_up_the_wall_stays_where_it_comes_to_rest),
        cmocka_unit_test(a_block_is_dragged_up_a_turning_wall_as_far_as_its_closed_form),
        cmocka_unit_test(a_block_stays_on_a_turning_wall_at_the_angle_of_friction),
        cmocka_unit_test(the_rows_of_ode_slide_as_the_closed_form),
        cmocka_unit_test(the_rows_of_ode_stick_as_the_reference_does),
        cmocka_unit_test(the_rows_of_ode_converge_to_the_reference_with_order_2),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
