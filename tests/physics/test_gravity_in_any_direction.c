// Does gravity act in the direction that it is given?
//
// Nothing in mechanics knows which axis is which: a mechanism that is turned together with its
// gravity moves as before, turned. The run along -y, which other tests hold against their outside
// truths, is the truth of the turned one; the control is turned while its gravity is not.
//
// How close two runs must be is what rounding makes of the mechanism: the turned one, each of whose
// numbers is rounded once more (model/shake.h), runs apart by what impacts make of the last bit.
// Turning rounds every number of every step anew and not only those of the start.
//
// Beside that stand the closed forms of a pendulum for any direction, its period and its energy.
#include "complete_run.h"
#include "four_bars.h"
#include "load_case.h"

#include "base/vec3.h"
#include "model/shake.h"
#include "model/space.h"

static const double TURN = 0.7; // rad: no axis of the world falls on another

// What the run of a turned mechanism may be off, over the largest of a few that are rounded once
// more; where these happen to stay together, what some hundred roundings are.
static const double ROUNDINGS = 100.0;
static const double LEAST = 1e-13;

// And where ODE chooses other local steps: a share of its error, and at most that.
static const double LOCAL_SHARE = 0.25;
static const double LOCAL_MOST = 1e-4;

enum { SHAKEN = 4, SPACE_MOST = 8 };

static Vec2 turn_in_plane(Quat turn, Vec2 vector)
{
    const Vec3 turned = quat_rotate(turn, (Vec3){vector.x, vector.y, 0.0});
    return (Vec2){turned.x, turned.y};
}

static void turn_anchor(int body, Quat turn, Vec2 *anchor)
{
    *anchor = body == LINKAGE_GROUND ? turn_in_plane(turn, *anchor) : *anchor;
}

// A planar mechanism turned about the origin's z axis.
static void turn_plane(Quat turn, Linkage *linkage)
{
    const double angle = 2.0 * atan2(turn.z, turn.w);
    for (size_t i = 0; i < linkage->body_count; i++) {
        Motion *start = &linkage->bodies[i].start;
        start->position = turn_in_plane(turn, start->position);
        start->velocity = turn_in_plane(turn, start->velocity);
        start->angle += angle;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint *joint = &linkage->joints[i];
        turn_anchor(joint->body_a, turn, &joint->anchor_a);
        turn_anchor(joint->body_b, turn, &joint->anchor_b);
        if (joint->body_a == LINKAGE_GROUND) {
            joint->direction += angle;
            joint->held_angle += angle;
        }
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        turn_anchor(linkage->springs[i].body_a, turn, &linkage->springs[i].anchor_a);
        turn_anchor(linkage->springs[i].body_b, turn, &linkage->springs[i].anchor_b);
    }
    linkage->driver.start += angle;
}

// Gives a body in space the moments and products of inertia of a matrix.
static void set_inertia(const Mat3 *matrix, Body *body)
{
    body->inertia = matrix->row[2].z;
    body->space.inertia_x = matrix->row[0].x;
    body->space.inertia_y = matrix->row[1].y;
    body->space.product_xy = -matrix->row[0].y;
    body->space.product_xz = -matrix->row[0].z;
    body->space.product_yz = -matrix->row[1].z;
}

// Puts a joint's point, which both of its anchors share, somewhere else.
static void place_joint(const Linkage *linkage, Vec3 point, Joint *joint)
{
    const Vec2 at = {point.x, point.y};
    const int a = joint->body_a;
    const int b = joint->body_b;
    joint->anchor_a = a == LINKAGE_GROUND ? at : vec2_sub(at, linkage->bodies[a].start.position);
    joint->anchor_b = b == LINKAGE_GROUND ? at : vec2_sub(at, linkage->bodies[b].start.position);
    joint->space.height = point.z;
}

// A mechanism in space turned about the origin. The frames of its bodies stand along the world's
// axes again, so that their inertias and the joints' points in them are others.
static void turn_space(Quat turn, Linkage *linkage)
{
    SpaceMotion motions[SPACE_MOST];
    Vec3 points[SPACE_MOST];
    assert_true(linkage->body_count <= SPACE_MOST && linkage->joint_count <= SPACE_MOST);
    space_start(linkage, motions);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const SpaceEnd end = space_end(linkage, i, 1);
        points[i] = quat_rotate(turn, space_point(motions, end.body, end.anchor));
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        Body *body = &linkage->bodies[i];
        SpaceMotion motion = motions[i];
        const Mat3 inertia = space_world_inertia(body, quat_product(turn, motion.turn));
        motion.position = quat_rotate(turn, motion.position);
        motion.velocity = quat_rotate(turn, motion.velocity);
        motion.omega = quat_rotate(turn, motion.omega);
        set_inertia(&inertia, body);
        space_set_start(&motion, body);
        body->start.position = (Vec2){motion.position.x, motion.position.y};
        body->start.angle = 0.0;
        body->space.height = motion.position.z;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint *joint = &linkage->joints[i];
        place_joint(linkage, points[i], joint);
        joint->space.axis = quat_rotate(turn, joint->space.axis);
    }
    linkage->driver.start = 0.0;
}

