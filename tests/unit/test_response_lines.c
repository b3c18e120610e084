// Do the rows at lines and discs go as gaps and sliding speeds do?
//
#include "close.h"

#include "contact/touch.h"
#include "kept.h"

// Numbers that are not round and of either sign.
static double uneven_number(size_t number)
{
    return sin(1.0 + 2.3 * (double)number);
}

// A block between guides, a disc on a line and a disc on a disc, all on one body that flies and
// turns like the other.
static Linkage flying_pair(Motion motions[2])
{
    static const Joint COMMON = {.body_a = 0,
                                 .body_b = 1,
                                 .anchor_a = {0.02, 0.01},
                                 .anchor_b = {-0.015, 0.03},
                                 .direction = 0.4};
    Linkage linkage = kept_linkage();
    linkage.body_count = 2;
    linkage.joint_count = 3;
    const double masses[2] = {0.3, 0.12};
    for (size_t i = 0; i < 2; i++) {
        linkage.bodies[i].mass = masses[i];
        linkage.bodies[i].inertia = 1e-4 * (1.0 + (double)i);
        motions[i] = (Motion){
            .position = {0.1 * uneven_number(i), 0.1 * uneven_number(i + 7)},
            .angle = uneven_number(i + 3),
            .velocity = {uneven_number(i + 11), uneven_number(i + 13)},
            .omega = 30.0 * uneven_number(i + 17),
        };
    }
    for (size_t i = 0; i < 3; i++) {
        linkage.joints[i] = COMMON;
        linkage.joints[i].kind = i == 0 ? JOINT_GUIDE : JOINT_STOP;
    }
    linkage.joints[0].guide = (Guide){.opening = 0.052, .height = 0.05, .length = 0.1};
    linkage.joints[1].stop = (Stop){.radius_b = 0.01};
    linkage.joints[2].stop = (Stop){.is_disc = true, .radius_a = 0.02, .radius_b = 0.03};
    return linkage;
}

// How both bodies move after a time of free flight under gravity and loads.
static void fly(const Linkage *linkage, const Motion *motions, Vec2 gravity, const BodyLoad *loads,
                double time_s, Motion *later)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        const Vec2 push = vec2_add(vec2_scale(1.0 / body->mass, loads[i].force), gravity);
        const double spin = loads[i].moment / body->inertia;
        later[i] = motions[i];
        later[i].velocity = vec2_add(motions[i].velocity, vec2_scale(time_s, push));
        later[i].omega += time_s * spin;
        later[i].position =
            vec2_add(motions[i].position,
                     vec2_scale(0.5 * time_s, vec2_add(motions[i].velocity, later[i].velocity)));
        later[i].angle += 0.5 * time_s * (motions[i].omega + later[i].omega);
    }
}

// Rows of play after some time of flight: rates, from the places' own poses.
static void rates_of_places(const Linkage *linkage, const Touch *places, size_t count,
                            const Motion *motions, double *rates)
{
    for (size_t i = 0; i < count; i++) {
        const TouchPose pose = touch_pose(linkage, &places[i], motions);
        const bool is_line = places[i].shape == TOUCH_LINE;
        *rates++ = is_line ? -pose.approach_speed : pose.velocity.x;
        *rates++ = is_line ? touch_sliding(linkage, &places[i], &pose, motions) : pose.velocity.y;
        if (!is_line) {
            *rates++ = motions[0].omega;
            *rates++ = motions[1].omega;
        }
    }
}

enum { PLACES = 6, PLACE_LINES = 5, PLACE_ROWS = 14 }; // four corners, a line, a disc with turns

typedef struct Flight {
    Linkage linkage;
    Motion motions[2];
    BodyLoad loads[2];
    Touch places[4 * TOUCH_CORNERS];
    Response response;
} Flight;

static const double FLIGHT_MOMENT_S = 1e-5; // (omega t)^2 / 6 = 2e-8 of what changes

