// Is the linkage's answer to a push the one of its equations of motion, solved whole?
//
#include "close.h"

#include "mechanism.h"
#include "whole_linkage.h"

#include "kept.h"
#include "model/kinematics.h"
#include "model/response.h"

#include <stdlib.h>

static void assert_all_near(const double *values, const double *truth, size_t count, double share)
{
    double scale = 0.0;
    for (size_t i = 0; i < count; i++) {
        scale = fmax(scale, fabs(truth[i]));
    }
    for (size_t i = 0; i < count; i++) {
        assert_near(values[i], truth[i], share * scale);
    }
}

// Numbers that are not round and of either sign.
static double some_number(size_t number)
{
    return sin(1.0 + 2.3 * (double)number);
}

// The four-bar with play in its first joints after the drive's, with or without turns.
typedef struct Case {
    Scenario scenario;
    Motion motions[KINEMATICS_BODY_MAX];
    Response response;
    WholeLinkage whole;
} Case;

enum { CASES = 4 };

static void make_case(size_t number, Case *made)
{
    static const char *const JOINTS[] = {"crank-coupler", "coupler-follower", "follower-ground"};
    made->scenario = mechanism_paper();
    const bool with_turns = number % 2 == 1;
    for (size_t i = 0; i < (number < 2 ? 1 : 3); i++) {
        mechanism_loosen(&made->scenario, JOINTS[i]);
    }
    linkage_start(&made->scenario.linkage, made->motions);
    Err err = {ERR_NONE, ""};
    assert_true(kinematics_solve(&made->scenario.linkage, 0.7, made->motions, &err));
    response_init(&made->scenario.linkage, with_turns, &made->response);
    assert_true(response_place(&made->response, made->motions));
    made->whole = whole_build(&made->scenario.linkage, made->motions, with_turns, false);
    assert_int_equal(made->response.ideal_rows, made->whole.ideal_rows);
    assert_int_equal(made->response.row_count, made->whole.row_count);
}

// Rounding in a dozen rows whose entries differ by 1e3, with room.
static const double ROUNDING = 1e-11;

static void pushes_move_the_bodies_as_the_whole_equations_say(void **state)
{
    (void)state;
    for (size_t number = 0; number < CASES; number++) {
        Case here;
        make_case(number, &here);
        const size_t width = response_play_rows(&here.response);
        double impulses[RESPONSE_ROW_MAX];
        for (size_t i = 0; i < width; i++) {
            impulses[i] = some_number(i);
        }
        double loads[WHOLE_COLUMN_MAX];
        double changes[WHOLE_COLUMN_MAX];
        double reactions[RESPONSE_ROW_MAX];
        const double still[RESPONSE_ROW_MAX] = {0.0};
        double now[RESPONSE_ROW_MAX + WHOLE_COLUMN_MAX];
        whole_load(&here.whole, impulses, loads);
        whole_solve(&here.whole, loads, still, changes, reactions);
        response_load(&here.response, impulses, now);
        assert_all_near(now, loads, here.whole.columns, ROUNDING);
        response_apply(&here.response, impulses, now);
        assert_all_near(now, changes, here.whole.columns, ROUNDING);
        response_react(&here.response, impulses, now);
        assert_all_near(now, reactions, here.whole.ideal_rows, ROUNDING);
        response_finish(&here.response);
    }
}

static void the_mobility_is_what_unit_impulses_do_to_the_rows(void **state)
{
    (void)state;
    for (size_t number = 0; number < CASES; number++) {
        Case here;
        make_case(number, &here);
        const size_t width = response_play_rows(&here.response);
        const double still[RESPONSE_ROW_MAX] = {0.0};
        double mobility[RESPONSE_ROW_MAX * RESPONSE_ROW_MAX];
        response_mobility(&here.response, mobility);
        double greatest_change = 0.0;
        for (size_t k = 0; k < width; k++) {
            double impulses[RESPONSE_ROW_MAX] = {0.0};
            double loads[WHOLE_COLUMN_MAX];
            double changes[WHOLE_COLUMN_MAX];
            double reactions[RESPONSE_ROW_MAX];
            double truth[RESPONSE_ROW_MAX];
            double column[RESPONSE_ROW_MAX];
            impulses[k] = 1.0;
            whole_load(&here.whole, impulses, loads);
            whole_solve(&here.whole, loads, still, changes, reactions);
            for (size_t i = 0; i < width; i++) {
                truth[i] = whole_rate(&here.whole, here.whole.ideal_rows + i, changes);
                column[i] = mobility[i * width + k];
            }
            assert_all_near(column, truth, width, ROUNDING);
            // control: bodies that no ideal joint holds move otherwise
            WholeLinkage open = here.whole;
            open.ideal_rows = 0;
            whole_solve(&open, loads, still, changes, reactions);
            const double alone = whole_rate(&here.whole, here.whole.ideal_rows + k, changes);
            // the turn of a driven body has none
            greatest_change =
                fmax(greatest_change, truth[k] != 0.0 ? fabs(alone / truth[k] - 1.0) : 0.0);
        }
        // with play in all three joints there is no ideal joint left but the driven one
        assert_int_equal(greatest_change > 0.1, number < 2);
        response_finish(&here.response);
    }
}

