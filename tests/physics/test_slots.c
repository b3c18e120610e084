// Does a pin in a slot with ends move as what the parts of the slot are?
//
// Between straight walls without friction and damping, on springs F = k d, a pin of mass m goes to
// and fro with the speed v: across the play 2 c in 2 c / v, and through each wall in half a period
// of its spring, pi sqrt(m / k); both ways together take twice that. A slot whose ends are not
// reached is two lines, one that has hardly any length is a hole, and so is the arc at an end.
#include "complete_run.h"
#include "kept.h"

enum { SAMPLES = 400 };

static const double PIN = 4e-3;       // m
static const double CLEARANCE = 2e-4; // m, to either side
static const double MASS = 0.3;       // kg
static const double STIFFNESS = 4e6;  // N/m

typedef struct Start {
    Vec2 position; // m
    Vec2 velocity; // m/s
    double omega;  // rad/s
} Start;

// A puck whose pin is in something of the ground.
static Scenario puck_scenario(const Start *start, double duration_s)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    scenario.gravity = scenario_downward(0.0);
    scenario.contact.damping = DAMPING_HUNT_CROSSLEY;
    scenario.contact.stiffness = STIFFNESS;
    scenario.contact.exponent = 1.0;
    scenario.contact.restitution = 0.6;
    scenario.run.duration = duration_s;
    scenario.run.samples = SAMPLES;
    scenario.run.step = 2e-5;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    linkage->driver.is_present = false;
    linkage->body_count = 1;
    linkage->bodies[0] = (Body){.name = "puck", .mass = MASS, .inertia = 3e-5};
    linkage->bodies[0].start =
        (Motion){.position = start->position, .velocity = start->velocity, .omega = start->omega};
    linkage->joint_count = 0;
    return scenario;
}

// A slot about a point of the ground, and the direction across it.
static void add_slot(Scenario *scenario, Vec2 middle, double direction, double length)
{
    Linkage *linkage = &scenario->linkage;
    linkage->joints[linkage->joint_count++] = (Joint){
        .name = "slot",
        .kind = JOINT_STOP,
        .body_a = LINKAGE_GROUND,
        .body_b = 0,
        .anchor_a = middle,
        .direction = direction,
        .stop = {.slot = length, .radius_a = PIN + CLEARANCE, .radius_b = PIN},
    };
}

static void add_hole(Scenario *scenario, Vec2 centre)
{
    Linkage *linkage = &scenario->linkage;
    linkage->joints[linkage->joint_count++] = (Joint){
        .name = "slot",
        .kind = JOINT_CLEARANCE,
        .body_a = LINKAGE_GROUND,
        .body_b = 0,
        .anchor_a = centre,
        .clearance = {.hole_radius = PIN + CLEARANCE,
                      .pin_radius = PIN,
                      .start = vec2_sub(linkage->bodies[0].start.position, centre)},
    };
}

// The straight walls alone, endless.
static void add_lines(Scenario *scenario, double direction)
{
    Linkage *linkage = &scenario->linkage;
    for (int i = 0; i < 2; i++) {
        const double side = direction + (i == 0 ? 0.0 : M_PI);
        linkage->joints[linkage->joint_count++] = (Joint){
            .name = {(char)('a' + i), '\0'},
            .kind = JOINT_STOP,
            .body_a = LINKAGE_GROUND,
            .body_b = 0,
            .anchor_a = vec2_rotate(side, (Vec2){-PIN - CLEARANCE, 0.0}),
            .direction = side,
            .stop = {.radius_b = PIN},
        };
    }
}

// How far two runs are apart: the puck's place, m, and the force of all joints, N.
typedef struct Apart {
    double place;
    double force;
    double largest; // N, of the first
} Apart;

static double force_at(const Trajectory *run, size_t sample)
{
    Vec2 sum = {0.0, 0.0};
    for (size_t i = 0; i < run->joint_count; i++) {
        sum = vec2_add(sum, trajectory_state(run, sample, i)->force_on_b);
    }
    return vec2_length(sum);
}