static void begin_flight(Flight *flight)
{
    size_t count = 0;
    *flight = (Flight){.loads = {{{0.4, -0.7}, 0.02}, {{-0.3, 0.5}, -0.03}}};
    flight->linkage = flying_pair(flight->motions);
    for (int i = 0; i < 3; i++) {
        count += touch_places(&flight->linkage, i, flight->places + count);
    }
    assert_int_equal(count, PLACES);
    touch_response(&flight->linkage, flight->places, count, true, &flight->response);
    assert_int_equal(response_play_rows(&flight->response), PLACE_ROWS);
    assert_true(response_place(&flight->response, flight->motions));
}

static void lines_open_and_slide_as_their_rows_say(void **state)
{
    (void)state;
    const Vec2 gravity = {2.5, -9.81};
    Flight here;
    begin_flight(&here);
    Motion moved[3][2];
    double rates[3][RESPONSE_ROW_MAX];
    double now[RESPONSE_ROW_MAX];
    for (int k = 0; k < 3; k++) {
        fly(&here.linkage, here.motions, gravity, here.loads, (k - 1) * FLIGHT_MOMENT_S, moved[k]);
        rates_of_places(&here.linkage, here.places, PLACES, moved[k], rates[k]);
    }
    for (size_t i = 0; i < PLACE_LINES; i++) {
        const double gained = touch_pose(&here.linkage, &here.places[i], moved[2]).gap -
                              touch_pose(&here.linkage, &here.places[i], moved[0]).gap;
        assert_near(gained / (2.0 * FLIGHT_MOMENT_S), rates[1][2 * i], 1e-6);
    }
    response_free(&here.response, here.motions, gravity, here.loads, now);
    for (size_t i = 0; i < PLACE_ROWS; i++) {
        assert_near(now[i], (rates[2][i] - rates[0][i]) / (2.0 * FLIGHT_MOMENT_S), 1e-4);
    }
    // control: lines that do not turn
    here.motions[0].omega = 0.0;
    response_free(&here.response, here.motions, gravity, here.loads, now);
    assert_true(fabs(now[0] - (rates[2][0] - rates[0][0]) / (2.0 * FLIGHT_MOMENT_S)) > 1.0);
    response_finish(&here.response);
}

// Both bodies together, about the origin.
static double spin_of(const Linkage *linkage, const Motion *motions, const double *changes)
{
    double spin = 0.0;
    for (size_t i = 0; i < 2; i++) {
        const Vec2 gained = {changes[3 * i], changes[3 * i + 1]};
        spin += linkage->bodies[i].mass * vec2_cross(motions[i].position, gained) +
                linkage->bodies[i].inertia * changes[3 * i + 2];
    }
    return spin;
}

static void a_push_at_a_line_moves_gap_and_sliding_by_the_mobility(void **state)
{
    (void)state;
    Flight here;
    begin_flight(&here);
    double mobility[RESPONSE_ROW_MAX * RESPONSE_ROW_MAX];
    double before[RESPONSE_ROW_MAX];
    double behind[RESPONSE_ROW_MAX];
    response_mobility(&here.response, mobility);
    rates_of_places(&here.linkage, here.places, PLACES, here.motions, before);
    for (size_t k = 0; k < PLACE_ROWS; k++) {
        double impulses[RESPONSE_ROW_MAX] = {0.0};
        double changes[6];
        Motion pushed[2];
        impulses[k] = 1e-3;
        response_apply(&here.response, impulses, changes);
        for (size_t i = 0; i < 2; i++) {
            pushed[i] = here.motions[i];
            pushed[i].velocity.x += changes[3 * i];
            pushed[i].velocity.y += changes[3 * i + 1];
            pushed[i].omega += changes[3 * i + 2];
        }
        rates_of_places(&here.linkage, here.places, PLACES, pushed, behind);
        for (size_t i = 0; i < PLACE_ROWS; i++) {
            assert_near(behind[i] - before[i], 1e-3 * mobility[PLACE_ROWS * i + k], 1e-11);
        }
        if (k < 2 * PLACE_LINES) {
            // both bodies are pushed at one point
            assert_near(spin_of(&here.linkage, here.motions, changes), 0.0, 1e-17);
        }
    }
    response_finish(&here.response);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_open_and_slide_as_their_rows_say),
        cmocka_unit_test(a_push_at_a_line_moves_gap_and_sliding_by_the_mobility),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
