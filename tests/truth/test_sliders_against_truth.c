// Is the reference right where something slides, tilts or is stopped? The same contacts, integrated
// in quadruple precision by another method from other coordinates, say so.
//
// The error is the largest difference of a body's omega at the samples over the largest |omega| of
// any, and of the velocities of centres over the largest of those. The truth's own is far below
// (test_truth.c).
#include "complete_run.h"

#include "kept.h"
#include "slider.h"
#include "truth_samples.h"

#include <stdlib.h>

// The largest difference of three velocities, over the largest of each.
typedef struct Apart {
    double difference[3];
    double largest[3];
} Apart;

static void compare(const Motion *motion, const TruthSample *truth, Apart *apart)
{
    const Quad rates[3] = {truth->x_rate, truth->y_rate, truth->omega};
    const double seen[3] = {motion->velocity.x, motion->velocity.y, motion->omega};
    for (int i = 0; i < 3; i++) {
        const double difference = (double)fabsq(seen[i] - rates[i]);
        apart->largest[i] = fmax(apart->largest[i], fabs((double)rates[i]));
        // a NaN must not pass for no difference
        apart->difference[i] =
            !(difference <= apart->difference[i]) ? difference : apart->difference[i];
    }
}

static double error_of(const Scenario *scenario, const TruthSample *truth)
{
    Trajectory *trajectory = complete_run(scenario, BACKEND_REFERENCE);
    Apart apart = {{0.0}, {0.0}};
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        for (size_t body = 0; body < trajectory->body_count; body++) {
            compare(trajectory_motion(trajectory, k, body),
                    &truth[k * trajectory->body_count + body], &apart);
        }
    }
    trajectory_destroy(trajectory);
    double error = 0.0;
    for (int i = 0; i < 3; i++) {
        const double scale = i < 2 ? fmax(apart.largest[0], apart.largest[1]) : apart.largest[2];
        error = fmax(error, apart.difference[i] / scale);
    }
    return error;
}

// Holds a bound of the error, and lets a reference with other damping fail it.
static void check(const char *name, const Scenario *scenario, double bound)
{
    const QuadProblem problem = quad_problem(scenario);
    TruthFigures figures;
    TruthSample *truth = truth_at_samples(scenario, &problem, &figures);
    const double error = error_of(scenario, truth);
    print_message("# %s: error %.3g; %zu contacts begun, %zu ended, truth in %zu steps\n", name,
                  error, figures.onsets, figures.ends, figures.steps);
    assert_true(figures.onsets > 0);
    assert_true(error <= bound);
    Scenario other = kept_copy(scenario);
    other.contact.damping = DAMPING_HUNT_CROSSLEY;
    assert_true(error_of(&other, truth) > 1e3 * bound);
    free(truth);
}

// The contact and accuracy of all that follow.
static void set_contact(Scenario *scenario, double friction)
{
    scenario->contact.stiffness = 6.6e9;
    scenario->contact.exponent = 1.5;
    scenario->contact.damping = DAMPING_LANKARANI_NIKRAVESH;
    scenario->contact.restitution = 0.9;
    scenario->contact.impact_speed_floor = 1e-3;
    scenario->contact.friction = friction;
    scenario->contact.friction_speed = 1e-2;
    // the least that is offered
    scenario->reference.tolerance = 1e-14;
}

// The field's slider-crank at 5000 rpm with 0.5 mm of play in the pin of rod and slider: a dozen
// impacts, by which a difference at the start has grown a thousandfold.
static void play_in_the_pin_of_a_slider_is_right(void **state)
{
    (void)state;
    Scenario scenario = slider_driven(&SLIDER_USUAL, 5000.0 * 2.0 * M_PI / 60.0);
    slider_loosen_wrist(&scenario, 0.010, 0.5e-3);
    scenario.run.samples = 480;
    scenario.run.revolutions = 0.5;
    set_contact(&scenario, 0.0);
    check("pin", &scenario, 1e-10);
    set_contact(&scenario, 0.1);
    check("pin, friction", &scenario, 1e-10);
}

