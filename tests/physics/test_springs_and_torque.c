// Do springs, dampers and torques move a linkage as closed forms and published solutions say, in
// the reference and in every way of stepping ODE?
#include "ode_error.h"
#include "sprung_slider.h"

#include "run/drive_torque.h"
#include "run/ideal.h"

// A body of inertia 0.25 + 0.5^2 = 0.5 kg m^2 about its pivot.
static Scenario arm(void)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = linkage->joint_count = 1;
    linkage->bodies[0] = (Body){.name = "arm", .mass = 1.0, .inertia = 0.25};
    linkage->bodies[0].start.position = (Vec2){0.5, 0.0};
    linkage->joints[0] =
        (Joint){.name = "pivot", .body_a = LINKAGE_GROUND, .body_b = 0, .anchor_b = {-0.5, 0.0}};
    scenario.gravity = scenario_downward(0.0);
    scenario.run.samples = 200;
    scenario.run.duration = 2.0;
    scenario.run.step = 1e-3;
    return scenario;
}

static const Motion *at_end(const Trajectory *trajectory, size_t body)
{
    return trajectory_motion(trajectory, trajectory->sample_count - 1, body);
}

// The angle at the end, of a pendulum from the horizontal at rest, from the downward vertical:
// (sin, cos) by the elliptic integral to 20 digits; IFToMM benchmark library, problem A01.
static const double SWUNG_SIN = 0.27508746257616;
static const double SWUNG_COS = 0.96141920509912504;

static Scenario pendulum(double inertia)
{
    Scenario scenario = arm();
    scenario.gravity = scenario_downward(9.81);
    scenario.linkage.bodies[0].inertia = inertia;
    // the arm's angle is from the horizontal: 90 deg less than from the vertical
    scenario.run.duration = 10.0;
    return scenario;
}

static double swung_error(Scenario scenario, BackendKind backend, double step_s)
{
    scenario.run.step = step_s;
    scenario.reference.tolerance = 1e-14;
    Trajectory *run = complete_run(&scenario, backend);
    const double angle = at_end(run, 0)->angle + 0.5 * M_PI;
    trajectory_destroy(run);
    return hypot(sin(angle) - SWUNG_SIN, cos(angle) - SWUNG_COS);
}

static void a_pendulum_follows_the_elliptic_integral(void **state)
{
    (void)state;
    Scenario scenario = pendulum(0.25);
    // rounding of the published digits and of 10 s of integration
    assert_near(swung_error(scenario, BACKEND_REFERENCE, 0.0), 0.0, 1e-12);
    assert_true(swung_error(pendulum(0.2501), BACKEND_REFERENCE, 0.0) > 1e-4);
    scenario.ode.stepping = ODE_STAGGERED;
    const double coarse = swung_error(scenario, BACKEND_ODE, 1e-3);
    const double fine = swung_error(scenario, BACKEND_ODE, 5e-4);
    assert_near(ode_order(coarse, fine, 2.0), 2.0, 0.1);
    scenario.ode.stepping = ODE_EXTRAPOLATED;
    const double high_coarse = swung_error(scenario, BACKEND_ODE, 2e-3);
    const double high_fine = swung_error(scenario, BACKEND_ODE, 1e-3);
    assert_true(ode_order(high_coarse, high_fine, 2.0) > 4.0);
    assert_true(high_fine < 1e-6);
}

// k and c on I: theta = e^(-a t) (cos w t + (a / w) sin w t), a = c / 2 I, w^2 = k / I - a^2
static const double SPRING = 40.0; // N m/rad
static const double DAMPER = 0.8;  // N m s/rad

static Scenario sprung(double damping)
{
    Scenario scenario = arm();
    scenario.linkage.torsion_count = 1;
    scenario.linkage.torsions[0] =
        (TorsionSpring){.joint = 0, .stiffness = SPRING, .angle = -1.0, .damping = damping};
    return scenario;
}

static double sprung_error(Scenario scenario, BackendKind backend, double step_s)
{
    const double inertia = 0.5;
    const double a = 0.5 * DAMPER / inertia;
    const double w = sqrt(SPRING / inertia - a * a);
    scenario.run.step = step_s;
    Trajectory *run = complete_run(&scenario, backend);
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const double t = run->times[k];
        const double truth = exp(-a * t) * (cos(w * t) + a / w * sin(w * t)) - 1.0;
        largest = fmax(largest, fabs(trajectory_motion(run, k, 0)->angle - truth));
    }
    trajectory_destroy(run);
    return largest;
}

