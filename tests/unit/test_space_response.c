// Does a linkage in space answer pushes as the equations of motion have it, all at once?
//
// Outside truths: the whole system M dv = J' y + p, J dv = 0 solved by elimination; differences of
// speeds along a motion.
#include "load_case.h"

#include "base/dense.h"
#include "base/lcg.h"
#include "contact/pin_space_rows.h"
#include "model/space_response.h"

#include <stdlib.h>
#include <string.h>

enum {
    RESPONSE_BODIES = 3,
    COLUMNS = SPACE_FREEDOMS * RESPONSE_BODIES,
    IDEAL = COLUMNS, // at most
    SYSTEM = COLUMNS + IDEAL,
    PLAY = PIN_SPACE_PLACES * PIN_SPACE_ROWS,
};

static Vec3 drawn(uint64_t *seed, double size)
{
    const double x = lcg_draw(seed);
    const double y = lcg_draw(seed);
    return vec3_scale(size, (Vec3){x, y, lcg_draw(seed)});
}

typedef struct Case {
    Scenario scenario;
    SpaceMotion motions[RESPONSE_BODIES];
    size_t place_count;
    PinSpace places[PIN_SPACE_PLACES];
    PinSpaceRows rows[PIN_SPACE_PLACES];
    size_t play_count;
    SpaceRow play_rows[PLAY];
    SpaceResponse *response;
} Case;

// A Bennett linkage with play in one pin, its bodies a little beside where they belong and moving
// at random; with the rows of friction.
static void make_case(unsigned number, Case *made)
{
    *made = (Case){.scenario = load_with("cases/space/bennett.yaml", "contact.friction=0.1")};
    const Linkage *linkage = &made->scenario.linkage;
    uint64_t seed = lcg_stirred(number);
    space_start(linkage, made->motions);
    Err err = {ERR_NONE, ""};
    PinSpace *places = pin_space_list(&made->scenario, &made->place_count, &err);
    assert_int_equal(made->place_count, PIN_SPACE_PLACES);
    SpaceResponsePlace taken[PIN_SPACE_PLACES];
    for (size_t i = 0; i < made->place_count; i++) {
        made->places[i] = places[i];
        taken[i] = (SpaceResponsePlace){places[i].joint, pin_space_row_count(&places[i])};
    }
    free(places);
    made->response = test_calloc(1, sizeof *made->response);
    assert_true(space_response_init(linkage, made->motions, taken, made->place_count,
                                    made->response, &err));
    for (size_t i = 0; i < linkage->body_count; i++) {
        SpaceMotion *motion = &made->motions[i];
        const SpaceChange place = {drawn(&seed, 1e-5), drawn(&seed, 1e-4)};
        const SpaceChange speed = {drawn(&seed, 1.0), drawn(&seed, 20.0)};
        space_change(motion, &place, &speed);
        motion->acceleration = drawn(&seed, 10.0);
        motion->alpha = drawn(&seed, 100.0);
    }
    for (size_t i = 0; i < made->place_count; i++) {
        pin_space_rows_place(&made->places[i], made->motions, &made->rows[i]);
        memcpy(made->play_rows + made->play_count, made->rows[i].rows,
               made->rows[i].count * sizeof(SpaceRow));
        made->play_count += made->rows[i].count;
    }
    assert_int_equal(made->play_count, 2 * PIN_SPACE_ROWS + PIN_SPACE_PLAIN_ROWS);
    assert_true(space_response_place(made->response, made->motions, made->play_rows));
}

static void release(Case *here)
{
    space_response_finish(here->response);
    test_free(here->response);
}

// A row over the six columns of each body.
static void spread(const SpaceRow *row, double *columns)
{
    memset(columns, 0, COLUMNS * sizeof *columns);
    for (int side = 0; side < 2; side++) {
        if (row->body[side] != LINKAGE_GROUND) {
            const Vec3 linear = row->linear[side];
            const Vec3 angular = row->angular[side];
            const double parts[6] = {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z};
            for (int k = 0; k < 6; k++) {
                columns[6 * row->body[side] + k] += parts[k];
            }
        }
    }
}

// What an impulse in a row changes of all bodies, and how the ideal joints answer it.
static void solve_whole(const Case *here, const SpaceRow *pushed, double *solution)
{
    const Linkage *linkage = &here->scenario.linkage;
    const size_t ideal = here->response->ideal_rows;
    const size_t size = COLUMNS + ideal;
    const int driven = linkage_driven_body(linkage);
    double *matrix = calloc(size * size, sizeof *matrix);
    memset(solution, 0, size * sizeof *solution);
    double push[COLUMNS];
    spread(pushed, push);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Mat3 inertia = space_world_inertia(&linkage->bodies[i], here->motions[i].turn);
        for (size_t k = 0; k < 3; k++) {
            const Vec3 turns = inertia.row[k];
            double *move = matrix + (6 * i + k) * size + 6 * i;
            double *turn = matrix + (6 * i + 3 + k) * size + 6 * i + 3;
            move[k] = (int)i == driven ? 1.0 : linkage->bodies[i].mass;
            turn[0] = turns.x;
            turn[1] = turns.y;
            turn[2] = turns.z;
        }
        for (size_t k = 0; k < 6; k++) {
            solution[6 * i + k] = (int)i == driven ? 0.0 : push[6 * i + k];
        }
    }
    for (size_t row = 0; row < ideal; row++) {
        double columns[COLUMNS];
        spread(&here->response->rows[row].row, columns);
        for (size_t k = 0; k < COLUMNS; k++) {
            const bool is_driven = (int)(k / 6) == driven;
            matrix[(COLUMNS + row) * size + k] = is_driven ? 0.0 : columns[k];
            matrix[k * size + COLUMNS + row] = is_driven ? 0.0 : -columns[k];
        }
    }
    assert_true(dense_solve(size, matrix, solution));
    free(matrix);
}