// A block in its guides that tilts, each of its corners by itself, with and without friction.
static void a_tilted_block_is_right(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        Scenario scenario = slider_crank(&SLIDER_FLORES, 150.0);
        slider_loosen_guide(&scenario, 0.052, 0.050, 0.100);
        if (i == 2) {
            slider_loosen_guide(&scenario, 0.050, 0.052, 0.100);
        }
        set_contact(&scenario, i == 1 ? 0.1 : 0.0);
        scenario.linkage.bodies[2].start.omega = -0.01;
        scenario.run.samples = 400;
        scenario.run.duration = 6.6e-3;
        check(i == 2 ? "sleeve" : i == 1 ? "block, friction" : "block", &scenario, 1e-10);
    }
}

// A block on a lever that turns, driven: lines that move.
static void a_block_on_a_turning_lever_is_right(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        Scenario scenario = slider_lever(40.0);
        slider_loosen_guide(&scenario, 0.0402, 0.0400, 0.050);
        set_contact(&scenario, i == 1 ? 0.1 : 0.0);
        scenario.run.samples = 3600;
        scenario.run.revolutions = 0.05;
        check(i == 1 ? "lever, friction" : "lever", &scenario, 1e-10);
    }
}

// Play in pin and guide of the field's slider-crank, with friction.
static void play_in_pin_and_guide_with_friction_is_right(void **state)
{
    (void)state;
    Scenario scenario = slider_driven(&SLIDER_USUAL, 5000.0 * 2.0 * M_PI / 60.0);
    slider_loosen_wrist(&scenario, 0.010, 0.5e-3);
    slider_loosen_guide(&scenario, 0.0402, 0.0400, 0.050);
    set_contact(&scenario, 0.1);
    scenario.run.samples = 1200;
    scenario.run.revolutions = 0.15;
    check("pin and guide, friction", &scenario, 1e-10);
}

// Discs that meet discs, a floor and a wall that a body carries, spinning, with friction.
static void discs_and_stops_with_friction_are_right(void **state)
{
    (void)state;
    Scenario scenario = slider_lever(40.0);
    slider_loosen_guide(&scenario, 0.0402, 0.0400, 0.050);
    Linkage *linkage = &scenario.linkage;
    linkage->bodies[3] = (Body){
        .name = "ball",
        .mass = 0.05,
        .inertia = 1e-5,
        .start = {.position = {0.1, -0.041}, .velocity = {0.5, -1.0}, .omega = 300.0},
    };
    linkage->body_count = 4;
    linkage->joints[4] = (Joint){
        .name = "floor",
        .kind = JOINT_STOP,
        .body_a = LINKAGE_GROUND,
        .body_b = 3,
        .anchor_a = {0.0, -0.065},
        .direction = 1.5,
        .stop = {.radius_b = 0.02},
    };
    linkage->joints[5] = (Joint){
        .name = "lever-ball",
        .kind = JOINT_STOP,
        .body_a = 1,
        .body_b = 3,
        .anchor_a = {0.0, -0.02},
        .direction = -0.5 * M_PI,
        .stop = {.radius_b = 0.02},
    };
    linkage->joints[6] = (Joint){
        .name = "post",
        .kind = JOINT_STOP,
        .body_a = LINKAGE_GROUND,
        .body_b = 3,
        .anchor_a = {0.14, -0.05},
        .stop = {.is_disc = true, .radius_a = 0.01, .radius_b = 0.02},
    };
    linkage->joint_count = 7;
    set_contact(&scenario, 0.1);
    scenario.run.samples = 3600;
    scenario.run.revolutions = 0.05;
    check("stops, friction", &scenario, 1e-10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(play_in_the_pin_of_a_slider_is_right),
        cmocka_unit_test(a_tilted_block_is_right),
        cmocka_unit_test(a_block_on_a_turning_lever_is_right),
        cmocka_unit_test(discs_and_stops_with_friction_are_right),
        cmocka_unit_test(play_in_pin_and_guide_with_friction_is_right),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