static void a_damped_oscillator_decays_as_its_closed_form(void **state)
{
    (void)state;
    Scenario scenario = sprung(DAMPER);
    assert_near(sprung_error(scenario, BACKEND_REFERENCE, 0.0), 0.0, 1e-11);
    assert_true(sprung_error(sprung(0.99 * DAMPER), BACKEND_REFERENCE, 0.0) > 1e-4);
    const struct {
        OdeStepping stepping;
        double step_s;
        double order;
        double within;
    } rows[] = {
        {ODE_PLAIN, 1e-3, 1.0, 0.1},
        {ODE_STAGGERED, 1e-3, 2.0, 0.1},
        {ODE_EXTRAPOLATED, 4e-3, 5.5, 0.7}, // 5, and 6 while the next term is the larger
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        scenario.ode.stepping = rows[i].stepping;
        const double coarse = sprung_error(scenario, BACKEND_ODE, rows[i].step_s);
        const double fine = sprung_error(scenario, BACKEND_ODE, 0.5 * rows[i].step_s);
        assert_near(ode_order(coarse, fine, 2.0), rows[i].order, rows[i].within);
    }
}

// A rotor of I = .5 kg m^2 that starts at an angle with 5 rad/s: a spring that is relaxed at 0, or
// a load over the position that pulls as the spring does, or a stop a tenth of a rad further on.
typedef enum Counted { COUNTED_BY_SPRING, COUNTED_BY_LOAD, COUNTED_BY_STOP, COUNTED_COUNT } Counted;

static const double SPIN = 5.0; // rad/s

static Scenario counted(Counted by, double start)
{
    Scenario scenario = sprung(0.0);
    Linkage *linkage = &scenario.linkage;
    Body *rotor = &linkage->bodies[0];
    rotor->inertia = 0.5;
    rotor->start = (Motion){.angle = start, .omega = SPIN};
    linkage->joints[0].anchor_b = (Vec2){0.0, 0.0};
    linkage->torsion_count = by == COUNTED_BY_SPRING ? 1 : 0;
    linkage->torsions[0].angle = 0.0;
    if (by == COUNTED_BY_LOAD) {
        linkage->load_count = 1;
        Load *load = &linkage->loads[0];
        *load = (Load){.kind = LOAD_ALONG, .over = LOAD_OVER_POSITION};
        load->table =
            (LoadTable){.count = 2, .at = {-30.0, 30.0}, .values = {30.0 * SPRING, -30.0 * SPRING}};
        load_table_settle(&load->table);
    }
    if (by == COUNTED_BY_STOP) {
        linkage->joints[0].limits =
            (Limits){.kind = LIMIT_STOPS, .low = -INFINITY, .high = start + 0.1};
        linkage->joints[0].contact = (JointContact){.stiffness = SPRING, .exponent = 1.0};
        scenario.contact.damping = DAMPING_NONE;
    }
    scenario.run.duration = 0.1;
    scenario.run.step = 1e-4;
    return scenario;
}

// rad/s: cos and sin of w t, w^2 = k / I, which at the stop begin after .1 rad
static double counted_omega(Counted by, double start, double time_s)
{
    const double w = sqrt(SPRING / 0.5);
    const double since_s = time_s - 0.1 / SPIN;
    return by != COUNTED_BY_STOP ? SPIN * cos(w * time_s) - start * w * sin(w * time_s)
                                 : SPIN * cos(w * fmax(0.0, since_s));
}

// The error of omega over what the spring may reach; that of the energy goes by the same.
static double counted_error(const Scenario *scenario, BackendKind backend, Counted by, double start)
{
    Trajectory *run = complete_run(scenario, backend);
    const double w = sqrt(SPRING / 0.5);
    const double scale = hypot(SPIN, by == COUNTED_BY_STOP ? 0.0 : start * w);
    double largest = fabs(run->energy.residual) / (0.25 * scale * scale);
    for (size_t k = 0; k < run->sample_count; k++) {
        const double truth = counted_omega(by, start, run->times[k]);
        const Motion *motion = trajectory_motion(run, k, 0);
        largest = fmax(largest, fabs(motion->omega - truth) / scale);
    }
    trajectory_destroy(run);
    return largest;
}