// The mechanism and its gravity, as a linkage without the short forms, whose ground lies along x.
static Scenario turn_all(const Scenario *scenario, Quat turn)
{
    Scenario turned = kept_copy(scenario);
    turned.has_fourbar = turned.has_slidercrank = false;
    turned.gravity = quat_rotate(turn, scenario->gravity);
    (scenario->linkage.is_spatial ? turn_space : turn_plane)(turn, &turned.linkage);
    return turned;
}

// Largest differences of two runs, each as a share of the largest there: of the bodies' speeds and
// turning, and of the forces in the joints.
typedef struct Apart {
    double motion;
    double force;
} Apart;

static SpaceMotion motion_of(const Trajectory *run, size_t sample, size_t body)
{
    const Motion *planar = trajectory_motion(run, sample, body);
    return run->space_motions != NULL
               ? run->space_motions[sample * run->body_count + body]
               : (SpaceMotion){.velocity = {planar->velocity.x, planar->velocity.y, 0.0},
                               .omega = {0.0, 0.0, planar->omega}};
}

static Vec3 force_of(const Trajectory *run, size_t sample, size_t joint)
{
    const Vec2 planar = trajectory_state(run, sample, joint)->force_on_b;
    return run->space_states != NULL
               ? run->space_states[sample * run->joint_count + joint].force_on_b
               : (Vec3){planar.x, planar.y, 0.0};
}

// The largest of a vector and of what another, turned back, has beside it.
typedef struct Largest {
    double size;
    double off;
} Largest;

static void take(Quat turn, Vec3 turned, Vec3 truth, Largest *largest)
{
    largest->size = fmax(largest->size, vec3_length(truth));
    largest->off = fmax(largest->off, vec3_length(vec3_sub(quat_rotate_back(turn, turned), truth)));
}

static Apart apart(const Trajectory *turned, const Trajectory *plain, Quat turn)
{
    Largest velocity = {0.0, 0.0};
    Largest omega = velocity;
    Largest force = velocity;
    for (size_t k = 0; k < plain->sample_count; k++) {
        for (size_t i = 0; i < plain->body_count; i++) {
            const SpaceMotion a = motion_of(turned, k, i);
            const SpaceMotion b = motion_of(plain, k, i);
            take(turn, a.velocity, b.velocity, &velocity);
            take(turn, a.omega, b.omega, &omega);
        }
        for (size_t i = 0; i < plain->joint_count; i++) {
            take(turn, force_of(turned, k, i), force_of(plain, k, i), &force);
        }
    }
    return (Apart){fmax(velocity.off / velocity.size, omega.off / omega.size),
                   force.off / force.size};
}

// What rounding makes of a mechanism.
static Apart rounded_apart(const Scenario *scenario, BackendKind backend, const Trajectory *plain)
{
    const Quat none = {.w = 1.0};
    Apart most = {LEAST, LEAST};
    for (unsigned seed = 1; seed <= SHAKEN; seed++) {
        Scenario shaken = kept_copy(scenario);
        shake_inputs(&shaken, seed);
        Trajectory *run = complete_run(&shaken, backend);
        const Apart found = apart(run, plain, none);
        most = (Apart){fmax(most.motion, found.motion), fmax(most.force, found.force)};
        trajectory_destroy(run);
    }
    return (Apart){ROUNDINGS * most.motion, ROUNDINGS * most.force};
}

// How far ODE is from the reference: its error.
static Apart error_of(const Scenario *scenario, const Trajectory *run)
{
    Trajectory *truth = complete_run(scenario, BACKEND_REFERENCE);
    const Quat none = {.w = 1.0};
    const Apart found = apart(run, truth, none);
    trajectory_destroy(truth);
    return found;
}

