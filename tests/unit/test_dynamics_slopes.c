// Are the derivatives that the implicit integrator works with those of the accelerations, and do
// hinges and pins have the same rates by the short way and by the long one?
#include "close.h"
#include "kept.h"
#include "mechanism.h"
#include "slider.h"

#include "base/lcg.h"
#include "reference/plane/dynamics.h"

enum { COORDINATES = 16, SIZE = 2 * COORDINATES + SYSTEM_IMPULSES + 8 };

static const double DEPTH = 1e-6; // m
static const double PLACE = 1e-5; // m or rad, that coordinates are away from the start
static const double RATE = 1e-4;  // m/s or rad/s

// A mechanism with play and friction, its drive at a stand. All that can touch presses, moves
// against what it touches and slides along it.
typedef struct Pressed {
    Scenario scenario;
    Dynamics dynamics;
    double y[SIZE];
} Pressed;

static void press(Pressed *pressed, const Scenario *mechanism)
{
    *pressed = (Pressed){.scenario = *mechanism};
    Scenario *scenario = &pressed->scenario;
    scenario->gravity = scenario_downward(0.0);
    scenario->contact.stiffness = 6.6e10;
    scenario->contact.exponent = 1.5;
    scenario->contact.friction = 0.2;
    scenario->linkage.driver.speed = 1e-9;
    Dynamics *dynamics = &pressed->dynamics;
    Err err = {ERR_NONE, ""};
    assert_true(dynamics_init(scenario, dynamics, &err));
    const size_t n = dynamics->tree.coordinate_count;
    Motion *motions = dynamics->room.state->tree.motions;
    linkage_start(&scenario->linkage, motions);
    tree_start(&dynamics->tree, motions, pressed->y + n);
    uint64_t seed = 1;
    for (size_t k = 0; k < n; k++) {
        pressed->y[k] = PLACE * lcg_draw(&seed);
        pressed->y[n + k] = RATE * lcg_draw(&seed);
    }
    for (size_t i = 0; i < dynamics->system.contact_count; i++) {
        Contact *contact = &dynamics->system.contacts[i];
        contact->mode = CONTACT_PRESSING;
        contact->damping_rate = 1e3;
        const TouchPose pose = dynamics_contact(dynamics, i, 0.0, pressed->y).pose;
        if (contact->has_walls) {
            contact->wall = dynamics_contact_wall(dynamics, i, 0.0, pressed->y).wall;
            contact->clearance -= pose.gap + DEPTH;
            dynamics->sites[i].touch.clearance = contact->clearance;
            continue;
        }
        contact->clearance = vec2_length(pose.offset) - DEPTH;
        // of lines and discs
        dynamics->tree.base_distances[dynamics->sites[i].pair] -= pose.gap + DEPTH;
        // of angles and teeth
        dynamics->sites[i].end += pose.gap + DEPTH;
    }
}

// A block and its lever, and a disc at either side of the block: one of the ground, one on the
// lever, which turns it.
static Scenario stopped_lever(void)
{
    Scenario scenario = slider_lever(1.0);
    slider_loosen_guide(&scenario, 0.0402, 0.04, 0.05);
    Linkage *linkage = &scenario.linkage;
    linkage->joints[linkage->joint_count++] = (Joint){
        .name = "disc",
        .kind = JOINT_STOP,
        .body_a = LINKAGE_GROUND,
        .body_b = 2,
        .anchor_a = {0.4, 0.03},
        .anchor_b = {0.01, 0.01},
        .stop = {.is_disc = true, .radius_a = 0.01, .radius_b = 0.02},
    };
    linkage->joints[linkage->joint_count++] = (Joint){
        .name = "wall",
        .kind = JOINT_STOP,
        .body_a = 1,
        .body_b = 2,
        .anchor_a = {0.2, 0.05},
        .anchor_b = {0.0, 0.01},
        .direction = -2.0,
        .stop = {.radius_b = 0.01},
    };
    return scenario;
}

