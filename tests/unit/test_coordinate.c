// Does the coordinate of a pivot, a slider, a pair of gears and a rack go as its row says, and
// answer a push?
#include "complete_run.h"
#include "kept.h"

#include "contact/touch.h"
#include "model/coordinate.h"

enum { PLACES = 10, ROWS = 2 * PLACES };

// Two gears on an arm that flies, a pivot with backlash from the second gear to a lever, and
// another that is written the other way round, a slider on the lever, and a rack that slides on the
// arm and meshes with the first gear.
static Scenario geared(void)
{
    Scenario scenario = kept_default();
    scenario.gravity = scenario_downward(9.81);
    scenario.run.duration = 2e-4;
    scenario.run.samples = 2;
    scenario.contact.exponent = 1.0;
    scenario.contact.stiffness = 1e3;
    Linkage *linkage = &scenario.linkage;
    static const Vec2 AT[] = {{0.0, 0.0},   {0.06, 0.0},  {0.03, 0.01},
                              {0.06, 0.02}, {0.06, 0.05}, {0.01, -0.03}};
    linkage->body_count = 6;
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i] = (Body){
            .mass = 0.2 + 0.1 * (double)i,
            .inertia = 1e-4 * (1.0 + (double)i),
            .start = {.position = AT[i], .velocity = {0.3, -0.2}},
        };
    }
    // all turn with the arm about its centre but the gears, which turn faster
    const double omega[] = {50.0, -20.0, 7.0, 7.0, 7.0, 7.0};
    for (size_t i = 0; i < linkage->body_count; i++) {
        Motion *start = &linkage->bodies[i].start;
        start->omega = omega[i];
        start->velocity =
            vec2_add(start->velocity, vec2_scale(7.0, vec2_perp(vec2_sub(start->position, AT[2]))));
    }
    const JointContact contact = {.stiffness = 1e3, .exponent = 1.0};
    const Limits wide = {.kind = LIMIT_STOPS, .low = -10.0, .high = 10.0};
    const int bodies[][2] = {{2, 0}, {2, 1}, {0, 1}, {1, 3}, {3, 4}, {2, 5}, {5, 0}};
    static const JointKind KINDS[] = {JOINT_REVOLUTE,  JOINT_REVOLUTE,  JOINT_GEAR, JOINT_REVOLUTE,
                                      JOINT_PRISMATIC, JOINT_PRISMATIC, JOINT_RACK};
    static const Vec2 PIVOTS[] = {{0.0, 0.0},   {0.06, 0.0},  {0.0, 0.0},  {0.06, 0.0},
                                  {0.06, 0.04}, {0.0, -0.02}, {0.0, -0.02}};
    linkage->joint_count = 7;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const int a = bodies[i][0];
        const int b = bodies[i][1];
        linkage->joints[i] = (Joint){
            .name = {(char)('a' + (int)i)},
            .kind = KINDS[i],
            .body_a = a,
            .body_b = b,
            .anchor_a = vec2_sub(PIVOTS[i], AT[a]),
            .anchor_b = vec2_sub(i == 2   ? AT[1]
                                 : i == 6 ? AT[0]
                                          : PIVOTS[i],
                                 AT[b]),
            .direction = i < 5 ? 0.4 : 0.0,
            .limits = i == 0 || i == 5 ? (Limits){.kind = LIMIT_NONE} : wide,
            .contact = contact,
        };
    }
    linkage->joints[2].gear =
        (Gear){.pivots = {0, 1}, .teeth = {20.0, 40.0}, .radius_a = 0.02, .radius_b = 0.04};
    linkage->joints[6].gear = (Gear){.pivots = {5, 0}, .radius_a = INFINITY, .radius_b = 0.02};
    return scenario;
}

static double moved(const Linkage *linkage, const Motion *motions, const Touch *place)
{
    return touch_pose(linkage, place, motions).gap;
}

// The gaps of all places of a run of a few samples, in which nothing presses.
static void ends_go_as_their_rows_say(void **state)
{
    (void)state;
    const Scenario scenario = geared();
    const Linkage *linkage = &scenario.linkage;
    Touch *places;
    size_t count;
    Err err = {0};
    Response response;
    double now[ROWS];
    assert_true(touch_list(&scenario, &places, &count, &err));
    assert_int_equal(count, PLACES);
    touch_response(linkage, places, count, false, &response);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const Motion *at[3];
    for (size_t k = 0; k < 3; k++) {
        at[k] = trajectory_motion(run, k, 0);
    }
    assert_true(response_place(&response, at[1]));
    response_free(&response, at[1], scenario_gravity(&scenario), NULL, now);
    const double step_s = run->times[1];
    for (size_t i = 0; i < count; i++) {
        const double rate = -touch_pose(linkage, &places[i], at[1]).approach_speed;
        const double before = -touch_pose(linkage, &places[i], at[0]).approach_speed;
        const double behind = -touch_pose(linkage, &places[i], at[2]).approach_speed;
        const double slope =
            (moved(linkage, at[2], &places[i]) - moved(linkage, at[0], &places[i])) /
            (2.0 * step_s);
        assert_near(slope, rate, 1e-5 * (1.0 + fabs(rate)));
        const double second = (behind - before) / (2.0 * step_s);
        assert_near(now[2 * i], second, 1e-4 * (1.0 + fabs(second)));
        assert_true(touch_is_scalar(&places[i]));
    }
    // control: a slider on a lever that did not turn has no such acceleration
    assert_true(fabs(now[2 * 6]) > 1e-2);
    trajectory_destroy(run);
    response_finish(&response);
    free(places);
}