// What a turned run may be off. Contacts that ODE integrates within its steps take local steps,
// whose length is chosen by errors along x and along y (kernel/): turned by anything but a quarter
// they choose others, which is a share of the error that such a run has anyway.
static Apart allowed(const Scenario *scenario, BackendKind backend, const Scenario *turned,
                     const Trajectory *plain, const Trajectory *with, bool is_quarter)
{
    Apart most = rounded_apart(turned, backend, with);
    if (backend == BACKEND_ODE && scenario_integrates_contacts(scenario) && !is_quarter) {
        const Apart error = error_of(scenario, plain);
        most.motion = fmax(most.motion, fmin(LOCAL_SHARE * error.motion, LOCAL_MOST));
        most.force = fmax(most.force, fmin(LOCAL_SHARE * error.force, 10.0 * LOCAL_MOST));
    }
    return most;
}

// Runs a mechanism plain, turned, and turned without its gravity, which must miss by far more than
// rounding makes.
static void check(const Scenario *scenario, BackendKind backend, Quat turn)
{
    const Scenario turned = turn_all(scenario, turn);
    Scenario control = turned;
    control.gravity = scenario->gravity;
    Trajectory *plain = complete_run(scenario, backend);
    Trajectory *with = complete_run(&turned, backend);
    Trajectory *without = complete_run(&control, backend);
    const bool is_quarter = fabs(turn.w - sqrt(0.5)) < 1e-15;
    const Apart most = allowed(scenario, backend, &turned, plain, with, is_quarter);
    const Apart found = apart(with, plain, turn);
    const Apart missed = apart(without, plain, turn);
    if (!(found.motion <= most.motion && found.force <= most.force)) {
        fail_msg("%s: off by %.3g and %.3g, allowed %.3g and %.3g", plain->label, found.motion,
                 found.force, most.motion, most.force);
    }
    if (!(missed.motion > 100.0 * most.motion && missed.force > 100.0 * most.force)) {
        fail_msg("%s: without its gravity off by %.3g and %.3g, allowed %.3g and %.3g",
                 plain->label, missed.motion, missed.force, most.motion, most.force);
    }
    trajectory_destroy(plain);
    trajectory_destroy(with);
    trajectory_destroy(without);
}

static const BackendKind BOTH[] = {BACKEND_REFERENCE, BACKEND_ODE};

static const Vec3 Z = {0.0, 0.0, 1.0};

static void check_case(const char *path, const char *const *overrides, size_t count, Vec3 axis,
                       double angle)
{
    const Quat turn = quat_of_turn(vec3_scale(angle, axis));
    const Scenario scenario = load(path, overrides, count);
    for (int i = 0; i < 2; i++) {
        check(&scenario, BOTH[i], turn);
    }
}

static void a_four_bar_with_play_turns_with_its_gravity(void **state)
{
    (void)state;
    const char *const overrides[] = {"drive.speed=100 rpm", "run.revolutions=0.25",
                                     "run.samples=2000", "run.step=20 us", "ode.stepping=plain"};
    check_case("cases/paper/impact-k66.yaml", overrides, 4, Z, TURN);
    check_case("cases/paper/impact-k66.yaml", overrides, 4, Z, 0.5 * M_PI);
    // and with contacts as rows of ODE
    const Scenario plain = load("cases/paper/impact-k66.yaml", overrides, 5);
    check(&plain, BACKEND_ODE, quat_of_turn(vec3_scale(TURN, Z)));
}

static void a_slider_crank_with_play_turns_with_its_gravity(void **state)
{
    (void)state;
    const char *const overrides[] = {"drive.speed=100 rpm", "run.revolutions=0.1",
                                     "run.samples=2000", "run.step=20 us"};
    check_case("cases/mechanisms/slider-crank-both.yaml", overrides, 4, Z, TURN);
    check_case("cases/mechanisms/slider-crank-both.yaml", overrides, 4, Z, 0.5 * M_PI);
}

static void stops_and_springs_turn_with_gravity(void **state)
{
    (void)state;
    const char *const pecking[] = {"run.step=20 us", "run.duration=0.1 s"};
    check_case("cases/mechanisms/woodpecker.yaml", pecking, 2, Z, TURN);
    const char *const striking[] = {"run.step=20 us", "run.duration=0.4 s"};
    check_case("cases/mechanisms/newtons-cradle.yaml", striking, 2, Z, TURN);
}