// The difference of an acceleration, over the nudge of a coordinate or rate on both sides.
static void differences(Pressed *pressed, size_t k, double nudge, double *column)
{
    const size_t n = pressed->dynamics.tree.coordinate_count;
    double rates[2][SIZE];
    const double kept = pressed->y[k];
    for (int side = 0; side < 2; side++) {
        pressed->y[k] = kept + (side == 0 ? -nudge : nudge);
        dynamics_rates(0.0, pressed->y, rates[side], &pressed->dynamics);
    }
    pressed->y[k] = kept;
    for (size_t i = 0; i < n; i++) {
        column[i] = (rates[1][n + i] - rates[0][n + i]) / (2.0 * nudge);
    }
}

// The largest error of any derivative, over the largest in its column.
static double worst(Pressed *pressed)
{
    const size_t n = pressed->dynamics.tree.coordinate_count;
    double slopes[2][COORDINATES * COORDINATES];
    double worst = 0.0;
    dynamics_slopes(0.0, pressed->y, slopes[0], slopes[1], &pressed->dynamics);
    for (size_t k = 0; k < 2 * n; k++) {
        double column[COORDINATES];
        double error = 0.0;
        double largest = 0.0;
        differences(pressed, k, k < n ? 1e-4 * DEPTH : 1e-4 * RATE, column);
        for (size_t i = 0; i < n; i++) {
            const double slope =
                coupling_entry(pressed->dynamics.system.coupling, slopes[k < n ? 0 : 1], i, k % n);
            error = fmax(error, fabs(slope - column[i]));
            largest = fmax(largest, fabs(column[i]));
        }
        worst = fmax(worst, error / largest);
    }
    return worst;
}

static void derivatives_are_those_of_the_contacts_forces(void **state)
{
    (void)state;
    for (size_t joints = 1; joints <= 3; joints++) {
        const Scenario scenario = mechanism_loose(joints);
        Pressed pressed;
        press(&pressed, &scenario);
        // the frozen geometry leaves out some depths over lengths, and the differences their
        // squares
        assert_true(worst(&pressed) < 1e-4);
        dynamics_finish(&pressed.dynamics);
    }
}

// A gear on the ground and one on an arm that another gear's carrier is, the arm's hinge with
// backlash, a slider with stops on the arm, and a rack on the arm that the sun turns.
static Scenario geared(void)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = 5;
    for (size_t i = 0; i < 5; i++) {
        linkage->bodies[i] = (Body){
            .mass = 0.5,
            .inertia = 1e-3,
            .start = {.position = {i == 1 || i == 3 ? 0.08 : 0.0, i == 2 ? 0.02 : 0.0}},
        };
    }
    const JointContact contact = {.stiffness = 1e5, .exponent = 1.5};
    const Limits gap = {.kind = LIMIT_BACKLASH, .backlash = 1e-3};
    // the sun and the arm (body 2) about the origin, the planet on the arm, the slider on the arm
    linkage->joint_count = 7;
    linkage->joints[0] = (Joint){.name = "sun", .body_a = LINKAGE_GROUND, .body_b = 0};
    linkage->joints[1] = (Joint){.name = "arm",
                                 .body_a = 0,
                                 .body_b = 2,
                                 .anchor_b = {0.0, -0.02},
                                 .limits = gap,
                                 .contact = contact};
    linkage->joints[2] =
        (Joint){.name = "planet", .body_a = 2, .body_b = 1, .anchor_a = {0.08, -0.02}};
    linkage->joints[3] =
        (Joint){.name = "mesh",
                .kind = JOINT_GEAR,
                .body_a = 0,
                .body_b = 1,
                .gear = {.pivots = {1, 2}, .teeth = {20, 60}, .radius_a = 0.02, .radius_b = 0.06},
                .limits = gap};
    linkage->joints[4] = (Joint){.name = "slide",
                                 .kind = JOINT_PRISMATIC,
                                 .body_a = 2,
                                 .body_b = 3,
                                 .anchor_a = {0.08, -0.02},
                                 .limits = gap};
    linkage->joints[5] = (Joint){.name = "line",
                                 .kind = JOINT_PRISMATIC,
                                 .body_a = 2,
                                 .body_b = 4,
                                 .anchor_a = {0.0, -0.04},
                                 .anchor_b = {0.0, -0.02},
                                 .direction = 0.0};
    linkage->joints[6] = (Joint){.name = "rack",
                                 .kind = JOINT_RACK,
                                 .body_a = 4,
                                 .body_b = 0,
                                 .anchor_a = {0.0, -0.02},
                                 .gear = {.pivots = {5, 0}, .radius_a = INFINITY, .radius_b = 0.02},
                                 .limits = gap};
    return scenario;
}