// The spring of a start in the turn before or after holds k (2 pi)^2 / 2 more or less.
static void whole_turns_of_the_start_count(void **state)
{
    (void)state;
    const int degrees[] = {-720, -550, -360, -190, -170, 0, 170, 190, 360, 550, 720};
    for (Counted by = 0; by < COUNTED_COUNT; by++) {
        for (size_t i = 0; i < sizeof degrees / sizeof *degrees; i++) {
            const double start = degrees[i] * M_PI / 180.0;
            Scenario scenario = counted(by, start);
            assert_near(counted_error(&scenario, BACKEND_REFERENCE, by, start), 0.0, 1e-9);
            for (OdeStepping stepping = 0; stepping < ODE_STEPPING_COUNT; stepping++) {
                if (by == COUNTED_BY_STOP && stepping == ODE_EXTRAPOLATED) {
                    continue;
                }
                scenario.ode.stepping = stepping;
                scenario.ode.map = stepping == ODE_PLAIN ? ODE_MAP_TEXTBOOK : ODE_MAP_IMPULSE;
                const double error = counted_error(&scenario, BACKEND_ODE, by, start);
                // of the first order at 100 us w h / 2 = 4.5e-4
                assert_near(error, 0.0, stepping == ODE_PLAIN ? 3e-3 : 1e-4);
            }
        }
        // control: a whole turn further on it is not the same
        const Scenario scenario = counted(by, 2.0 * M_PI);
        assert_true(by == COUNTED_BY_STOP ||
                    counted_error(&scenario, BACKEND_REFERENCE, by, 0.0) > 1.0);
    }
}

// A damper a thousand times too strong for an explicit step lets the arm creep: the spring pulls it
// home at k / c.
static void a_strong_damper_is_stable_at_any_step(void **state)
{
    (void)state;
    const double damping = 2e4; // N m s/rad, c h / I = 400 at 10 ms
    Scenario scenario = sprung(damping);
    scenario.linkage.torsions[0].stiffness = 2e4;
    for (OdeStepping stepping = ODE_PLAIN; stepping <= ODE_STAGGERED; stepping++) {
        scenario.ode.stepping = stepping;
        scenario.run.step = 1e-2;
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        const double truth = exp(-2.0) - 1.0;
        assert_near(at_end(run, 0)->angle, truth, 1e-2);
        trajectory_destroy(run);
    }
}

// I theta'' = M(t), a rise, a hold and a fall: the angle is its double integral.
static Scenario turned_by_a_table(void)
{
    Scenario scenario = arm();
    scenario.linkage.torque = (Torque){
        .joint = 0,
        .table = {.count = 4, .times = {0.1, 0.4, 0.9, 1.3}, .values = {0.0, 3.0, 3.0, -1.0}}};
    return scenario;
}

static double table_angle(double t)
{
    // kinks of M: at each the slope changes by so much, which adds slope (t - t_k)^3 / 6
    const double at[] = {0.1, 0.4, 0.9, 1.3};
    const double slopes[] = {10.0, -10.0, -10.0, 10.0};
    double sum = 0.0;
    for (size_t i = 0; i < 4; i++) {
        sum += t > at[i] ? slopes[i] * pow(t - at[i], 3.0) / 6.0 : 0.0;
    }
    return sum / 0.5;
}

static void a_torque_over_time_turns_as_its_integral(void **state)
{
    (void)state;
    Scenario scenario = turned_by_a_table();
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    for (size_t k = 0; k < run->sample_count; k++) {
        assert_near(trajectory_motion(run, k, 0)->angle, table_angle(run->times[k]), 1e-12);
    }
    // a table of cubes is exact from kink to kink: a step that crossed one would have to be short
    assert_true(run->steps < 60);
    assert_near(run->energy.residual, 0.0, 1e-11);
    trajectory_destroy(run);
    // ODE crosses the bends in its stride
    scenario.ode.stepping = ODE_STAGGERED;
    double errors[2];
    for (int i = 0; i < 2; i++) {
        scenario.run.step = i == 0 ? 4e-3 : 2e-3;
        run = complete_run(&scenario, BACKEND_ODE);
        errors[i] = fabs(at_end(run, 0)->angle - table_angle(2.0));
        trajectory_destroy(run);
    }
    assert_near(ode_order(errors[0], errors[1], 2.0), 2.0, 0.1);
    assert_true(errors[1] < 2e-4);
    scenario.linkage.torque.table.values[3] = 3.0;
    run = complete_run(&scenario, BACKEND_ODE);
    assert_true(fabs(at_end(run, 0)->angle - table_angle(2.0)) > 0.1);
    trajectory_destroy(run);
}

