// Do the sparse products of the joints' rows say what the dense rows say?
#include "model/joint_system.h"

#include "close.h"
#include "mechanism.h"

static void speeds_are_those_that_the_drive_gives(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const Linkage *linkage = &scenario.linkage;
    Motion motions[3];
    double wanted[9] = {0.0};
    double change[9];
    JointSystem system;
    linkage_start(linkage, motions);
    joint_system_init(linkage, motions, NULL, true, &system);
    assert_int_equal(system.row_count, 9);
    assert_int_equal(joint_system_rank(&system), 9);
    wanted[8] = linkage->driver.speed;
    joint_system_least_change(&system, wanted, change);
    for (int i = 0; i < 3; i++) {
        assert_near(change[3 * i], motions[i].velocity.x, 1e-9);
        assert_near(change[3 * i + 1], motions[i].velocity.y, 1e-9);
        assert_near(change[3 * i + 2], motions[i].omega, 1e-9);
    }
    // the control: another speed of the drive gives others
    wanted[8] *= 1.01;
    joint_system_least_change(&system, wanted, change);
    assert_true(fabs(change[8] - motions[2].omega) > 1e-3 * fabs(motions[2].omega));
    joint_system_finish(&system);
}

static void redundant_rows_are_counted_once(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_parallelogram();
    Motion motions[16];
    JointSystem system;
    linkage_start(&scenario.linkage, motions);
    joint_system_init(&scenario.linkage, motions, NULL, true, &system);
    assert_true(joint_system_rank(&system) < system.row_count);
    joint_system_finish(&system);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(speeds_are_those_that_the_drive_gives),
        cmocka_unit_test(redundant_rows_are_counted_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
