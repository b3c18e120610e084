// Does what a push does change with the bodies as differences along their motion say?
//
// Outside truths: the response itself, placed a little before and a little after, and the free
// accelerations of its rows at speeds that impulses have changed.
#include "close.h"

#include "mechanism.h"
#include "slider.h"

#include "contact/touch.h"
#include "kept.h"
#include "model/kinematics.h"
#include "model/response_drift.h"

#include <stdlib.h>

enum { BODIES = 3, SPEEDS = 3 * BODIES, DRIFT_CASES = 6, LINES = 4, PRISMATIC = 5 };

// of a second: differences over it are right to 1e-7 and rounded by as much
static const double SHORT_S = 1e-7;
static const double SHARE = 1e-5;

// The four-bar with play in one joint or three, without and with friction, and two slider-cranks:
// with play in the guides, and in the slider's pin.
typedef struct DriftCase {
    Scenario scenario;
    Motion motions[KINEMATICS_BODY_MAX];
    Response response;
    ResponseDrift drift;
    double columns[3 * KINEMATICS_BODY_MAX * RESPONSE_ROW_MAX];
    size_t rows;
} DriftCase;

static void make_drift_case(size_t number, DriftCase *made)
{
    static const char *const JOINTS[] = {"crank-coupler", "coupler-follower", "follower-ground"};
    Err err = {ERR_NONE, ""};
    if (number >= LINES) {
        made->scenario =
            number == LINES ? slider_flores_loose(1e8) : slider_driven(&SLIDER_USUAL, 30.0);
        if (number == PRISMATIC) {
            slider_loosen_wrist(&made->scenario, 0.01, 1e-4);
        }
        linkage_start(&made->scenario.linkage, made->motions);
        // the joints need not be closed
        for (size_t i = 0; i < BODIES; i++) {
            made->motions[i].angle += 0.3 + 0.2 * (double)i;
            made->motions[i].omega += 20.0 - 7.0 * (double)i;
            made->motions[i].velocity.x += 1.0 + (double)i;
        }
    } else {
        made->scenario = mechanism_paper();
        for (size_t i = 0; i < (number < 2 ? 1 : 3); i++) {
            mechanism_loosen(&made->scenario, JOINTS[i]);
        }
        linkage_start(&made->scenario.linkage, made->motions);
        assert_true(kinematics_solve(&made->scenario.linkage, 0.7, made->motions, &err));
    }
    made->scenario.contact.stiffness = 1e9; // N/m: no law is asked for
    made->scenario.contact.exponent = 1.0;
    Touch *places = NULL;
    size_t count = 0;
    assert_true(touch_list(&made->scenario, &places, &count, &err));
    touch_response(&made->scenario.linkage, places, count, number % 2 == 1, &made->response);
    free(places);
    assert_true(response_place(&made->response, made->motions));
    made->rows = response_play_rows(&made->response);
    made->drift = response_drift_create(&made->response);
    response_drift_columns(&made->response, made->columns, &made->drift);
    response_drift_find(&made->response, made->motions, SHORT_S, &made->drift);
}

static void finish_case(DriftCase *made)
{
    response_drift_finish(&made->drift);
    response_finish(&made->response);
}

// The bodies some time later.
static void move(const DriftCase *here, double time_s, Motion *moved)
{
    for (size_t i = 0; i < here->scenario.linkage.body_count; i++) {
        moved[i] = here->motions[i];
        moved[i].position = vec2_add(moved[i].position, vec2_scale(time_s, moved[i].velocity));
        moved[i].angle += time_s * moved[i].omega;
    }
}

// By how much numbers that follow from a response change, per second.
static void differ(DriftCase *here, void (*look)(const Response *, double *), size_t count,
                   double *rates)
{
    Motion moved[KINEMATICS_BODY_MAX];
    double *before = calloc(count, sizeof *before);
    move(here, -SHORT_S, moved);
    assert_true(response_place(&here->response, moved));
    look(&here->response, before);
    move(here, SHORT_S, moved);
    assert_true(response_place(&here->response, moved));
    look(&here->response, rates);
    for (size_t i = 0; i < count; i++) {
        rates[i] = (rates[i] - before[i]) / (2.0 * SHORT_S);
    }
    assert_true(response_place(&here->response, here->motions));
    free(before);
}

static double largest(const double *values, size_t count)
{
    double most = 0.0;
    for (size_t i = 0; i < count; i++) {
        most = fmax(most, fabs(values[i]));
    }
    return most;
}

