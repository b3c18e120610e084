// Do bodies that stop one another bounce in ODE as they must, their contacts integrated within the
// step?
//
// A ball on a stiff floor: approach speeds e^n v0, onsets at sqrt(2 h / g) (1 + 2 (e + ... + e^n)).
// A row of discs on F = K d^1.5: calculated here by itself, m x_i'' = F_i - F_(i+1).
#include "kept.h"
#include "ode_error.h"

#include <stdio.h>
#include <string.h>

enum { DISCS = 5 };

static const double RADIUS = 0.02;  // m
static const double MASS = 0.26;    // kg
static const double HERTZ = 1e9;    // N/m^1.5
static const double THREAD = 0.25;  // m
static const double SPEED = 0.8;    // m/s, of the first disc of a row
static const double GRAVITY = 9.81; // m/s^2

static Scenario scene(double step_s)
{
    Scenario scenario = kept_default();
    scenario.gravity = scenario_downward(GRAVITY);
    scenario.run.backend_count = 1;
    scenario.run.backends[0] = BACKEND_ODE;
    scenario.run.step = step_s;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.ode.contact_phase = 0.0125; // of errors of 2e-8 in a contact
    scenario.contact.stiffness = HERTZ;
    scenario.contact.exponent = 1.5;
    scenario.contact.damping = DAMPING_NONE;
    return scenario;
}

static void add_disc(Linkage *linkage, Vec2 position, Vec2 velocity)
{
    Body *body = &linkage->bodies[linkage->body_count];
    *body = (Body){
        .mass = MASS,
        .inertia = 0.4 * MASS * RADIUS * RADIUS,
        .start = {.position = position, .velocity = velocity},
    };
    snprintf(body->name, sizeof body->name, "disc-%zu", linkage->body_count++);
}

static void add_joint(Linkage *linkage, Joint joint)
{
    snprintf(joint.name, sizeof joint.name, "joint-%zu", linkage->joint_count);
    linkage->joints[linkage->joint_count++] = joint;
}

static void stop_discs(Linkage *linkage)
{
    for (int i = 0; i + 1 < DISCS; i++) {
        add_joint(linkage, (Joint){
                               .kind = JOINT_STOP,
                               .body_a = i,
                               .body_b = i + 1,
                               .stop = {.is_disc = true, .radius_a = RADIUS, .radius_b = RADIUS},
                           });
    }
}

static void a_ball_on_a_floor_keeps_its_restitution(void **state)
{
    (void)state;
    const double e = 0.8;
    const double fall_s = sqrt(2.0 * 0.1 / GRAVITY);
    // the wall may look anywhere, and the ball's disc be a point
    for (int i = 0; i < 2; i++) {
        Scenario scenario = scene(1e-3);
        const double radius = i == 0 ? RADIUS : 0.0;
        scenario.contact.stiffness = 1e13; // N/m: a contact lasts half a microsecond
        scenario.contact.exponent = 1.0;
        scenario.contact.damping = DAMPING_EXACT;
        scenario.contact.restitution = e;
        scenario.run.duration = 0.9;
        scenario.run.samples = 10;
        add_disc(&scenario.linkage, (Vec2){0.0, radius + 0.1}, (Vec2){0.0, 0.0});
        add_joint(&scenario.linkage, (Joint){
                                         .kind = JOINT_STOP,
                                         .body_a = LINKAGE_GROUND,
                                         .body_b = 0,
                                         .anchor_a = {0.7, 0.0},
                                         .direction = 0.5 * M_PI,
                                         .stop = {.radius_b = radius},
                                     });
        Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
        const JointExtremes *stop = &ode->joints[0];
        assert_int_equal(stop->impacts, 5);
        // the strongest first, and each is weaker than the one before
        double onset_s = fall_s;
        double speed = GRAVITY * fall_s;
        double impulse = 0.0;
        for (size_t n = 0; n < stop->impacts; n++) {
            assert_near(stop->spikes[n].onset_s, onset_s, 3e-6);
            assert_close(stop->spikes[n].approach_speed, speed, 1e-5);
            impulse += (1.0 + e) * MASS * speed;
            speed *= e;
            onset_s += 2.0 * speed / GRAVITY;
        }
        assert_close(stop->impulse, impulse, 1e-5);
        // control: a restitution off by a ten-thousandth
        assert_true(fabs(stop->spikes[4].approach_speed / (pow(e + 1e-4, 4.0) * GRAVITY * fall_s) -
                         1.0) > 1e-4);
        trajectory_destroy(ode);
    }
}

