// Does the first screen say of a range what is known of it, and no more digits than it allows?
#include "base/zeroed.h"
#include "close.h"
#include "write/spread.h"
#include "write/units.h"

#include <stdlib.h>
#include <string.h>

// A range of one pin that a test sets up.
typedef struct Made {
    Scenario scenario;
    SettledMotion motion;
    SettledJoint joint;
    SpreadInput inputs[2];
    double ranks[2];
    SpreadRange range;
    SpreadRange forms;
    Spread spread;
} Made;

static void make(Made *made)
{
    *made = (Made){.scenario = scenario_default()};
    made->scenario.linkage = linkage_create((LinkageRoom){.joints = 1});
    made->scenario.linkage.joint_count = 1;
    Joint *joint = &made->scenario.linkage.joints[0];
    joint->kind = JOINT_CLEARANCE;
    text_copy(joint->name, sizeof joint->name, "wrist");
    made->joint.force.headline = 2357.2;
    made->joint.impacts.mean = 1.0;
    made->motion = (SettledMotion){.period = 1, .joints = &made->joint};
    made->scenario.settled.motion_count = 1;
    made->scenario.settled.motions = &made->motion;
    made->inputs[0] = (SpreadInput){.key = "contact.restitution",
                                    .item_count = 1,
                                    .nominal = 0.9,
                                    .lower = -0.02,
                                    .upper = 0.02};
    made->inputs[1] = (SpreadInput){.key = "joints.wrist.hole",
                                    .item_count = 1,
                                    .nominal = 12.08,
                                    .lower = -0.02,
                                    .upper = 0.02,
                                    .unit = "mm",
                                    .is_given = true};
    made->ranks[0] = 0.1;
    made->ranks[1] = -0.72;
    made->range = (SpreadRange){2064.6, 2426.2};
    made->forms = (SpreadRange){1867.7, 4148.4};
    made->spread = (Spread){.is_there = true,
                            .scenario = &made->scenario,
                            .motion_count = 1,
                            .inputs = {2, made->inputs},
                            .ranks = made->ranks,
                            .asked = 38,
                            .draw_count = 38,
                            .ranges = &made->range,
                            .form_ranges = &made->forms};
    made->spread.has_form[SPREAD_LAW] = true;
    made->spread.has_form[SPREAD_FRICTION] = true;
}

static void made_finish(Made *made)
{
    made->scenario.settled = (SettledStart){.motion_count = 0};
    scenario_free(&made->scenario);
}

static void assert_words(const Made *made, const char *words, bool is_there)
{
    Text text;
    text_init(&text);
    spread_sentences(&made->spread, &text);
    if ((strstr(text.data, words) != NULL) != is_there) {
        fail_msg("%s\nis %s in\n%s", words, is_there ? "not" : "", text.data);
    }
    text_finish(&text);
}

static void the_ranges_stand_beside_the_number(void **state)
{
    (void)state;
    Made made;
    make(&made);
    assert_words(&made,
                 "  wrist 2.4 kN: 2.0 to 2.5 within the inputs' limits (38 draws), 1.8 to 4.2 "
                 "with other laws and friction.",
                 true);
    assert_words(&made, "run.budget", false);
    // a narrow range has its third digit, and is rounded away from what is in it
    made.range = (SpreadRange){2353.1, 2361.2};
    assert_words(&made, "  wrist 2.36 kN: 2.35 to 2.37 within", true);
    made.spread.draw_count = 9;
    made.spread.is_spent = true;
    made.spread.without = 3;
    assert_words(&made, "9 of 38 draws", true);
    assert_words(&made, "run.budget ended the draws.", true);
    assert_words(&made, "3 of the draws fail.", true);
    made.spread.without = 1;
    assert_words(&made, "1 of the draws fails.", true);
    made.spread.without = 3;
    made.spread.why_without =
        "--set joints.wrist.hole=12 mm: the pin (12.01 mm) must be smaller\nx";
    assert_words(&made, "3 of the draws make no case: the pin (12.01 mm) must be smaller.", true);
    made_finish(&made);
}

static void assumed_limits_and_the_first_of_the_inputs_are_named(void **state)
{
    (void)state;
    Made made;
    make(&made);
    // what the case gives is not assumed
    assert_words(&made, "Assumed limits +-: restitution 0.02; wrist.hole matters most", true);
    assert_words(&made, "(correlation -0.72)", true);
    assert_words(&made, "hole 0", false);
    made.ranks[1] = -0.3;
    assert_words(&made, "no single input matters most.", true);
    assert_words(&made, "hole matters most", false);
    made_finish(&made);
}

static void equal_limits_of_several_joints_stand_once(void **state)
{
    (void)state;
    Made made;
    make(&made);
    const SpreadInput hole = {
        .item_count = 1, .nominal = 0.03005, .lower = -2.5e-6, .upper = 2.5e-6, .unit = "m"};
    made.inputs[0] = hole;
    text_copy(made.inputs[0].key, sizeof made.inputs[0].key, "joints.pin-1.hole");
    made.inputs[1] = hole;
    text_copy(made.inputs[1].key, sizeof made.inputs[1].key, "joints.pin-2.hole");
    assert_words(&made, "Assumed limits +-: hole of 2 joints 2.50 um; pin-2.hole matters", true);
    // the control: another limit, and another key
    made.inputs[1].upper = 5e-6;
    assert_words(&made, "pin-1.hole 2.50 um, pin-2.hole 5.00 um;", true);
    made.inputs[1] = hole;
    text_copy(made.inputs[1].key, sizeof made.inputs[1].key, "joints.pin-2.pin");
    assert_words(&made, "pin-1.hole 2.50 um, pin-2.pin 2.50 um;", true);
    made_finish(&made);
}

static void a_touch_nearby_is_said(void **state)
{
    (void)state;
    Made made;
    make(&made);
    assert_words(&made, "a contact", false);
    made.spread.touch = (SpreadTouch){
        .is_there = true, .at = 0.9076, .force = 2110.2, .impacts = 2.0, .was_impacts = 1.5};
    assert_words(&made, "With restitution 0.84 % higher a contact begins: about 2.11 kN there.",
                 true);
    made.spread.touch.at = 0.8924;
    made.spread.touch.impacts = 1.0;
    assert_words(&made, "With restitution 0.84 % lower a contact ends", true);
    made_finish(&made);
}

static void nothing_is_said_where_nobody_looked(void **state)
{
    (void)state;
    Text text;
    text_init(&text);
    const Spread nothing = {.is_there = false};
    spread_sentences(&nothing, &text);
    spread_sentences(NULL, &text);
    assert_int_equal(text.length, 0);
    text_finish(&text);
}

// 1 - n p^(n-1) + (n-1) p^n at p = .9 (Wilks 1941).
static void the_confidence_is_that_of_order_statistics(void **state)
{
    (void)state;
    assert_near(spread_confidence(2), 0.01, 1e-12);
    assert_near(spread_confidence(24), 0.7075, 1e-4);
    assert_near(spread_confidence(38), 0.9047, 1e-4);
    assert_near(spread_confidence(1), 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ranges_stand_beside_the_number),
        cmocka_unit_test(assumed_limits_and_the_first_of_the_inputs_are_named),
        cmocka_unit_test(equal_limits_of_several_joints_stand_once),
        cmocka_unit_test(a_touch_nearby_is_said),
        cmocka_unit_test(nothing_is_said_where_nobody_looked),
        cmocka_unit_test(the_confidence_is_that_of_order_statistics),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