static Apart compare(const Scenario *one, const Scenario *other, BackendKind backend)
{
    Trajectory *runs[2] = {complete_run(one, backend), complete_run(other, backend)};
    Apart apart = {.place = 0.0};
    for (size_t k = 0; k < runs[0]->sample_count; k++) {
        const Vec2 by = vec2_sub(trajectory_motion(runs[0], k, 0)->position,
                                 trajectory_motion(runs[1], k, 0)->position);
        const double forces[2] = {force_at(runs[0], k), force_at(runs[1], k)};
        apart.place = fmax(apart.place, vec2_length(by));
        apart.force = fmax(apart.force, fabs(forces[0] - forces[1]));
        apart.largest = fmax(apart.largest, forces[0]);
    }
    assert_int_equal(run_impacts(runs[0]), run_impacts(runs[1]));
    print_message("# %s: %.3g m and %.3g N of %.4g N apart, %zu impacts\n",
                  backend == BACKEND_ODE ? "ode" : "reference", apart.place, apart.force,
                  apart.largest, run_impacts(runs[0]));
    assert_true(run_impacts(runs[0]) > 0);
    trajectory_destroy(runs[0]);
    trajectory_destroy(runs[1]);
    return apart;
}

static void walls_send_an_undamped_pin_to_and_fro_in_the_time_of_the_closed_form(void **state)
{
    (void)state;
    const double speed = 0.4;
    const double across = 0.7; // rad
    const double along = 0.05; // m/s, which nothing changes
    const Start start = {.velocity = vec2_rotate(across, (Vec2){speed, along})};
    const double swing_s = 2.0 * (2.0 * CLEARANCE / speed + M_PI * sqrt(MASS / STIFFNESS));
    for (int i = 0; i < 2; i++) {
        Scenario scenario = puck_scenario(&start, 10.0 * swing_s);
        scenario.contact.damping = DAMPING_NONE;
        add_slot(&scenario, (Vec2){0.0, 0.0}, across, 0.02);
        Trajectory *run = complete_run(&scenario, i == 0 ? BACKEND_REFERENCE : BACKEND_ODE);
        const Vec2 end = trajectory_motion(run, run->sample_count - 1, 0)->position;
        const Vec2 in_slot = vec2_rotate(-across, end);
        print_message("# %s: %.3g m across, %.3g m along off\n", i == 0 ? "reference" : "ode",
                      in_slot.x, in_slot.y - 10.0 * swing_s * along);
        assert_true(fabs(in_slot.x) < (i == 0 ? 1e-12 : 1e-8));
        assert_near(in_slot.y, 10.0 * swing_s * along, 1e-12);
        assert_int_equal(run->joints[0].impacts, 20);
        // each turns back the whole momentum
        assert_close(run->joints[0].impulse, 20.0 * 2.0 * MASS * speed, 1e-6);
        // control: a play that is a thousandth larger is as many swings later elsewhere
        scenario.linkage.joints[0].stop.radius_a += 1e-3 * CLEARANCE;
        Trajectory *other = complete_run(&scenario, BACKEND_REFERENCE);
        const Vec2 there = trajectory_motion(other, other->sample_count - 1, 0)->position;
        assert_true(fabs(vec2_rotate(-across, there).x) > 1e-6);
        trajectory_destroy(run);
        trajectory_destroy(other);
    }
}