// A row of discs, the first of which flies at the others.
static Scenario row(double gap)
{
    Scenario scenario = scene(1e-4);
    scenario.gravity = scenario_downward(0.0);
    scenario.run.duration = gap > 0.0 ? 6e-3 : 2e-3;
    scenario.run.samples = 10;
    for (int i = 0; i < DISCS; i++) {
        // at an angle with the axes
        const double along = i * (2.0 * RADIUS + gap);
        add_disc(&scenario.linkage, (Vec2){0.6 * along, 0.8 * along},
                 i == 0 ? (Vec2){0.6 * SPEED, 0.8 * SPEED} : (Vec2){0.0, 0.0});
    }
    stop_discs(&scenario.linkage);
    return scenario;
}

// The same, by itself: positions and speeds along the row, by the classical method.
static void row_rates(const double *state, double gap, double *rates)
{
    double force[DISCS + 1] = {0.0};
    for (int i = 0; i + 1 < DISCS; i++) {
        const double depth = state[i] - state[i + 1] - gap;
        force[i + 1] = depth > 0.0 ? HERTZ * pow(depth, 1.5) : 0.0;
    }
    for (int i = 0; i < DISCS; i++) {
        rates[i] = state[DISCS + i];
        rates[DISCS + i] = (force[i] - force[i + 1]) / MASS;
    }
}

static void row_alone(double gap, double duration_s, double *speeds)
{
    enum { SIZE = 2 * DISCS, STEPS = 60000 };
    const double weights[4] = {0.0, 0.5, 0.5, 1.0};
    const double step_s = duration_s / STEPS;
    double state[SIZE] = {[DISCS] = SPEED};
    for (int n = 0; n < STEPS; n++) {
        double stages[4][SIZE];
        double at[SIZE];
        for (int k = 0; k < 4; k++) {
            for (int i = 0; i < SIZE; i++) {
                at[i] = state[i] + (k > 0 ? weights[k] * step_s * stages[k - 1][i] : 0.0);
            }
            row_rates(at, gap, stages[k]);
        }
        for (int i = 0; i < SIZE; i++) {
            state[i] +=
                step_s / 6.0 * (stages[0][i] + 2.0 * (stages[1][i] + stages[2][i]) + stages[3][i]);
        }
    }
    memcpy(speeds, state + DISCS, DISCS * sizeof *speeds);
}

// At gap 0 all contacts are one; with a gap each is over before the next begins, and each disc
// hands its speed on.
static void discs_in_a_row_part_as_calculated(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        const double gap = i == 0 ? 0.0 : 0.02 * 2.0 * RADIUS;
        const Scenario scenario = row(gap);
        double truth[DISCS];
        row_alone(gap, scenario.run.duration, truth);
        Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
        double momentum = 0.0;
        for (size_t k = 0; k < DISCS; k++) {
            const Vec2 velocity = trajectory_motion(ode, 10, k)->velocity;
            const double along = 0.6 * velocity.x + 0.8 * velocity.y;
            print_message("# gap %g m, disc %zu: %.9f of the speed, off by %.2g\n", gap, k,
                          along / SPEED, (along - truth[k]) / SPEED);
            assert_near(along, truth[k], 2e-7 * SPEED);
            assert_near(0.8 * velocity.x - 0.6 * velocity.y, 0.0, 1e-9 * SPEED);
            momentum += along;
            // control: one impact after the other
            const double handed_on = k == DISCS - 1 ? SPEED : 0.0;
            assert_true(i == 1 ? fabs(along - handed_on) < 1e-6 * SPEED
                               : k < 2 || fabs(along - handed_on) > 5e-3 * SPEED);
        }
        assert_near(momentum, SPEED, 1e-12);
        assert_near(ode->energy.residual, 0.0, 1e-7 * MASS * SPEED * SPEED);
        trajectory_destroy(ode);
    }
}

// Newton's cradle: the discs hang on threads, the first is let go.
static Scenario cradle(double gap, double friction)
{
    Scenario scenario = scene(1e-3);
    Linkage *linkage = &scenario.linkage;
    scenario.run.duration = 0.4;
    scenario.run.samples = 100;
    scenario.contact.friction = friction;
    for (int i = 0; i < DISCS; i++) {
        const double angle = i == 0 ? -0.5 : 0.0;
        const double foot = i * (2.0 * RADIUS + gap);
        const Vec2 hanging = {THREAD * sin(angle), -THREAD * cos(angle)};
        add_disc(linkage, (Vec2){foot + hanging.x, hanging.y}, (Vec2){0.0, 0.0});
        add_joint(linkage, (Joint){
                               .kind = JOINT_REVOLUTE,
                               .body_a = LINKAGE_GROUND,
                               .body_b = i,
                               .anchor_a = {foot, 0.0},
                               .anchor_b = vec2_scale(-1.0, hanging),
                           });
    }
    stop_discs(linkage);
    return scenario;
}