static void the_free_acceleration_is_that_of_the_whole_equations(void **state)
{
    (void)state;
    const Vec2 gravity = {-3.1, -9.3};
    for (size_t number = 0; number < CASES; number++) {
        Case here;
        make_case(number, &here);
        const Linkage *linkage = &here.scenario.linkage;
        const size_t driven = (size_t)linkage_driven_body(linkage);
        double loads[WHOLE_COLUMN_MAX] = {0.0};
        for (size_t i = 0; i < linkage->body_count; i++) {
            // bodies turn as they like: the joints with play let them
            here.motions[i].omega += i == driven ? 0.0 : 20.0 * some_number(i);
            loads[3 * i] = i == driven ? 0.0 : gravity.x * linkage->bodies[i].mass;
            loads[3 * i + 1] = i == driven ? 0.0 : gravity.y * linkage->bodies[i].mass;
        }
        double given[RESPONSE_ROW_MAX];
        double needed[RESPONSE_ROW_MAX];
        double accelerations[WHOLE_COLUMN_MAX];
        double reactions[RESPONSE_ROW_MAX];
        whole_given(&here.whole, given);
        for (size_t row = 0; row < here.whole.ideal_rows; row++) {
            needed[row] = -given[row];
        }
        whole_solve(&here.whole, loads, needed, accelerations, reactions);
        const size_t width = response_play_rows(&here.response);
        double truth[RESPONSE_ROW_MAX];
        double now[RESPONSE_ROW_MAX];
        double weightless[RESPONSE_ROW_MAX];
        double difference = 0.0;
        response_free(&here.response, here.motions, gravity, NULL, now);
        response_free(&here.response, here.motions, (Vec2){0.0, 0.0}, NULL, weightless);
        for (size_t i = 0; i < width; i++) {
            const size_t row = here.whole.ideal_rows + i;
            truth[i] = whole_rate(&here.whole, row, accelerations) + given[row];
            difference = fmax(difference, fabs(weightless[i] - truth[i]));
        }
        assert_all_near(now, truth, width, 1e-7);
        // control: without gravity it is another one
        assert_true(difference > 0.05 * vec2_length(gravity));
        // and those of all bodies
        double bodies[WHOLE_COLUMN_MAX];
        response_accelerate(&here.response, here.motions, gravity, NULL, bodies);
        for (size_t k = 0; k < 3; k++) {
            accelerations[3 * driven + k] = bodies[3 * driven + k]; // the drive's
        }
        assert_all_near(bodies, accelerations, 3 * linkage->body_count, 1e-7);
        response_accelerate(&here.response, here.motions, (Vec2){0.0, 0.0}, NULL, bodies);
        difference = 0.0;
        for (size_t i = 0; i < 3 * linkage->body_count; i++) {
            difference = fmax(difference, fabs(bodies[i] - accelerations[i]));
        }
        assert_true(difference > 0.05 * vec2_length(gravity));
        response_finish(&here.response);
    }
}

static void openings_are_closed_by_the_least_change_of_motion(void **state)
{
    (void)state;
    for (size_t number = 0; number < 2; number++) {
        Case here;
        make_case(number, &here);
        const Linkage *linkage = &here.scenario.linkage;
        double openings[RESPONSE_ROW_MAX];
        double needed[RESPONSE_ROW_MAX];
        for (size_t row = 0; row < here.whole.ideal_rows; row++) {
            openings[row] = 1e-9 * some_number(row);
            needed[row] = -openings[row];
        }
        const double loads[WHOLE_COLUMN_MAX] = {0.0};
        double truth[WHOLE_COLUMN_MAX];
        double reactions[RESPONSE_ROW_MAX];
        double changes[WHOLE_COLUMN_MAX];
        whole_solve(&here.whole, loads, needed, truth, reactions);
        double impulses[RESPONSE_ROW_MAX];
        response_close(&here.response, openings, impulses, changes);
        for (size_t row = 0; row < here.whole.ideal_rows; row++) {
            assert_near(impulses[row], reactions[row], ROUNDING);
        }
        assert_all_near(changes, truth, here.whole.columns, ROUNDING);
        // what has been opened is found, and closed again to the square of the change
        for (size_t i = 0; i < linkage->body_count; i++) {
            Motion *motion = &here.motions[i];
            motion->position = vec2_sub(motion->position, (Vec2){truth[3 * i], truth[3 * i + 1]});
            motion->angle -= truth[3 * i + 2];
        }
        double places[RESPONSE_ROW_MAX];
        double rates[RESPONSE_ROW_MAX];
        response_openings(&here.response, here.motions, places, rates);
        for (size_t row = 0; row < here.whole.ideal_rows; row++) {
            assert_near(places[row], openings[row], 1e-13); // as well as the four-bar was closed
            assert_near(rates[row], 0.0, 1e-6);             // the opening times omega, and more
        }
        response_finish(&here.response);
    }
}