// Enough ideal joints that one solver of the program holds them all instead of rows of ODE; and a
// world of higher order.
static void a_row_of_four_bars_turns_with_its_gravity(void **state)
{
    (void)state;
    static const OdeStepping STEPPINGS[] = {ODE_PLAIN, ODE_STAGGERED, ODE_EXTRAPOLATED};
    const Quat turn = quat_of_turn(vec3_scale(TURN, Z));
    Scenario scenario = kept_default();
    four_bars_fill(&scenario, 12, 0.5);
    scenario.run.samples = 200;
    for (int i = 0; i < 3; i++) {
        scenario.run.step = 1e-3;
        scenario.ode.stepping = STEPPINGS[i];
        check(&scenario, BACKEND_ODE, turn);
    }
    check(&scenario, BACKEND_REFERENCE, turn);
}

// About x no axis stays normal to the plane; about the third all of them point anywhere.
static const Vec3 AXES[] = {{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {0.6, 0.48, 0.64}};

static void mechanisms_in_space_turn_with_their_gravity(void **state)
{
    (void)state;
    const char *const resting[] = {"run.step=20 us", "run.duration=60 ms"};
    const char *const turning[] = {"drive.speed=100 rpm", "run.step=20 us", "run.revolutions=0.03"};
    const char *const falling[] = {"drive.speed=100 rpm", "run.step=5 us", "run.revolutions=0.015"};
    for (int i = 0; i < 3; i++) {
        check_case("cases/space/overhung-pin.yaml", resting, 2, AXES[i], TURN);
        check_case("cases/space/offset-coupler.yaml", falling, 3, AXES[i], TURN);
        check_case("cases/space/bennett.yaml", turning, 3, AXES[i], TURN);
    }
}

// A rod of length 1 m let go at rest at right angles to gravity, on an ideal hinge.
static const double HALF = 0.5;     // m, from the hinge to its middle
static const double PULL = 9.80665; // m/s^2

static Scenario rod(Vec2 gravity, double angle)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    scenario.gravity = (Vec3){gravity.x, gravity.y, 0.0};
    scenario.reference.tolerance = 1e-14;
    linkage->body_count = linkage->joint_count = 1;
    linkage->bodies[0] = (Body){.name = "rod", .mass = 1.0, .inertia = 1.0 / 12.0};
    linkage->bodies[0].start.position = vec2_rotate(angle, (Vec2){HALF, 0.0});
    linkage->bodies[0].start.angle = angle;
    linkage->joints[0] = (Joint){.name = "hinge",
                                 .kind = JOINT_REVOLUTE,
                                 .body_a = LINKAGE_GROUND,
                                 .body_b = 0,
                                 .anchor_b = {-HALF, 0.0}};
    scenario.run.samples = 64;
    return scenario;
}

// Of a swing of 90 deg to either side: T = 4 K(sin 45 deg) / w0, w0^2 = m g s / J = 3 g / 2 L, and
// K = pi / 2 M(1, cos 45 deg) by Gauss's mean (Abramowitz and Stegun 17.6).
static double period(void)
{
    double a = 1.0;
    double b = sqrt(0.5);
    for (int i = 0; i < 8; i++) {
        const double mean = 0.5 * (a + b);
        b = sqrt(a * b);
        a = mean;
    }
    return 4.0 * 0.5 * M_PI / a / sqrt(1.5 * PULL);
}

// How far the rod is from where gravity points, rad, after three quarters of a period.
static double at_the_bottom(const Scenario *scenario, Vec2 gravity, BackendKind backend)
{
    Trajectory *run = complete_run(scenario, backend);
    const Vec2 at = trajectory_motion(run, run->sample_count - 1, 0)->position;
    trajectory_destroy(run);
    return fabs(atan2(vec2_cross(gravity, at), vec2_dot(gravity, at)));
}

static void a_pendulum_swings_with_jacobis_period_in_any_direction(void **state)
{
    (void)state;
    for (int degree = -90; degree < 270; degree += 45) {
        const double angle = degree * M_PI / 180.0;
        const Vec2 gravity = degree == 0 ? (Vec2){PULL, 0.0} // along +x to the last bit
                                         : vec2_rotate(angle, (Vec2){PULL, 0.0});
        Scenario scenario = rod(gravity, angle + 0.5 * M_PI);
        scenario.run.duration = 0.75 * period();
        // the tolerance of 1e-14 a step, over some hundred steps; ODE's order is another test's
        assert_near(at_the_bottom(&scenario, gravity, BACKEND_REFERENCE), 0.0, 1e-11);
        scenario.run.step = 1e-3;
        scenario.ode.stepping = ODE_EXTRAPOLATED;
        assert_near(at_the_bottom(&scenario, gravity, BACKEND_ODE), 0.0, 1e-6);
        // the control: gravity a tenth of a degree aside
        Scenario aside = scenario;
        const Vec2 other = vec2_rotate(0.1 * M_PI / 180.0, gravity);
        aside.gravity = (Vec3){other.x, other.y, 0.0};
        assert_true(at_the_bottom(&aside, gravity, BACKEND_REFERENCE) > 1e-4);
        assert_true(at_the_bottom(&aside, gravity, BACKEND_ODE) > 1e-4);
    }
}