static void a_cradle_follows_the_reference_with_the_second_order(void **state)
{
    (void)state;
    static const double GAPS[3] = {0.0, 8e-4, 8e-4};
    static const double FRICTION[3] = {0.0, 0.0, 0.2};
    for (int i = 0; i < 3; i++) {
        Scenario scenario = cradle(GAPS[i], FRICTION[i]);
        Trajectory *exact = complete_run(&scenario, BACKEND_REFERENCE);
        double errors[2];
        for (int k = 0; k < 2; k++) {
            scenario.run.step = k == 0 ? 2.5e-4 : 3.125e-5;
            Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
            errors[k] = error_against(ode, exact, INFINITY).max;
            for (size_t joint = DISCS; joint < ode->joint_count; joint++) {
                assert_int_equal(ode->joints[joint].impacts, exact->joints[joint].impacts);
                assert_close(ode->joints[joint].force_max.value,
                             exact->joints[joint].force_max.value, 1e-3);
            }
            trajectory_destroy(ode);
        }
        print_message("# gap %g m, friction %g: error %.3g, %.3g\n", GAPS[i], FRICTION[i],
                      errors[0], errors[1]);
        // where in its step a contact begins changes an error by half
        assert_near(ode_order(errors[0], errors[1], 8.0), 2.0, 0.4);
        trajectory_destroy(exact);
    }
}

// A driven disc strikes the line of a rocker, which turns: the drive's work is in the balance.
static void the_drive_pays_for_what_its_disc_strikes(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        Scenario scenario = scene(1e-4);
        Linkage *linkage = &scenario.linkage;
        add_disc(linkage, (Vec2){0.05, 0.0}, (Vec2){0.0, 0.5});
        linkage->bodies[0].start.omega = 10.0;
        add_disc(linkage, (Vec2){0.1, 0.05}, (Vec2){0.0, -0.3});
        linkage->bodies[1].start.omega = -3.0;
        linkage->bodies[1].inertia = 4e-3;
        add_joint(linkage,
                  (Joint){.body_a = LINKAGE_GROUND, .body_b = 0, .anchor_b = {-0.05, 0.0}});
        add_joint(linkage, (Joint){.body_a = LINKAGE_GROUND,
                                   .body_b = 1,
                                   .anchor_a = {0.0, 0.05},
                                   .anchor_b = {-0.1, 0.0}});
        const Joint line = {.kind = JOINT_STOP,
                            .body_a = 1,
                            .body_b = 0,
                            .anchor_a = {-0.1, 0.0},
                            .anchor_b = {0.05, 0.0},
                            .direction = -0.5 * M_PI,
                            .stop = {.radius_b = 0.01}};
        const Joint discs = {.kind = JOINT_STOP,
                             .body_a = 0,
                             .body_b = 1,
                             .anchor_a = {0.05, 0.0},
                             .stop = {.is_disc = true, .radius_a = 0.01, .radius_b = 0.02}};
        add_joint(linkage, i / 2 == 0 ? line : discs);
        linkage->driver = (Driver){.is_present = true, .joint = 0, .speed = 10.0, .start = 0.0};
        scenario.contact.friction = i % 2 == 0 ? 0.0 : 0.2;
        scenario.contact.damping = DAMPING_EXACT;
        scenario.contact.restitution = 0.7;
        scenario.run.revolutions = 0.1;
        scenario.run.samples = 1000;
        Trajectory *exact = complete_run(&scenario, BACKEND_REFERENCE);
        double residuals[2];
        double frozen[2];
        for (int k = 0; k < 2; k++) {
            scenario.run.step = k == 0 ? 8e-5 : 2e-5;
            Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
            residuals[k] = fabs(ode->energy.residual);
            assert_int_equal(ode->joints[2].impacts, exact->joints[2].impacts);
            assert_close(ode->energy.drive_work, exact->energy.drive_work, k == 0 ? 1e-3 : 1e-4);
            trajectory_destroy(ode);
            // as at mid-step throughout
            Scenario other = kept_copy(&scenario);
            other.ode.is_frozen = true;
            ode = complete_run(&other, BACKEND_ODE);
            frozen[k] = fabs(ode->energy.residual);
            trajectory_destroy(ode);
        }
        print_message("# %s, friction %g: work %.4g J, missing %.3g, %.3g\n",
                      i / 2 == 0 ? "line" : "disc", scenario.contact.friction,
                      exact->energy.drive_work, residuals[0], residuals[1]);
        assert_true(exact->joints[2].impacts > 0 && exact->energy.dissipated > 0.01);
        assert_near(ode_order(frozen[0], frozen[1], 4.0), 2.0, 0.3);
        assert_true(residuals[0] < 0.5 * frozen[0] && residuals[1] < 0.5 * frozen[1]);
        trajectory_destroy(exact);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_on_a_floor_keeps_its_restitution),
        cmocka_unit_test(discs_in_a_row_part_as_calculated),
        cmocka_unit_test(a_cradle_follows_the_reference_with_the_second_order),
        cmocka_unit_test(the_drive_pays_for_what_its_disc_strikes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
