// With which mass do the corners of a block and stops meet their lines and discs, and is their one
// impact run as it is asked for?
#include "close.h"
#include "mechanism.h"

#include "measure/mapping.h"
#include "model/kinematics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double MASS = 0.2;       // kg
static const double INERTIA = 1.5e-4; // kg m^2
static const double LENGTH = 0.06;    // m, of the block
static const double HEIGHT = 0.03;

static Scenario lone_body(JointKind kind, double speed)
{
    Scenario scenario = mechanism_pin(MASS, 1e-3);
    Linkage *linkage = &scenario.linkage;
    linkage->bodies[0].inertia = INERTIA;
    linkage->bodies[0].start.velocity.y = -speed;
    linkage->joints[0].kind = kind;
    scenario.contact.stiffness = 1e8;
    scenario.contact.exponent = 1.5;
    scenario.contact.damping = DAMPING_EXACT;
    scenario.contact.restitution = 0.7;
    scenario.run.duration = 1.5e-3 / speed;
    scenario.run.samples = 100;
    return scenario;
}

// A block, tilted a little, that falls on one of its guides.
static Scenario falling_block(double speed)
{
    Scenario scenario = lone_body(JOINT_GUIDE, speed);
    scenario.linkage.joints[0].guide =
        (Guide){.opening = HEIGHT + 2e-3, .height = HEIGHT, .length = LENGTH};
    scenario.linkage.bodies[0].start.angle = 1e-3;
    return scenario;
}

// A disc that falls on a line, or on another disc.
static Scenario falling_disc(bool on_disc, double speed)
{
    Scenario scenario = lone_body(JOINT_STOP, speed);
    Joint *stop = &scenario.linkage.joints[0];
    stop->direction = 0.5 * M_PI;
    stop->stop = (Stop){.is_disc = on_disc, .radius_a = on_disc ? 0.01 : 0.0, .radius_b = 0.01};
    scenario.linkage.bodies[0].start.position.y = on_disc ? 0.021 : 0.011;
    return scenario;
}

static MappingJoint measure(const Scenario *scenario)
{
    MappingJoint *joints = NULL;
    size_t count = 0;
    Err err = {ERR_NONE, ""};
    if (!mapping_joint_measure(scenario, (RunWatch){0}, &joints, &count, &err)) {
        fail_msg("%s", err.text);
    }
    assert_int_equal(count, 1);
    const MappingJoint joint = joints[0];
    free(joints);
    return joint;
}

static void a_corner_presses_with_the_mass_at_its_lever(void **state)
{
    (void)state;
    const Scenario scenario = falling_block(0.3);
    const MappingJoint joint = measure(&scenario);
    // pushed at its corner: 1 / m' = 1 / m + lever^2 / I, the lever along the guide. The control:
    // the mass of the block itself is more than twice that
    const double at_corner = 1.0 / (1.0 / MASS + 0.25 * LENGTH * LENGTH / INERTIA);
    assert_close(joint.mass_median, at_corner, 0.01);
    assert_true(joint.mass_most < 0.5 * MASS);
    assert_true(joint.onsets >= 1);
    assert_true(joint.speed_most > 0.299);
}

static void a_disc_presses_with_its_whole_mass(void **state)
{
    (void)state;
    for (int on_disc = 0; on_disc < 2; on_disc++) {
        const Scenario scenario = falling_disc(on_disc == 1, 0.3);
        const MappingJoint joint = measure(&scenario);
        assert_close(joint.mass_least, MASS, 1e-9);
        assert_close(joint.mass_most, MASS, 1e-9);
        assert_int_equal(joint.onsets, 1);
        assert_close(joint.speed_most, 0.3, 1e-6);
    }
}

// What ODE delivers at a corner or stop is what is asked, by the map that integrates contacts, and
// what is predicted, by one of rows.
static void an_impact_at_a_line_is_delivered(void **state)
{
    (void)state;
    const Scenario scenarios[] = {falling_block(0.3), falling_disc(false, 0.3),
                                  falling_disc(true, 0.3)};
    for (size_t i = 0; i < 3; i++) {
        const MappingSettings settings = {
            .step_count = 1,
            .steps = {2e-6},
            .map_count = 2,
            .maps = {ODE_MAP_MIDPOINT, ODE_MAP_IMPULSE},
            .mass_source = MAPPING_MEDIAN,
            .speed_source = MAPPING_GIVEN,
            .speed = 0.3,
        };
        Mapping mapping;
        Err err = {ERR_NONE, ""};
        if (!mapping_make(&scenarios[i], &settings, (MappingWatch){0}, &mapping, &err)) {
            fail_msg("%s", err.text);
        }
        assert_int_equal(mapping.row_count, 2);
        for (size_t k = 0; k < 2; k++) {
            const MappingRow *row = &mapping.rows[k];
            if (!row->delivered.is_measured) {
                fail_msg("%s", row->delivered.message);
            }
            assert_near(row->delivered.figures.restitution.mean, 0.7, k == 0 ? 0.01 : 1e-4);
            assert_close(row->delivered.figures.force_max.mean, row->predicted.force_max.mean,
                         0.01);
        }
        mapping_finish(&mapping);
    }
}

// A joint's own restitution goes with its lone pin.
static void a_joints_own_restitution_is_delivered(void **state)
{
    (void)state;
    Scenario scenario = falling_disc(false, 0.3);
    scenario.linkage.joints[0].contact =
        (JointContact){.has_restitution = true, .restitution = 0.35};
    const MappingSettings settings = {
        .step_count = 1,
        .steps = {2e-6},
        .map_count = 1,
        .maps = {ODE_MAP_IMPULSE},
        .mass_source = MAPPING_MEDIAN,
        .speed_source = MAPPING_GIVEN,
        .speed = 0.3,
    };
    Mapping mapping;
    Err err = {ERR_NONE, ""};
    assert_true(mapping_make(&scenario, &settings, (MappingWatch){0}, &mapping, &err));
    assert_near(mapping.contacts[0].asked.restitution, 0.35, 1e-3);
    assert_near(mapping.rows[0].delivered.figures.restitution.mean, 0.35, 1e-3);
    mapping_finish(&mapping);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_corner_presses_with_the_mass_at_its_lever),
        cmocka_unit_test(a_disc_presses_with_its_whole_mass),
        cmocka_unit_test(an_impact_at_a_line_is_delivered),
        cmocka_unit_test(a_joints_own_restitution_is_delivered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
