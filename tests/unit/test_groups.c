// Are the bodies of a linkage sorted into the groups that textbooks show?
#include "close.h"

#include "kept.h"
#include "model/groups.h"

#include <string.h>

enum { CRANK };

// A linkage of which only the joints count.
static Linkage joined(size_t bodies, size_t joints, const int pairs[][2])
{
    Linkage linkage = kept_linkage();
    linkage.body_count = bodies;
    linkage.joint_count = joints;
    for (size_t i = 0; i < joints; i++) {
        linkage.joints[i].body_a = pairs[i][0];
        linkage.joints[i].body_b = pairs[i][1];
    }
    linkage.driver = (Driver){.is_present = true, .joint = 0};
    return linkage;
}

static void a_four_bar_has_one_dyad(void **state)
{
    (void)state;
    const int pairs[][2] = {{LINKAGE_GROUND, CRANK}, {CRANK, 1}, {1, 2}, {2, LINKAGE_GROUND}};
    const Linkage linkage = joined(3, 4, pairs);
    Groups groups;
    groups_find(&linkage, &groups);
    assert_int_equal(groups.count, 1);
    assert_int_equal(groups.groups[0].body_count, 2);
    assert_int_equal(groups.groups[0].joint_count, 3);
}

static void a_six_bar_has_two_in_the_order_of_the_drive(void **state)
{
    (void)state;
    // the bodies of the second dyad come first in the list
    const int pairs[][2] = {{LINKAGE_GROUND, CRANK}, {CRANK, 3}, {3, 4},
                            {4, LINKAGE_GROUND},     {4, 1},     {1, 2},
                            {2, LINKAGE_GROUND}};
    const Linkage linkage = joined(5, 7, pairs);
    Groups groups;
    groups_find(&linkage, &groups);
    assert_int_equal(groups.count, 2);
    assert_int_equal(groups.groups[0].bodies[0], 3);
    assert_int_equal(groups.groups[1].bodies[0], 1);
}

static void a_triad_is_not_split(void **state)
{
    (void)state;
    // a plate on three bars, one of them on the crank
    const int pairs[][2] = {
        {LINKAGE_GROUND, CRANK}, {CRANK, 1}, {1, 2}, {2, 3}, {3, LINKAGE_GROUND}, {2, 4},
        {4, LINKAGE_GROUND}};
    const Linkage linkage = joined(5, 7, pairs);
    Groups groups;
    groups_find(&linkage, &groups);
    assert_int_equal(groups.count, 1);
    assert_int_equal(groups.groups[0].body_count, 4);
    assert_int_equal(groups.groups[0].joint_count, 6);
}

static void what_is_held_too_often_or_not_enough_is_left_out(void **state)
{
    (void)state;
    // body 3 swings on the coupler; body 4 is a second coupler
    const int pairs[][2] = {{LINKAGE_GROUND, CRANK},
                            {CRANK, 1},
                            {1, 2},
                            {2, LINKAGE_GROUND},
                            {1, 3},
                            {CRANK, 4},
                            {4, 2}};
    const Linkage linkage = joined(5, 7, pairs);
    Groups groups;
    groups_find(&linkage, &groups);
    assert_int_equal(groups.count, 1);
    assert_int_equal(groups.groups[0].bodies[0] + groups.groups[0].bodies[1], 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_four_bar_has_one_dyad),
        cmocka_unit_test(a_six_bar_has_two_in_the_order_of_the_drive),
        cmocka_unit_test(a_triad_is_not_split),
        cmocka_unit_test(what_is_held_too_often_or_not_enough_is_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