static void a_push_at_an_end_moves_it_by_the_mobility_and_keeps_the_momentum(void **state)
{
    (void)state;
    const Scenario scenario = geared();
    const Linkage *linkage = &scenario.linkage;
    Touch *places;
    size_t count;
    Err err = {0};
    Response response;
    Motion motions[8];
    double mobility[ROWS * ROWS];
    assert_true(touch_list(&scenario, &places, &count, &err));
    touch_response(linkage, places, count, false, &response);
    linkage_start(linkage, motions);
    assert_true(response_place(&response, motions));
    response_mobility(&response, mobility);
    for (size_t k = 0; k < count; k++) {
        double impulses[ROWS] = {0.0};
        double changes[3 * 8];
        double sums[3] = {0.0, 0.0, 0.0};
        Motion pushed[8];
        impulses[2 * k] = 1e-3;
        response_apply(&response, impulses, changes);
        for (size_t i = 0; i < linkage->body_count; i++) {
            const Vec2 gained = {changes[3 * i], changes[3 * i + 1]};
            pushed[i] = motions[i];
            pushed[i].velocity = vec2_add(pushed[i].velocity, gained);
            pushed[i].omega += changes[3 * i + 2];
            sums[0] += linkage->bodies[i].mass * gained.x;
            sums[1] += linkage->bodies[i].mass * gained.y;
            sums[2] += linkage->bodies[i].mass * vec2_cross(motions[i].position, gained) +
                       linkage->bodies[i].inertia * changes[3 * i + 2];
        }
        for (size_t i = 0; i < count; i++) {
            const double gained = touch_pose(linkage, &places[i], motions).approach_speed -
                                  touch_pose(linkage, &places[i], pushed).approach_speed;
            assert_near(gained, 1e-3 * mobility[ROWS * 2 * i + 2 * k], 1e-12);
        }
        for (int i = 0; i < 3; i++) {
            assert_near(sums[i], 0.0, 1e-17);
        }
    }
    // control: the flanks of the gears do move what stands at the pivot
    assert_true(fabs(mobility[ROWS * 0 + 2 * 2]) > 1e-3);
    // and those of the rack the gears
    assert_true(fabs(mobility[ROWS * 0 + 2 * 8]) > 1e-3);
    response_finish(&response);
    free(places);
}

// Gears on the ground answer along the pitch circles with 1 / (r_a^2 / I_a + r_b^2 / I_b).
static void gears_on_the_ground_have_the_mass_of_the_formula(void **state)
{
    (void)state;
    Scenario scenario = geared();
    Linkage *linkage = &scenario.linkage;
    Touch *places;
    size_t count;
    Err err = {0};
    Response response;
    Motion motions[8];
    linkage->body_count = 2;
    linkage->joint_count = 3;
    for (size_t i = 0; i < 2; i++) {
        Joint *pivot = &linkage->joints[i];
        pivot->body_a = LINKAGE_GROUND;
        pivot->anchor_a = linkage->bodies[i].start.position;
        pivot->limits.kind = LIMIT_NONE;
    }
    assert_true(touch_list(&scenario, &places, &count, &err));
    assert_int_equal(count, 2);
    touch_response(linkage, places, count, false, &response);
    linkage_start(linkage, motions);
    assert_true(response_place(&response, motions));
    const double mass =
        1.0 / (0.02 * 0.02 / linkage->bodies[0].inertia + 0.04 * 0.04 / linkage->bodies[1].inertia);
    assert_near(response_mass(&response, 0, (Vec2){1.0, 0.0}) / mass, 1.0, 1e-14);
    response_finish(&response);
    free(places);
}

// A rack and its pinion on the ground answer with 1 / (1 / m + r^2 / I).
static void a_rack_on_the_ground_has_the_mass_of_the_formula(void **state)
{
    (void)state;
    Scenario scenario = geared();
    Linkage *linkage = &scenario.linkage;
    const Vec2 pivot = linkage->bodies[0].start.position;
    const Joint guide = linkage->joints[5];
    linkage->bodies[1] = linkage->bodies[5];
    linkage->body_count = 2;
    linkage->joints[1] = guide;
    linkage->joints[2] = linkage->joints[6];
    linkage->joint_count = 3;
    linkage->joints[0].body_a = linkage->joints[1].body_a = LINKAGE_GROUND;
    linkage->joints[0].anchor_a = pivot;
    linkage->joints[1].anchor_a = (Vec2){0.0, -0.02};
    linkage->joints[1].body_b = linkage->joints[2].body_a = 1;
    linkage->joints[2].gear.pivots[0] = 1;
    Touch *places;
    size_t count;
    Err err = {0};
    Response response;
    Motion motions[8];
    assert_true(touch_list(&scenario, &places, &count, &err));
    assert_int_equal(count, 2);
    touch_response(linkage, places, count, false, &response);
    linkage_start(linkage, motions);
    assert_true(response_place(&response, motions));
    const double mass =
        1.0 / (1.0 / linkage->bodies[1].mass + 0.02 * 0.02 / linkage->bodies[0].inertia);
    assert_near(response_mass(&response, 0, (Vec2){1.0, 0.0}) / mass, 1.0, 1e-14);
    response_finish(&response);
    free(places);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_go_as_their_rows_say),
        cmocka_unit_test(a_push_at_an_end_moves_it_by_the_mobility_and_keeps_the_momentum),
        cmocka_unit_test(gears_on_the_ground_have_the_mass_of_the_formula),
        cmocka_unit_test(a_rack_on_the_ground_has_the_mass_of_the_formula),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