// What a fall through the potential -m g . x gives: J w^2 / 2; and the run's own balance.
static void energy_is_that_of_the_fall_along_gravity(void **state)
{
    (void)state;
    const Vec2 gravity = {3.0, -5.0};
    Scenario scenario = rod(gravity, 0.3);
    scenario.run.duration = 2.0;
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    double worst = 0.0;
    double missed = 0.0; // by a potential along -y
    for (size_t k = 0; k < run->sample_count; k++) {
        const Motion *motion = trajectory_motion(run, k, 0);
        const Vec2 fallen = vec2_sub(motion->position, trajectory_motion(run, 0, 0)->position);
        const double gained = 0.5 / 3.0 * motion->omega * motion->omega;
        worst = fmax(worst, fabs(gained - vec2_dot(gravity, fallen)));
        missed = fmax(missed, fabs(gained - gravity.y * fallen.y));
    }
    // some 5 J go to and fro
    assert_true(worst < 1e-12 && missed > 1.0);
    assert_near(run->energy.residual, 0.0, 1e-12);
    trajectory_destroy(run);
}

// The same in a mechanism with a drive and play, where the contacts dissipate: what is left over is
// what the reference's integration leaves.
static void energy_is_balanced_with_a_drive_and_play(void **state)
{
    (void)state;
    const char *const overrides[] = {"drive.speed=100 rpm", "run.revolutions=0.25",
                                     "gravity=[300 m/s^2, -200 m/s^2]"};
    const Scenario scenario = load("cases/paper/impact-k66.yaml", overrides, 3);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const double scale = fabs(run->energy.drive_work) + run->energy.dissipated;
    assert_true(fabs(run->energy.residual) < 1e-9 * scale);
    // the control: what the part along x does is no small thing
    const Linkage *linkage = &scenario.linkage;
    double along_x = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        along_x += 300.0 * linkage->bodies[i].mass *
                   (trajectory_motion(run, run->sample_count - 1, i)->position.x -
                    trajectory_motion(run, 0, i)->position.x);
    }
    assert_true(fabs(along_x) > 0.1 * scale);
    trajectory_destroy(run);
}

// The forces of the closed form and of the reference, which find them in two ways.
static void ideal_joints_carry_gravity_in_any_direction(void **state)
{
    (void)state;
    const char *const overrides[] = {"drive.speed=100 rpm", "gravity=[3 m/s^2, -5 m/s^2]",
                                     "run.samples=100", "run.revolutions=1"};
    const Scenario scenario = load("cases/paper/ideal-nominal.yaml", overrides, 4);
    Scenario control = scenario;
    control.gravity.x = 0.0;
    const Quat none = {.w = 1.0};
    Trajectory *closed = complete_run(&scenario, BACKEND_ANALYTIC);
    Trajectory *integrated = complete_run(&scenario, BACKEND_REFERENCE);
    Trajectory *other = complete_run(&control, BACKEND_REFERENCE);
    // the tolerance of the integration, by what the closed loop makes of it
    assert_true(apart(integrated, closed, none).force < 1e-9);
    assert_true(apart(other, closed, none).force > 1e-2);
    trajectory_destroy(closed);
    trajectory_destroy(integrated);
    trajectory_destroy(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_four_bar_with_play_turns_with_its_gravity),
        cmocka_unit_test(a_slider_crank_with_play_turns_with_its_gravity),
        cmocka_unit_test(stops_and_springs_turn_with_gravity),
        cmocka_unit_test(a_row_of_four_bars_turns_with_its_gravity),
        cmocka_unit_test(mechanisms_in_space_turn_with_their_gravity),
        cmocka_unit_test(a_pendulum_swings_with_jacobis_period_in_any_direction),
        cmocka_unit_test(energy_is_that_of_the_fall_along_gravity),
        cmocka_unit_test(energy_is_balanced_with_a_drive_and_play),
        cmocka_unit_test(ideal_joints_carry_gravity_in_any_direction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