static void a_slot_whose_ends_are_far_is_two_lines(void **state)
{
    (void)state;
    const double across = -0.4;
    const Start start = {.position = vec2_rotate(across, (Vec2){5e-5, -2e-3}),
                         .velocity = vec2_rotate(across, (Vec2){0.3, 0.1}),
                         .omega = 20.0};
    for (int i = 0; i < 2; i++) {
        const BackendKind backend = i == 0 ? BACKEND_REFERENCE : BACKEND_ODE;
        Scenario slot = puck_scenario(&start, 0.02);
        slot.contact.friction = 0.15;
        Scenario lines = puck_scenario(&start, 0.02);
        lines.contact.friction = 0.15;
        add_slot(&slot, (Vec2){0.0, 0.0}, across, 0.2);
        add_lines(&lines, across);
        const Apart apart = compare(&slot, &lines, backend);
        // friction's arm is that of the wall in a slot, of the pin's own surface at a line
        assert_true(apart.place < 1e-5 && apart.force < 1e-3 * apart.largest);
        slot.contact.friction = lines.contact.friction = 0.0;
        const Apart smooth = compare(&slot, &lines, backend);
        assert_true(smooth.place < (i == 0 ? 1e-12 : 1e-10));
    }
}

static void a_slot_of_no_length_is_a_hole(void **state)
{
    (void)state;
    const Start start = {.position = {5e-5, -4e-5}, .velocity = {0.3, 0.14}, .omega = 20.0};
    for (int i = 0; i < 2; i++) {
        const BackendKind backend = i == 0 ? BACKEND_REFERENCE : BACKEND_ODE;
        Scenario slot = puck_scenario(&start, 0.01);
        slot.contact.friction = 0.15;
        Scenario hole = puck_scenario(&start, 0.01);
        hole.contact.friction = 0.15;
        add_slot(&slot, (Vec2){0.0, 0.0}, 0.9, 1e-15);
        add_hole(&hole, (Vec2){0.0, 0.0});
        const Apart apart = compare(&slot, &hole, backend);
        assert_true(apart.place < (i == 0 ? 1e-11 : 1e-8));
        assert_true(apart.force < (i == 0 ? 1e-6 : 1e-3) * apart.largest);
    }
}

// Under gravity the pin falls into the arc at the lower end, rolls to and fro there as a pendulum,
// and stays below the arc's centre.
static void the_arc_at_an_end_is_a_hole(void **state)
{
    (void)state;
    const double length = 0.03;
    const Vec2 centre = {0.0, -0.5 * length};
    const Start start = {.position = vec2_add(centre, (Vec2){1.7e-4, -0.9e-4})};
    for (int i = 0; i < 2; i++) {
        const BackendKind backend = i == 0 ? BACKEND_REFERENCE : BACKEND_ODE;
        for (int k = 0; k < 2; k++) {
            Scenario slot = puck_scenario(&start, 0.05);
            slot.gravity = scenario_downward(9.81);
            slot.contact.friction = k == 0 ? 0.0 : 0.1;
            Scenario hole = puck_scenario(&start, 0.05);
            hole.gravity = slot.gravity;
            hole.contact.friction = slot.contact.friction;
            add_slot(&slot, (Vec2){0.0, 0.0}, 0.0, length);
            add_hole(&hole, centre);
            const Apart apart = compare(&slot, &hole, backend);
            assert_true(apart.place < (i == 0 ? 1e-11 : 1e-8));
            // control: half a play beside it nothing is the same
            slot.linkage.joints[0].anchor_a.x += 0.5 * CLEARANCE;
            Trajectory *runs[2] = {complete_run(&slot, backend), complete_run(&hole, backend)};
            const size_t last = runs[0]->sample_count - 1;
            assert_true(fabs(trajectory_motion(runs[0], last, 0)->position.x -
                             trajectory_motion(runs[1], last, 0)->position.x) > 1e-6);
            trajectory_destroy(runs[0]);
            trajectory_destroy(runs[1]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls_send_an_undamped_pin_to_and_fro_in_the_time_of_the_closed_form),
        cmocka_unit_test(a_slot_whose_ends_are_far_is_two_lines),
        cmocka_unit_test(a_slot_of_no_length_is_a_hole),
        cmocka_unit_test(the_arc_at_an_end_is_a_hole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
