// Does the reference end with an error where a motion cannot be followed?
#include "close.h"

#include "mechanism.h"

#include "reference/plane/dynamics.h"
#include "reference/stepper.h"

#include <stdlib.h>
#include <string.h>

enum { MANY = 200000 };

// The equations of motion of a mechanism with play in one joint.
static Dynamics loose(const Scenario *scenario)
{
    Dynamics dynamics;
    Err err = {ERR_NONE, ""};
    assert_true(dynamics_init(scenario, &dynamics, &err));
    assert_int_equal(dynamics.system.contact_count, 1);
    return dynamics;
}

// Counts steps of a length, with so many events at each, until that fails; 0 where it never does.
static size_t steps_until_failure(const Dynamics *dynamics, double step_s, size_t events, Err *err)
{
    Pace pace = {0};
    Event first = {.contact = 0};
    const EventList list = {.count = events, .events = &first};
    for (size_t i = 1; i <= MANY; i++) {
        if (!pace_keep(&pace, &dynamics->system, &list, (double)i * step_s, err)) {
            return i;
        }
    }
    return 0;
}

static void steps_that_lead_nowhere_end_with_the_joint_to_blame(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_loose(1);
    Dynamics dynamics = loose(&scenario);
    Err err = {ERR_NONE, ""};
    assert_true(steps_until_failure(&dynamics, 1e-12, 0, &err) > 0);
    assert_int_equal(err.kind, ERR_SOLVER);
    assert_non_null(strstr(err.text, "steps advanced the motion by only"));
    assert_null(strstr(err.text, "crank-coupler"));
    dynamics.system.contacts[0].mode = CONTACT_PRESSING;
    err = (Err){ERR_NONE, ""};
    assert_true(steps_until_failure(&dynamics, 1e-12, 0, &err) > 0);
    assert_non_null(strstr(err.text, "the contact of crank-coupler is too stiff"));
    // control: steps of a usual length may go on
    err = (Err){ERR_NONE, ""};
    assert_int_equal(steps_until_failure(&dynamics, 1e-7, 0, &err), 0);
    dynamics_finish(&dynamics);
}

static void events_at_one_instant_end(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_loose(1);
    Dynamics dynamics = loose(&scenario);
    Err err = {ERR_NONE, ""};
    const size_t failed_at = steps_until_failure(&dynamics, 0.0, 1, &err);
    assert_in_range(failed_at, 100, 10000);
    assert_int_equal(err.kind, ERR_SOLVER);
    assert_non_null(strstr(err.text, "the contact of crank-coupler keeps beginning and ending"));
    // control: events that are apart may be any number
    err = (Err){ERR_NONE, ""};
    assert_int_equal(steps_until_failure(&dynamics, 1e-7, 1, &err), 0);
    dynamics_finish(&dynamics);
}

static void a_step_below_the_rounding_of_time_ends(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    Stepper *stepper = test_calloc(1, sizeof *stepper);
    Err err = {ERR_NONE, ""};
    assert_true(stepper_init(stepper, &scenario, &err));
    // the first step, of the whole run, is far too long, and no shorter one is allowed
    stepper->integrator.step = stepper->integrator.shortest = stepper->duration_s;
    assert_false(stepper_next(stepper, &err));
    assert_int_equal(err.kind, ERR_SOLVER);
    assert_non_null(strstr(err.text, "the step fell below the rounding of time"));
    stepper_finish(stepper);
    // control: where it may be shortened it is
    err = (Err){ERR_NONE, ""};
    assert_true(stepper_init(stepper, &scenario, &err));
    stepper->integrator.step = stepper->duration_s;
    assert_true(stepper_next(stepper, &err));
    stepper_finish(stepper);
    test_free(stepper);
}

// A pin of 9.986 mm on a stiffness that is given: it may be as deep as that, and of a size that
// nobody gave as deep as it likes.
static void a_given_stiffness_holds_at_any_depth(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_loose(1);
    Joint *joint = &scenario.linkage.joints[linkage_find_joint(&scenario.linkage, "crank-coupler")];
    Dynamics dynamics = loose(&scenario);
    SystemState *at = &dynamics_state_create(&dynamics)->shared;
    Err err = {ERR_NONE, ""};
    at->contacts[0].depth = 9.9e-3;
    assert_true(system_check_depth(&dynamics.system, at, 1.0, &err));
    at->contacts[0].depth = 1e-2;
    assert_false(system_check_depth(&dynamics.system, at, 1.0, &err));
    assert_non_null(strstr(err.text, "which is all of it"));
    joint->clearance.is_pin_assumed = true;
    at->contacts[0].depth = 1.0;
    err = (Err){ERR_NONE, ""};
    assert_true(system_check_depth(&dynamics.system, at, 1.0, &err));
    at->contacts[0].depth = INFINITY;
    assert_false(system_check_depth(&dynamics.system, at, 1.0, &err));
    assert_non_null(strstr(err.text, "is no number"));
    free(at);
    dynamics_finish(&dynamics);
}

static void a_pin_beyond_the_end_of_its_law_ends(void **state)
{
    (void)state;
    Scenario scenario = mechanism_loose(1);
    scenario.contact.stiffness = 0.0; // the law of its material
    Dynamics dynamics = loose(&scenario);
    SystemState *at = &dynamics_state_create(&dynamics)->shared;
    Err err = {ERR_NONE, ""};
    at->contacts[0].depth = 1e-6;
    assert_true(system_check_depth(&dynamics.system, at, 1.0, &err));
    at->contacts[0].depth = 1e-3;
    assert_false(system_check_depth(&dynamics.system, at, 1.0, &err));
    assert_int_equal(err.kind, ERR_SOLVER);
    assert_non_null(strstr(err.text, "no contact law holds beyond"));
    // and a depth that is no number
    err = (Err){ERR_NONE, ""};
    at->contacts[0].depth = NAN;
    assert_false(system_check_depth(&dynamics.system, at, 1.0, &err));
    free(at);
    dynamics_finish(&dynamics);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_that_lead_nowhere_end_with_the_joint_to_blame),
        cmocka_unit_test(events_at_one_instant_end),
        cmocka_unit_test(a_step_below_the_rounding_of_time_ends),
        cmocka_unit_test(a_pin_beyond_the_end_of_its_law_ends),
        cmocka_unit_test(a_given_stiffness_holds_at_any_depth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