// A motor's rotor takes a load along by a coupling with backlash: a constant torque does the torque
// times the angle, however long the steps in which the coupling's impacts are.
static void a_torque_with_impacts_inside_the_step_does_what_its_angle_says(void **state)
{
    (void)state;
    const double torque = 0.7; // N m
    Scenario scenario = arm();
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = linkage->joint_count = 2;
    linkage->bodies[0] = (Body){.name = "rotor", .mass = 1.0, .inertia = 5e-4};
    linkage->bodies[1] = (Body){.name = "load", .mass = 2.0, .inertia = 3e-3};
    linkage->joints[0] = (Joint){.name = "bearing", .body_a = LINKAGE_GROUND, .body_b = 0};
    linkage->joints[1] = (Joint){
        .name = "coupling",
        .body_a = 0,
        .body_b = 1,
        .limits = {.kind = LIMIT_BACKLASH, .backlash = 2.0 * M_PI / 180.0},
        .contact = {.stiffness = 500.0, .exponent = 1.0, .viscous = 0.2},
    };
    linkage->torque =
        (Torque){.joint = 0, .table = {.count = 1, .times = {0.0}, .values = {torque}}};
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.run.duration = 0.3;
    scenario.run.samples = 20; // a step each
    scenario.run.step = 0.015;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const double angle = at_end(run, 0)->angle;
    double by_speeds = 0.0;
    for (size_t i = 1; i < run->sample_count; i++) {
        by_speeds +=
            0.5 * (run->times[i] - run->times[i - 1]) *
            (trajectory_motion(run, i - 1, 0)->omega + trajectory_motion(run, i, 0)->omega);
    }
    assert_true(run->joints[1].impacts > 0);
    assert_close(run->energy.drive_work, torque * angle, 1e-12);
    // control: the means of the speeds at the ends of steps
    assert_true(fabs(by_speeds - angle) > 1e-3 * angle);
    trajectory_destroy(run);
}

// The same table as a force on a mass of 0.5 kg, along a line.
static void a_force_over_time_pushes_a_slider_as_its_integral(void **state)
{
    (void)state;
    Scenario scenario = turned_by_a_table();
    Linkage *linkage = &scenario.linkage;
    const Vec2 along = {cos(0.6), sin(0.6)};
    linkage->joints[0].kind = JOINT_PRISMATIC;
    linkage->joints[0].direction = 0.6;
    linkage->bodies[0].mass = 0.5;
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    for (size_t k = 0; k < run->sample_count; k++) {
        const Vec2 moved =
            vec2_sub(trajectory_motion(run, k, 0)->position, linkage->bodies[0].start.position);
        assert_near(vec2_dot(along, moved), table_angle(run->times[k]), 1e-12);
        assert_near(vec2_cross(along, moved), 0.0, 1e-14);
    }
    assert_near(run->energy.residual, 0.0, 1e-11);
    trajectory_destroy(run);
    scenario.ode.stepping = ODE_STAGGERED;
    run = complete_run(&scenario, BACKEND_ODE);
    const Vec2 moved = vec2_sub(at_end(run, 0)->position, linkage->bodies[0].start.position);
    assert_near(vec2_dot(along, moved), table_angle(2.0), 1e-4);
    assert_near(run->energy.residual, 0.0, 1e-9);
    trajectory_destroy(run);
}

// A lever that spins about the origin pushes a block out along itself: what is between the two
// changes no angular momentum, and all of the work is in the speeds.
static Scenario spinning_lever(void)
{
    Scenario scenario = arm();
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = linkage->joint_count = 2;
    linkage->bodies[0].start =
        (Motion){.position = {0.5, 0.0}, .velocity = {0.0, 1.0}, .omega = 2.0};
    linkage->bodies[1] = (Body){.name = "block", .mass = 0.3, .inertia = 0.01};
    linkage->bodies[1].start =
        (Motion){.position = {0.2, 0.0}, .velocity = {0.0, 0.4}, .omega = 2.0};
    linkage->joints[1] = (Joint){.name = "line", .kind = JOINT_PRISMATIC, .body_a = 0, .body_b = 1};
    linkage->torque = (Torque){.joint = 1, .table = {.count = 1, .values = {0.7}}};
    scenario.run.duration = 1.0;
    return scenario;
}