static void derivatives_are_those_of_angles_and_teeth(void **state)
{
    (void)state;
    const Scenario scenario = geared();
    Pressed pressed;
    press(&pressed, &scenario);
    assert_int_equal(pressed.dynamics.system.contact_count, 8);
    assert_true(worst(&pressed) < 1e-3);
    dynamics_finish(&pressed.dynamics);
}

// A cam on the ground with an arm that carries a roller, and a rocker whose flat rides on it.
static Scenario riders(void)
{
    static Profile profile;
    Err err = {ERR_NONE, ""};
    profile.count = 72;
    for (size_t i = 0; i < profile.count; i++) {
        profile.angles[i] = 2.0 * M_PI * (double)i / (double)profile.count;
        profile.radii[i] = 0.03 + 3e-3 * cos(profile.angles[i] - 0.4);
    }
    assert_true(profile_settle(&profile, &err));
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    linkage->profile_count = 1;
    linkage->profiles = &profile;
    linkage->body_count = 3;
    for (size_t i = 0; i < 3; i++) {
        linkage->bodies[i] = (Body){.mass = 0.5, .inertia = 1e-3};
    }
    linkage->bodies[1].start.position = (Vec2){0.045, 0.02};
    linkage->bodies[2].start.position = (Vec2){0.02, 0.045};
    static const Vec2 PIVOTS[] = {{0.0, 0.0}, {0.05, 0.06}, {0.08, 0.04}};
    linkage->joint_count = 5;
    for (int i = 0; i < 3; i++) {
        linkage->joints[i] = (Joint){
            .body_a = LINKAGE_GROUND,
            .body_b = i,
            .anchor_a = PIVOTS[i],
            .anchor_b = vec2_sub(PIVOTS[i], linkage->bodies[i].start.position),
        };
    }
    linkage->joints[3] = (Joint){
        .kind = JOINT_STOP,
        .body_a = 0,
        .body_b = 1,
        .stop = {.cam = 1, .radius_b = 0.01},
    };
    linkage->joints[4] = (Joint){
        .kind = JOINT_STOP,
        .body_a = 0,
        .body_b = 2,
        .anchor_b = {0.0, -0.01},
        .stop = {.cam = 1, .is_flat = true, .facing = -1.4},
    };
    // what rides is moved to where it presses
    Motion motions[3];
    Touch roller[TOUCH_CORNERS];
    Touch flat[TOUCH_CORNERS];
    linkage_start(linkage, motions);
    touch_places(linkage, 3, roller);
    touch_places(linkage, 4, flat);
    linkage->joints[3].stop.radius_b += touch_pose(linkage, roller, motions).gap + DEPTH;
    const double apart = touch_pose(linkage, flat, motions).gap + DEPTH;
    Joint *riding = &linkage->joints[4];
    riding->anchor_b = vec2_add(riding->anchor_b, vec2_rotate(-1.4, (Vec2){apart, 0.0}));
    return scenario;
}

static void derivatives_are_those_of_rollers_and_flats_on_a_cam(void **state)
{
    (void)state;
    const Scenario scenario = riders();
    Pressed pressed;
    press(&pressed, &scenario);
    assert_int_equal(pressed.dynamics.system.contact_count, 2);
    const double off = worst(&pressed);
    print_message("# off by %.3g\n", off);
    assert_true(off < 2e-3);
    dynamics_finish(&pressed.dynamics);
}