static void the_mobility_changes_by_the_drift_and_its_transpose(void **state)
{
    (void)state;
    for (size_t number = 0; number < DRIFT_CASES; number++) {
        DriftCase here;
        make_drift_case(number, &here);
        const size_t n = here.rows;
        double rates[RESPONSE_ROW_MAX * RESPONSE_ROW_MAX];
        differ(&here, response_mobility, n * n, rates);
        const double scale = largest(rates, n * n);
        const double *drift = here.drift.drift;
        double lopsided = 0.0;
        for (size_t i = 0; i < n; i++) {
            for (size_t k = 0; k < n; k++) {
                assert_near(drift[i * n + k] + drift[k * n + i], rates[i * n + k], SHARE * scale);
                lopsided = fmax(lopsided, fabs(2.0 * drift[i * n + k] - rates[i * n + k]));
            }
        }
        // control: twice the drift alone is not it
        assert_true(lopsided > 0.01 * scale);
        finish_case(&here);
    }
}

static void look_at_columns(const Response *response, double *columns)
{
    const size_t n = response_play_rows(response);
    const size_t speeds = 3 * response->linkage->body_count;
    double impulses[RESPONSE_ROW_MAX] = {0.0};
    for (size_t row = 0; row < n; row++) {
        impulses[row] = 1.0;
        response_apply(response, impulses, columns + row * speeds);
        impulses[row] = 0.0;
    }
}

static void what_a_push_does_to_the_bodies_changes_at_the_rates_found(void **state)
{
    (void)state;
    for (size_t number = 0; number < DRIFT_CASES; number++) {
        DriftCase here;
        make_drift_case(number, &here);
        const size_t count = 3 * here.scenario.linkage.body_count * here.rows;
        double columns[SPEEDS * RESPONSE_ROW_MAX];
        double rates[SPEEDS * RESPONSE_ROW_MAX];
        look_at_columns(&here.response, columns);
        differ(&here, look_at_columns, count, rates);
        for (size_t i = 0; i < count; i++) {
            assert_near(here.drift.columns[i], columns[i], 1e-12 * largest(columns, count));
            assert_near(here.drift.rates[i], rates[i], SHARE * largest(rates, count));
        }
        // control: that is not nothing
        assert_true(largest(rates, count) > 100.0 * SHARE * largest(columns, count));
        finish_case(&here);
    }
}

// The free accelerations of the rows, with speeds that impulses have changed by so much of a
// column.
static void free_after(const DriftCase *here, size_t row, double share, double *rates)
{
    Motion motions[KINEMATICS_BODY_MAX];
    const size_t bodies = here->scenario.linkage.body_count;
    for (size_t i = 0; i < bodies; i++) {
        const double *change = here->drift.columns + 3 * (row * bodies + i);
        motions[i] = here->motions[i];
        motions[i].velocity.x += share * change[0];
        motions[i].velocity.y += share * change[1];
        motions[i].omega += share * change[2];
    }
    response_free(&here->response, motions, scenario_gravity(&here->scenario), NULL, rates);
}

// But for the sliding along a line, which is the rate of nothing.
static void impulses_change_free_accelerations_by_twice_the_drift(void **state)
{
    (void)state;
    for (size_t number = 0; number < DRIFT_CASES; number++) {
        DriftCase here;
        make_drift_case(number, &here);
        const size_t n = here.rows;
        const size_t every = number == LINES ? 2 : 1;
        const double scale = largest(here.drift.drift, n * n);
        double once = 0.0;
        for (size_t k = 0; k < n; k += every) {
            double more[RESPONSE_ROW_MAX];
            double less[RESPONSE_ROW_MAX];
            free_after(&here, k, 1e-3, more);
            free_after(&here, k, -1e-3, less);
            for (size_t i = 0; i < n; i += every) {
                const double truth = (more[i] - less[i]) / 2e-3;
                assert_near(2.0 * here.drift.drift[i * n + k], truth, SHARE * scale);
                once = fmax(once, fabs(here.drift.drift[i * n + k] - truth));
            }
        }
        // control: once the drift
        assert_true(once > 0.1 * scale);
        finish_case(&here);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mobility_changes_by_the_drift_and_its_transpose),
        cmocka_unit_test(what_a_push_does_to_the_bodies_changes_at_the_rates_found),
        cmocka_unit_test(impulses_change_free_accelerations_by_twice_the_drift),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