static double momentum_about_origin(const Linkage *linkage, const Trajectory *run)
{
    double sum = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Motion *motion = at_end(run, i);
        sum += linkage->bodies[i].mass * vec2_cross(motion->position, motion->velocity) +
               linkage->bodies[i].inertia * motion->omega;
    }
    return sum;
}

static void a_force_between_lever_and_block_keeps_their_angular_momentum(void **state)
{
    (void)state;
    Scenario scenario = spinning_lever();
    const Linkage *linkage = &scenario.linkage;
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    const double out = vec2_length(at_end(truth, 1)->position);
    // 0.5 kg m^2 of the lever, 0.01 + 0.3 * 0.2^2 of the block, at 2 rad/s
    assert_near(momentum_about_origin(linkage, truth), 2.0 * (0.5 + 0.01 + 0.3 * 0.04), 1e-12);
    assert_near(truth->energy.drive_work, 0.7 * (out - 0.2), 1e-12);
    assert_near(truth->energy.residual, 0.0, 1e-12);
    double errors[2];
    scenario.ode.stepping = ODE_STAGGERED;
    for (int i = 0; i < 2; i++) {
        scenario.run.step = i == 0 ? 4e-3 : 2e-3;
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        errors[i] = fabs(vec2_length(at_end(run, 1)->position) - out);
        trajectory_destroy(run);
    }
    assert_near(ode_order(errors[0], errors[1], 2.0), 2.0, 0.1);
    assert_true(errors[1] < 1e-4);
    // without the force it goes elsewhere
    scenario.linkage.torque.table.values[0] = 0.0;
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(fabs(vec2_length(at_end(run, 1)->position) - out) > 0.1);
    trajectory_destroy(run);
    trajectory_destroy(truth);
}

// What forces with play are compared with, "x ideal": those of the reference with ideal joints, at
// the same angles. The control leaves the spring out.
static void ideal_joints_carry_springs_and_dampers(void **state)
{
    (void)state;
    Scenario scenario = sprung_slider(NULL, 0);
    scenario.linkage.joints[SPRUNG_SLIDER_PLAY].kind = JOINT_REVOLUTE;
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    double torque = 0.0;
    double forces[4] = {0.0};
    for (size_t k = 0; k < run->sample_count; k++) {
        torque = fmax(torque, fabs(drive_torque_at(&scenario, run, 0, k)));
        for (size_t i = 0; i < run->joint_count; i++) {
            forces[i] = fmax(forces[i], trajectory_state(run, k, i)->force);
        }
    }
    IdealSizes sizes = ideal_sizes(&scenario);
    assert_true(sizes.is_known);
    assert_near(sizes.torque_max[0], torque, 1e-9 * torque);
    for (size_t i = 0; i < run->joint_count; i++) {
        assert_near(sizes.force_max[i], forces[i], 1e-9 * forces[i]);
    }
    ideal_sizes_free(&sizes);
    scenario.linkage.spring_count = 0;
    sizes = ideal_sizes(&scenario);
    assert_true(fabs(sizes.torque_max[0] - torque) > 0.1 * torque);
    ideal_sizes_free(&sizes);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pendulum_follows_the_elliptic_integral),
        cmocka_unit_test(a_damped_oscillator_decays_as_its_closed_form),
        cmocka_unit_test(whole_turns_of_the_start_count),
        cmocka_unit_test(a_strong_damper_is_stable_at_any_step),
        cmocka_unit_test(a_torque_over_time_turns_as_its_integral),
        cmocka_unit_test(a_torque_with_impacts_inside_the_step_does_what_its_angle_says),
        cmocka_unit_test(a_force_over_time_pushes_a_slider_as_its_integral),
        cmocka_unit_test(ideal_joints_carry_springs_and_dampers),
        cmocka_unit_test(a_force_between_lever_and_block_keeps_their_angular_momentum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