// A lever with two slots, and an arm at each whose pin is in it: at a straight wall, and in the arc
// at an end.
static Scenario slotted(void)
{
    static const Vec2 PIVOTS[] = {{0.0, 0.0}, {0.09, -0.03}, {-0.06, 0.07}};
    static const Vec2 SLOTS[] = {{0.05, 0.01}, {-0.04, 0.02}};
    static const Vec2 OFF[] = {{60e-6, 4e-3}, {50e-6, 10.03e-3}}; // across and along
    static const double ACROSS[] = {0.7, -1.1};
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = 3;
    linkage->joint_count = 5;
    for (int i = 0; i < 3; i++) {
        linkage->bodies[i] = (Body){.mass = 0.5, .inertia = 1e-3};
        linkage->bodies[i].start.position =
            vec2_add(PIVOTS[i], (Vec2){0.01 * (i + 1), 0.02 - 0.01 * i});
        linkage->joints[i] = (Joint){
            .body_a = LINKAGE_GROUND,
            .body_b = i,
            .anchor_a = PIVOTS[i],
            .anchor_b = vec2_sub(PIVOTS[i], linkage->bodies[i].start.position),
        };
    }
    for (int i = 0; i < 2; i++) {
        const Vec2 across = vec2_rotate(ACROSS[i], (Vec2){1.0, 0.0});
        const Vec2 pin = vec2_add(vec2_add(SLOTS[i], vec2_scale(OFF[i].x, across)),
                                  vec2_scale(OFF[i].y, vec2_perp(across)));
        linkage->joints[3 + i] = (Joint){
            .kind = JOINT_STOP,
            .body_a = 0,
            .body_b = 1 + i,
            .anchor_a = vec2_sub(SLOTS[i], linkage->bodies[0].start.position),
            .anchor_b = vec2_sub(pin, linkage->bodies[1 + i].start.position),
            .direction = ACROSS[i],
            .stop = {.slot = 0.02, .radius_a = 5.06e-3, .radius_b = 5e-3},
        };
    }
    return scenario;
}

static void derivatives_are_those_of_pins_in_slots(void **state)
{
    (void)state;
    const Scenario scenario = slotted();
    Pressed pressed;
    press(&pressed, &scenario);
    const Contact *contacts = pressed.dynamics.system.contacts;
    assert_int_equal(pressed.dynamics.system.contact_count, 2);
    assert_int_equal(contacts[0].wall, WALL_AHEAD);
    assert_int_equal(contacts[1].wall, WALL_HIGH);
    const double off = worst(&pressed);
    print_message("# off by %.3g\n", off);
    assert_true(off < 1e-4);
    dynamics_finish(&pressed.dynamics);
}

static void derivatives_are_those_of_blocks_and_stops(void **state)
{
    (void)state;
    Scenario slider = slider_driven(&SLIDER_FLORES, 1.0);
    slider_loosen_guide(&slider, 0.052, 0.050, 0.100);
    const Scenario scenarios[] = {slider, stopped_lever()};
    for (int i = 0; i < 2; i++) {
        Pressed pressed;
        press(&pressed, &scenarios[i]);
        assert_int_equal(pressed.dynamics.system.contact_count, i == 0 ? 4 : 6);
        assert_true(worst(&pressed) < 1e-4);
        dynamics_finish(&pressed.dynamics);
    }
}

// Control: derivatives of another motion, of the same place.
static void another_sliding_speed_has_other_derivatives(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_loose(2);
    Pressed pressed;
    press(&pressed, &scenario);
    double slopes[2][2][COORDINATES * COORDINATES];
    for (int i = 0; i < 2; i++) {
        dynamics_slopes(0.0, pressed.y, slopes[i][0], slopes[i][1], &pressed.dynamics);
        for (size_t k = 0; k < pressed.dynamics.system.contact_count; k++) {
            pressed.dynamics.system.contacts[k].law.friction_speed *= 1.1;
        }
    }
    double apart = 0.0;
    double largest = 0.0;
    for (size_t i = 0; i < coupling_value_count(pressed.dynamics.system.coupling); i++) {
        apart = fmax(apart, fabs(slopes[0][1][i] - slopes[1][1][i]));
        largest = fmax(largest, fabs(slopes[0][1][i]));
    }
    assert_true(apart > 1e-3 * largest);
    dynamics_finish(&pressed.dynamics);
}

