// Does the picture show of a pin in space what is across its hole's axis, and nothing else?
#include "commands/run/plot_lines.h"

#include "close.h"

#include <math.h>

// One body at the origin of the world whose hole has an axis, turned about the axis z.
typedef struct Hole {
    Body body;
    Joint joint;
    Scenario scenario;
    SpaceMotion motions[2];
    Trajectory run;
    RunReport report;
} Hole;

static void make_hole(Hole *hole, Vec3 axis, Quat turn)
{
    *hole = (Hole){.body = {.mass = 1.0}};
    hole->joint = (Joint){.kind = JOINT_CLEARANCE, .body_a = 0, .body_b = LINKAGE_GROUND};
    hole->joint.space.axis = vec3_scale(1.0 / vec3_length(axis), axis);
    hole->scenario.linkage.bodies = &hole->body;
    hole->scenario.linkage.joints = &hole->joint;
    hole->scenario.linkage.body_count = 1;
    hole->scenario.linkage.joint_count = 1;
    hole->scenario.linkage.is_spatial = true;
    hole->motions[0].turn = quat_of_turn((Vec3){0.0, 0.0, 0.0});
    hole->motions[1].turn = turn;
    hole->run.body_count = 1;
    hole->run.space_motions = hole->motions;
    hole->report.scenario = &hole->scenario;
}

static Vec2 across(const Hole *hole, size_t sample, Vec3 offset)
{
    return plot_pins_across(&hole->report, &hole->run, sample, 0, offset);
}

static void a_pin_that_slides_stays_in_the_middle(void **state)
{
    (void)state;
    static const Vec3 AXES[] = {
        {0.0, 1.0, 1.0}, {1.0, 0.0, 0.0}, {0.3, -2.0, -0.1}, {0.0, 0.0, -1.0}};
    for (size_t i = 0; i < sizeof AXES / sizeof *AXES; i++) {
        Hole hole;
        make_hole(&hole, AXES[i], quat_of_turn((Vec3){0.4, -0.2, 0.9}));
        for (size_t sample = 0; sample < 2; sample++) {
            const Vec3 axis =
                quat_rotate(hole.motions[sample].turn, hole.scenario.linkage.joints[0].space.axis);
            const Vec2 slid = across(&hole, sample, vec3_scale(1e-3, axis));
            assert_near(vec2_length(slid), 0.0, 1e-18);
            // what is across keeps its length, sliding or not
            const Vec3 normal = vec3_scale(2e-5, vec3_normal_to(axis));
            const Vec2 both = across(&hole, sample, vec3_add(normal, vec3_scale(1e-3, axis)));
            assert_near(vec2_length(both), 2e-5, 1e-18);
        }
    }
}

static void a_hole_along_z_shows_the_directions_of_the_world(void **state)
{
    (void)state;
    const Vec3 offset = {3e-6, -4e-6, 1e-3};
    for (int side = -1; side <= 1; side += 2) {
        Hole hole;
        make_hole(&hole, (Vec3){0.0, 0.0, side}, quat_of_turn((Vec3){0.0, 0.0, 2.0}));
        const Vec2 shown = across(&hole, 1, offset);
        assert_near(shown.x, offset.x, 1e-21);
        assert_near(shown.y, offset.y, 1e-21);
    }
}

// The directions themselves turn with the axis: a path has no jump that the pin did not make.
static void the_directions_move_as_smoothly_as_the_axis(void **state)
{
    (void)state;
    const Vec3 offset = {3e-6, -4e-6, 2e-6};
    const double step = 1e-3;
    for (double angle = -1.5; angle < 1.5; angle += step) {
        Hole hole;
        make_hole(&hole, (Vec3){0.2, 0.1, 1.0}, quat_of_turn((Vec3){0.3, angle, 0.0}));
        const Vec2 before = across(&hole, 1, offset);
        hole.motions[1].turn = quat_of_turn((Vec3){0.3, angle + step, 0.0});
        const Vec2 after = across(&hole, 1, offset);
        assert_true(vec2_length(vec2_sub(after, before)) < 3.0 * step * vec3_length(offset));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pin_that_slides_stays_in_the_middle),
        cmocka_unit_test(a_hole_along_z_shows_the_directions_of_the_world),
        cmocka_unit_test(the_directions_move_as_smoothly_as_the_axis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