static void a_free_pin_has_its_own_mass_in_every_direction(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_pin(0.123, 1e-3);
    Response response;
    response_init(&scenario.linkage, false, &response);
    assert_true(response_place(&response, &scenario.linkage.bodies[0].start));
    for (double angle = 0.0; angle < 6.0; angle += 0.7) {
        const Vec2 normal = {cos(angle), sin(angle)};
        assert_close(response_mass(&response, 0, normal), 0.123, 1e-14);
    }
    // control: a pin off the centre of mass gives way by turning, but not along its arm
    Scenario off = kept_copy(&scenario);
    off.linkage.joints[0].anchor_b = (Vec2){0.02, 0.0};
    response_finish(&response);
    response_init(&off.linkage, false, &response);
    assert_true(response_place(&response, &off.linkage.bodies[0].start));
    assert_close(response_mass(&response, 0, (Vec2){1.0, 0.0}), 0.123, 1e-14);
    assert_close(response_mass(&response, 0, (Vec2){0.0, 1.0}),
                 1.0 / (1.0 / 0.123 + 0.02 * 0.02 / 1e-6), 1e-12);
    response_finish(&response);
}

// The mass along a normal is also what the mobility says, in every joint of several.
static void the_effective_mass_is_that_of_the_mobility(void **state)
{
    (void)state;
    Case here;
    make_case(3, &here);
    const size_t width = response_play_rows(&here.response);
    double mobility[RESPONSE_ROW_MAX * RESPONSE_ROW_MAX];
    response_mobility(&here.response, mobility);
    const Vec2 n = {0.6, -0.8};
    for (size_t first = 0; first < width; first += RESPONSE_ROWS_A_JOINT) {
        const double *row = mobility + first * width + first;
        const double along =
            n.x * (n.x * row[0] + n.y * row[1]) + n.y * (n.x * row[width] + n.y * row[width + 1]);
        assert_close(response_mass(&here.response, first, n), 1.0 / along, 1e-12);
        assert_int_equal(response_joint(&here.response, first), 1 + (int)first / 4);
    }
    response_finish(&here.response);
}

// Copies of one joint have copies of its rows: each moves all of them as itself.
static void a_joint_may_stand_there_many_times(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(1.0, 1e-3);
    Linkage *linkage = &scenario.linkage;
    linkage->joints[0].anchor_b = (Vec2){0.02, 0.01};
    while (linkage->joint_count < KINEMATICS_JOINT_MAX) {
        linkage->joints[linkage->joint_count++] = linkage->joints[0];
    }
    Response response;
    response_init(linkage, true, &response);
    const size_t width = response_play_rows(&response);
    assert_int_equal(width, KINEMATICS_JOINT_MAX * RESPONSE_ROWS_A_JOINT);
    assert_true(response_place(&response, &linkage->bodies[0].start));
    double *mobility = malloc(width * width * sizeof *mobility);
    assert_non_null(mobility);
    response_mobility(&response, mobility);
    for (size_t i = 0; i < width; i++) {
        for (size_t k = 0; k < width; k++) {
            const double *own = mobility + i % RESPONSE_ROWS_A_JOINT * width;
            assert_true(mobility[i * width + k] == own[k % RESPONSE_ROWS_A_JOINT]);
        }
    }
    // control: not all rows are alike
    assert_true(mobility[0] != mobility[width + 1]);
    free(mobility);
    response_finish(&response);
}

// Cranks of length 1 with their feet at 0, 1 and 2, and the bar on their heads.
static void place_parallelogram(double angle, Motion *motions)
{
    const Vec2 along = {cos(angle), sin(angle)};
    for (int i = 0; i < 3; i++) {
        motions[i] = (Motion){.position = {i + 0.5 * along.x, 0.5 * along.y}, .angle = angle};
    }
    motions[3] = (Motion){.position = {1.0 + along.x, along.y}};
}

static void redundant_ideal_joints_are_told(void **state)
{
    (void)state;
    Scenario scenario = mechanism_parallelogram();
    Linkage *linkage = &scenario.linkage;
    Response response;
    Motion motions[KINEMATICS_BODY_MAX];
    // at many angles: what rounding leaves of the last pivot may be of either sign
    for (double angle = 0.3; angle < 3.0; angle += 0.1) {
        place_parallelogram(angle, motions);
        linkage->joint_count = 6;
        response_init(linkage, false, &response);
        assert_false(response_place(&response, motions));
        response_finish(&response);
        // control: two cranks are enough, and not too many
        linkage->joint_count = 4;
        response_init(linkage, false, &response);
        assert_true(response_place(&response, motions));
        response_finish(&response);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pushes_move_the_bodies_as_the_whole_equations_say),
        cmocka_unit_test(the_mobility_is_what_unit_impulses_do_to_the_rows),
        cmocka_unit_test(the_free_acceleration_is_that_of_the_whole_equations),
        cmocka_unit_test(openings_are_closed_by_the_least_change_of_motion),
        cmocka_unit_test(a_free_pin_has_its_own_mass_in_every_direction),
        cmocka_unit_test(the_effective_mass_is_that_of_the_mobility),
        cmocka_unit_test(a_joint_may_stand_there_many_times),
        cmocka_unit_test(redundant_ideal_joints_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