static double largest_of(const double *numbers, size_t count)
{
    double largest = 0.0;
    for (size_t i = 0; i < count; i++) {
        largest = fmax(largest, fabs(numbers[i]));
    }
    return largest;
}

static void pushes_are_answered_as_the_whole_system_answers(void **state)
{
    (void)state;
    static double mobility[PLAY * PLAY];
    for (unsigned number = 0; number < 5; number++) {
        Case here;
        make_case(number, &here);
        assert_int_equal(here.response->ideal_rows, 10);
        space_response_mobility(here.response, mobility);
        for (size_t row = 0; row < here.play_count; row++) {
            double truth[SYSTEM];
            double impulses[PLAY] = {0.0};
            double reactions[IDEAL];
            SpaceChange changes[RESPONSE_BODIES];
            impulses[row] = 1.0;
            solve_whole(&here, &here.play_rows[row], truth);
            space_response_apply(here.response, impulses, changes);
            space_response_react(here.response, impulses, reactions);
            const double moved = largest_of(truth, COLUMNS);
            for (size_t i = 0; i < here.scenario.linkage.body_count; i++) {
                const double found[6] = {changes[i].move.x, changes[i].move.y, changes[i].move.z,
                                         changes[i].turn.x, changes[i].turn.y, changes[i].turn.z};
                for (size_t k = 0; k < 6; k++) {
                    assert_near(found[k], truth[6 * i + k], 1e-10 * moved);
                }
            }
            const double held = largest_of(truth + COLUMNS, here.response->ideal_rows);
            for (size_t i = 0; i < here.response->ideal_rows; i++) {
                assert_near(reactions[i], truth[COLUMNS + i], 1e-10 * held);
            }
            for (size_t other = 0; other < here.play_count; other++) {
                double columns[COLUMNS];
                double rate = 0.0;
                spread(&here.play_rows[other], columns);
                for (size_t k = 0; k < COLUMNS; k++) {
                    rate += columns[k] * truth[k];
                }
                assert_near(mobility[row * here.play_count + other], rate, 1e-10 * moved);
            }
        }
        release(&here);
    }
}

// The motions a little later or earlier.
static void move_by(const Case *here, double span_s, SpaceMotion *motions)
{
    for (size_t i = 0; i < here->scenario.linkage.body_count; i++) {
        const SpaceMotion *motion = &here->motions[i];
        const double square = 0.5 * span_s * span_s;
        const SpaceChange place = {
            vec3_add(vec3_scale(span_s, motion->velocity),
                     vec3_scale(square, motion->acceleration)),
            vec3_add(vec3_scale(span_s, motion->omega), vec3_scale(square, motion->alpha))};
        const SpaceChange speed = {vec3_scale(span_s, motion->acceleration),
                                   vec3_scale(span_s, motion->alpha)};
        motions[i] = *motion;
        space_change(&motions[i], &place, &speed);
    }
}

// The control: without what the turning of bodies makes, the accelerations at rest.
static void rates_of_rows_change_as_they_are_said_to(void **state)
{
    (void)state;
    const double span_s = 1e-5;
    for (unsigned number = 0; number < 5; number++) {
        Case here;
        make_case(number, &here);
        double least_off = INFINITY;
        for (size_t i = 0; i < here.place_count; i++) {
            SpaceMotion motions[2][RESPONSE_BODIES];
            double position[2][2];
            double speed[2][PIN_SPACE_ROWS];
            double drift[PIN_SPACE_ROWS];
            double still[PIN_SPACE_ROWS];
            for (int k = 0; k < 2; k++) {
                move_by(&here, k == 0 ? -span_s : span_s, motions[k]);
                pin_space_rows_state(&here.places[i], &here.rows[i], motions[k], position[k],
                                     speed[k]);
            }
            pin_space_rows_drift(&here.places[i], &here.rows[i], here.motions, drift);
            SpaceMotion resting[RESPONSE_BODIES];
            memcpy(resting, here.motions, sizeof resting);
            for (size_t k = 0; k < here.scenario.linkage.body_count; k++) {
                resting[k].velocity = resting[k].omega = (Vec3){0.0, 0.0, 0.0};
            }
            pin_space_rows_drift(&here.places[i], &here.rows[i], resting, still);
            for (size_t k = 0; k < here.rows[i].count; k++) {
                const double rate = (speed[1][k] - speed[0][k]) / (2.0 * span_s);
                assert_near(drift[k], rate, 1e-3 + 1e-5 * fabs(rate));
            }
            least_off = fmin(least_off, fabs(still[0] - drift[0]));
        }
        assert_true(least_off > 0.1);
        release(&here);
    }
}

// The rows that a start chose may depend on each other later.
static void rows_that_have_become_dependent_are_chosen_anew(void **state)
{
    (void)state;
    static double mobility[2][PLAY * PLAY];
    Case here;
    make_case(1, &here);
    SpaceResponse *response = here.response;
    space_response_mobility(response, mobility[0]);
    const int part = response->part_of[1];
    response->joint_of[1] = response->joint_of[0];
    response->part_of[1] = response->part_of[0];
    assert_true(space_response_place(response, here.motions, here.play_rows));
    assert_int_equal(response->ideal_rows, 10);
    assert_int_equal(response->part_of[1], part);
    space_response_mobility(response, mobility[1]);
    assert_memory_equal(mobility[0], mobility[1],
                        here.play_count * here.play_count * sizeof(double));
    release(&here);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pushes_are_answered_as_the_whole_system_answers),
        cmocka_unit_test(rows_that_have_become_dependent_are_chosen_anew),
        cmocka_unit_test(rates_of_rows_change_as_they_are_said_to),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