// Rates at random states, in which contacts are in any of their modes: the short way and the long
// one.
static void compare_rates(const Scenario *scenario)
{
    Dynamics dynamics;
    Err err = {ERR_NONE, ""};
    assert_true(dynamics_init(scenario, &dynamics, &err));
    assert_non_null(dynamics.hinged);
    const size_t n = dynamics.tree.coordinate_count;
    double y[SIZE] = {0.0};
    double rates[2][SIZE];
    Motion *motions = dynamics.room.state->tree.motions;
    linkage_start(&scenario->linkage, motions);
    tree_start(&dynamics.tree, motions, y + n);
    Hinged *hinged = dynamics.hinged;
    uint64_t seed = 1;
    for (int i = 0; i < 200; i++) {
        for (size_t k = 0; k < n; k++) {
            // turns that are short enough for a series, and longer ones
            y[k] = (i % 3 == 0 ? 0.1 : 1e-3) * lcg_draw(&seed);
            y[n + k] = 10.0 * lcg_draw(&seed);
        }
        for (size_t k = 0; k < dynamics.system.contact_count; k++) {
            Contact *contact = &dynamics.system.contacts[k];
            contact->mode = (ContactMode)((i / 3 + (int)k) % 3);
            contact->damping_rate = 1.0 + lcg_draw(&seed);
        }
        const double since_s = i % 2 == 0 ? 1e-5 : 1e-3;
        dynamics.hinged = hinged;
        dynamics_rates(since_s, y, rates[0], &dynamics);
        dynamics.hinged = NULL;
        dynamics_rates(since_s, y, rates[1], &dynamics);
        for (size_t k = 0; k < system_size(&dynamics.system); k++) {
            assert_true(rates[0][k] == rates[1][k]);
        }
    }
    dynamics.hinged = hinged;
    dynamics_finish(&dynamics);
}

static void hinges_and_pins_have_the_same_rates_to_the_last_bit(void **state)
{
    (void)state;
    static const char *const PLAYS[][3] = {
        {"crank-coupler"},
        {"coupler-follower"},
        {"follower-ground"},
        {"crank-coupler", "coupler-follower"},
        {"crank-coupler", "follower-ground"},
        {"coupler-follower", "follower-ground"},
        {"crank-coupler", "coupler-follower", "follower-ground"},
    };
    for (size_t i = 0; i < sizeof PLAYS / sizeof *PLAYS; i++) {
        Scenario scenario = mechanism_paper();
        for (size_t k = 0; k < 3 && PLAYS[i][k] != NULL; k++) {
            mechanism_loosen(&scenario, PLAYS[i][k]);
        }
        scenario.contact.stiffness = 6.6e10;
        scenario.contact.exponent = 1.5;
        compare_rates(&scenario);
        // without a drive the crank hangs on the ground as the others do
        scenario.linkage.driver.is_present = false;
        compare_rates(&scenario);
    }
}

static void a_hole_on_the_coupler_has_the_same_rates_to_the_last_bit(void **state)
{
    (void)state;
    Scenario scenario = mechanism_loose(1);
    Joint *joint = &scenario.linkage.joints[linkage_find_joint(&scenario.linkage, "crank-coupler")];
    const Joint before = *joint;
    joint->body_a = before.body_b;
    joint->anchor_a = before.anchor_b;
    joint->body_b = before.body_a;
    joint->anchor_b = before.anchor_a;
    compare_rates(&scenario);
}

static void other_mechanisms_take_the_long_way(void **state)
{
    (void)state;
    const Scenario ideal = mechanism_paper();
    Scenario rubbing = mechanism_loose(1);
    rubbing.contact.friction = 0.1;
    const Scenario sliding = slider_lever(1.0);
    const Scenario *const SCENARIOS[] = {&ideal, &rubbing, &sliding};
    for (size_t i = 0; i < sizeof SCENARIOS / sizeof *SCENARIOS; i++) {
        Dynamics dynamics;
        Err err = {ERR_NONE, ""};
        assert_true(dynamics_init(SCENARIOS[i], &dynamics, &err));
        assert_null(dynamics.hinged);
        dynamics_finish(&dynamics);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_are_those_of_the_contacts_forces),
        cmocka_unit_test(derivatives_are_those_of_blocks_and_stops),
        cmocka_unit_test(derivatives_are_those_of_rollers_and_flats_on_a_cam),
        cmocka_unit_test(derivatives_are_those_of_pins_in_slots),
        cmocka_unit_test(derivatives_are_those_of_angles_and_teeth),
        cmocka_unit_test(another_sliding_speed_has_other_derivatives),
        cmocka_unit_test(hinges_and_pins_have_the_same_rates_to_the_last_bit),
        cmocka_unit_test(a_hole_on_the_coupler_has_the_same_rates_to_the_last_bit),
        cmocka_unit_test(other_mechanisms_take_the_long_way),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
