// Where do masses and speeds of a mapping come from, what do its words say, and what is an inverse?
#include "close.h"
#include "mechanism.h"

#include "commands/map/map.h"
#include "contact/damping.h"
#include "measure/mapping.h"
#include "model/kinematics.h"
#include "run/registry.h"

#include <stdio.h>
#include <string.h>

static const MappingSettings ONE_ROW = {
    .step_count = 1, .steps = {1e-6}, .map_count = 1, .maps = {ODE_MAP_TEXTBOOK}};

// A pin of 0.1 kg thrown at the wall of its hole, 1 mm off.
static Scenario thrown_pin(double speed)
{
    Scenario scenario = mechanism_pin(0.1, 1e-3);
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.exponent = 1.5;
    scenario.linkage.bodies[0].start.velocity.x = speed;
    scenario.run.duration = 1.5e-3 / speed;
    scenario.run.samples = 100;
    return scenario;
}

static void a_lone_pin_has_its_own_mass_and_speed(void **state)
{
    (void)state;
    const Scenario scenario = thrown_pin(0.3);
    MappingJoint *joints = NULL;
    size_t count = 0;
    Err err = {ERR_NONE, ""};
    assert_true(mapping_joint_measure(&scenario, (RunWatch){0}, &joints, &count, &err));
    assert_int_equal(count, 1);
    assert_int_equal(joints[0].onsets, 1);
    assert_close(joints[0].mass_least, 0.1, 1e-12);
    assert_close(joints[0].mass_most, 0.1, 1e-12);
    assert_close(joints[0].speed_median, 0.3, 1e-9);
    // it was pressed as deep as the closed form says
    const double chi = damping_factor(scenario.contact.damping, scenario.contact.restitution);
    assert_close(joints[0].penetration_max, damping_depth_max(6.6e10, 1.5, chi, 0.1, 0.3), 1e-2);
    free(joints);
}

static void in_a_linkage_the_mass_depends_on_where_it_is_pushed(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_loose(2);
    MappingJoint *joints = NULL;
    size_t count = 0;
    Err err = {ERR_NONE, ""};
    assert_true(mapping_joint_measure(&scenario, (RunWatch){0}, &joints, &count, &err));
    assert_int_equal(count, 2);
    for (size_t i = 0; i < 2; i++) {
        assert_true(joints[i].mass_least < joints[i].mass_median);
        assert_true(joints[i].mass_median < joints[i].mass_most);
        assert_true(joints[i].speed_median <= joints[i].speed_most);
    }
    // both ends of the coupler are free: across its length it gives way like a rod at its end
    const Body *coupler = &scenario.linkage.bodies[1];
    const double arm = 0.1397;
    const double rod = 1.0 / (1.0 / coupler->mass + arm * arm / coupler->inertia);
    assert_close(joints[0].mass_least, rod, 0.02);
    assert_close(joints[0].mass_most, coupler->mass, 0.02);
    free(joints);
}

// Every contact of the run, up to its very end: as many as the run itself counts, and those of the
// half-interval behind the last look at the masses. Control: a run that ends before the last
// contact has one fewer.
static void every_contact_of_the_run_is_counted(void **state)
{
    (void)state;
    Scenario scenario = thrown_pin(0.3);
    scenario.contact.restitution = 1.0;
    // across the hole and back: walls are met at 1 mm, 3 mm, 5 mm of the way, the last of them
    // (two contacts of 76 us later) within the last 240th of the run
    scenario.run.duration = 5e-3 / 0.3 * 1.0105;
    MappingJoint *joints = NULL;
    size_t count = 0;
    Err err = {ERR_NONE, ""};
    assert_true(mapping_joint_measure(&scenario, (RunWatch){0}, &joints, &count, &err));
    assert_int_equal(joints[0].onsets, 3);
    scenario.run.duration = 5e-3 / 0.3 * 0.98;
    free(joints);
    assert_true(mapping_joint_measure(&scenario, (RunWatch){0}, &joints, &count, &err));
    assert_int_equal(joints[0].onsets, 2);
    for (size_t loose = 1; loose <= 3; loose++) {
        const Scenario linkage = mechanism_loose(loose);
        Trajectory *run = run_scenario(&linkage, registry_solver(BACKEND_REFERENCE), (RunWatch){0});
        assert_true(run->is_complete);
        free(joints);
        assert_true(mapping_joint_measure(&linkage, (RunWatch){0}, &joints, &count, &err));
        assert_int_equal(count, loose);
        for (size_t i = 0; i < count; i++) {
            assert_int_equal(joints[i].onsets, run->joints[joints[i].joint].impacts);
        }
        trajectory_destroy(run);
    }
    free(joints);
}

static void what_is_given_is_taken_and_needs_no_run(void **state)
{
    (void)state;
    Scenario scenario = thrown_pin(0.3);
    scenario.contact.restitution = 1.0;
    MappingSettings settings = ONE_ROW;
    settings.mass_source = settings.speed_source = MAPPING_GIVEN;
    settings.mass = 0.02;
    settings.speed = 0.7;
    Mapping mapping;
    Err err = {ERR_NONE, ""};
    assert_true(mapping_make(&scenario, &settings, (MappingWatch){0}, &mapping, &err));
    const MappingContact *contact = &mapping.contacts[0];
    assert_near(contact->impact.mass, 0.02, 0.0);
    assert_near(contact->impact.speed, 0.7, 0.0);
    assert_int_equal(contact->joint.onsets, 0);
    const double depth = damping_depth_max(6.6e10, 1.5, 0.0, 0.02, 0.7);
    assert_close(contact->secant, 6.6e10 * sqrt(depth), 1e-6);
    assert_close(contact->tangent, 1.5 * contact->secant, 1e-12);
    assert_near(contact->damping, 0.0, 0.0);
    assert_close(contact->half_period_s, 2.943275 * depth / 0.7, 1e-6);
    mapping_finish(&mapping);
}

static void a_pin_that_lays_itself_on_the_wall_is_mapped_at_the_floor(void **state)
{
    (void)state;
    const Scenario scenario = thrown_pin(1e-4);
    Mapping mapping;
    Err err = {ERR_NONE, ""};
    assert_true(mapping_make(&scenario, &ONE_ROW, (MappingWatch){0}, &mapping, &err));
    assert_int_equal(mapping.contacts[0].speed_source, MAPPING_FLOOR);
    assert_near(mapping.contacts[0].impact.speed, scenario.contact.impact_speed_floor, 0.0);
    mapping_finish(&mapping);
}

static void what_cannot_be_mapped_is_said_so(void **state)
{
    (void)state;
    const Scenario ideal = mechanism_paper();
    Mapping mapping;
    Err err = {ERR_NONE, ""};
    assert_false(mapping_make(&ideal, &ONE_ROW, (MappingWatch){0}, &mapping, &err));
    assert_int_equal(err.kind, ERR_CASE);
    assert_non_null(strstr(err.text, "no joint of the case has play"));
    mapping_finish(&mapping);

    // a pin at rest in the middle meets nothing
    Scenario resting = thrown_pin(0.3);
    resting.linkage.bodies[0].start.velocity.x = 0.0;
    err = (Err){ERR_NONE, ""};
    assert_false(mapping_make(&resting, &ONE_ROW, (MappingWatch){0}, &mapping, &err));
    assert_int_equal(err.kind, ERR_USAGE);
    assert_non_null(strstr(err.text, "--speed"));
    mapping_finish(&mapping);

    // a blow that no law of contact is for
    MappingSettings heavy = ONE_ROW;
    heavy.mass_source = heavy.speed_source = MAPPING_GIVEN;
    heavy.mass = 1e6;
    heavy.speed = 100.0;
    err = (Err){ERR_NONE, ""};
    assert_false(mapping_make(&resting, &heavy, (MappingWatch){0}, &mapping, &err));
    assert_int_equal(err.kind, ERR_SOLVER);
    mapping_finish(&mapping);
}

static void a_bad_setting_is_told_with_what_would_be_right(void **state)
{
    (void)state;
    const Scenario scenario = thrown_pin(0.3);
    MappingSettings settings = ONE_ROW;
    settings.steps[0] = 1e-5;
    Mapping mapping;
    Err err = {ERR_NONE, ""};
    assert_true(mapping_make(&scenario, &settings, (MappingWatch){0}, &mapping, &err));
    const MappingContact *contact = &mapping.contacts[0];
    const MappingRow *row = &mapping.rows[0];
    assert_int_equal(row->verdict, VERDICT_OVER_DAMPED);
    char expected[VERDICT_TEXT_SIZE];
    snprintf(expected, sizeof expected,
             "over-damped: asked %.3g, delivers %.3g; use corrected, or h <= %.3g us",
             contact->asked.restitution, row->predicted.restitution.mean,
             1e6 * contact->largest_s[ODE_MAP_TEXTBOOK]);
    assert_string_equal(row->words, expected);
    mapping_finish(&mapping);
}

// Velocity-level rows: the advised penalty is valid, and half of it is not.
static void the_advised_penalty_is_enough_and_half_of_it_is_not(void **state)
{
    (void)state;
    Scenario scenario = thrown_pin(0.3);
    scenario.contact.model = CONTACT_POISSON;
    scenario.contact.penalty = 1e6;
    MappingContact contact;
    Err err = {ERR_NONE, ""};
    assert_true(
        mapping_contact_make(&scenario, &(MappingJoint){.joint = 0}, 0.1, 0.3, &contact, &err));
    for (double step_s = 1e-7; step_s < 1e-4; step_s *= 10.0) {
        const double least = verdict_least_penalty(&contact, step_s);
        for (int half = 0; half < 2; half++) {
            contact.scenario.contact.penalty = half ? 0.5 * least : least;
            const ImpactFigures figures = mapping_predict(&contact, ODE_MAP_TEXTBOOK, step_s);
            const VerdictKind verdict = verdict_judge(&contact, ODE_MAP_TEXTBOOK, step_s, &figures);
            assert_int_equal(verdict, half ? VERDICT_OVER_DAMPED : VERDICT_VALID);
        }
    }
}

// What a row gives back of an impact of which 0.9 was asked for.
static VerdictKind verdict_of(double restitution)
{
    Scenario scenario = thrown_pin(0.3);
    scenario.contact.damping = DAMPING_EXACT;
    MappingContact contact;
    Err err = {ERR_NONE, ""};
    assert_true(
        mapping_contact_make(&scenario, &(MappingJoint){.joint = 0}, 0.1, 0.3, &contact, &err));
    assert_near(contact.asked.restitution, 0.9, 1e-6);
    MapImpact given = contact.asked;
    given.restitution = restitution;
    const ImpactFigures figures = impact_figures_of(&given);
    return verdict_judge(&contact, ODE_MAP_TEXTBOOK, 1e-3 * contact.half_period_s, &figures);
}

static void what_gives_all_back_gains_nothing(void **state)
{
    (void)state;
    assert_int_equal(verdict_of(0.9), VERDICT_VALID);
    assert_int_equal(verdict_of(0.8), VERDICT_OVER_DAMPED);
    // what rounding may add is no gain
    assert_int_equal(verdict_of(1.0), VERDICT_UNDER_DAMPED);
    assert_int_equal(verdict_of(1.0 + 1e-9), VERDICT_UNDER_DAMPED);
    assert_int_equal(verdict_of(1.0 + 1e-4), VERDICT_GAINS);
}

static void a_row_gives_the_pair_it_was_made_from(void **state)
{
    (void)state;
    Inverse inverse;
    Err err = {ERR_NONE, ""};
    assert_true(inverse_of_pair(1e7, 10.0, 1e-6, &inverse, &err));
    assert_close(inverse.row.erp, 0.5, 1e-15);
    assert_close(inverse.row.cfm, 0.05, 1e-15);
    inverse_add_mass(&inverse, "", 0.1);
    const InverseMass *mass = &inverse.masses[0];
    assert_close(mass->readings[0].stiffness, 1e7, 1e-14);
    assert_close(mass->readings[0].damping, 10.0, 1e-14);
    assert_close(mass->readings[1].damping, 20.0, 1e-14);
    // what ODE gives back is what the row is by the corrected and the exact map; as the textbook
    // reads it, it would be more
    assert_true(mass->delivered.is_measured);
    const double delivered = mass->delivered.figures.restitution.mean;
    assert_close(delivered, mass->predicted.restitution.mean, 1e-6);
    assert_close(delivered, mass->readings[1].restitution, 1e-3);
    assert_close(delivered, mass->readings[2].restitution, 1e-3);
    assert_true(mass->readings[0].restitution > delivered + 5e-3);
    inverse_finish(&inverse);
}

static void rows_that_are_no_spring_and_damper_are_told_apart(void **state)
{
    (void)state;
    Inverse inverse;
    Err err = {ERR_NONE, ""};
    assert_true(inverse_of_row(1.5, 1e-5, 1e-3, &inverse, &err));
    inverse_add_mass(&inverse, "", 0.0);
    assert_false(inverse.masses[0].readings[0].is_there);
    assert_true(inverse.masses[0].readings[1].is_there);
    assert_false(inverse.masses[0].readings[2].is_there); // it needs a mass
    assert_false(inverse.masses[0].delivered.is_measured);
    inverse_finish(&inverse);
    // no spring: the pin stays where it was stopped
    assert_true(inverse_of_row(0.0, 1e-5, 1e-3, &inverse, &err));
    inverse_add_mass(&inverse, "", 1.0);
    assert_near(inverse.masses[0].readings[0].stiffness, 0.0, 0.0);
    assert_false(inverse.masses[0].predicted.is_ended);
    inverse_finish(&inverse);
    assert_false(inverse_of_row(0.2, 0.0, 1e-3, &inverse, &err));
    assert_int_equal(err.kind, ERR_USAGE);
    err = (Err){ERR_NONE, ""};
    assert_false(inverse_of_pair(0.0, 0.0, 1e-3, &inverse, &err));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lone_pin_has_its_own_mass_and_speed),
        cmocka_unit_test(in_a_linkage_the_mass_depends_on_where_it_is_pushed),
        cmocka_unit_test(every_contact_of_the_run_is_counted),
        cmocka_unit_test(what_is_given_is_taken_and_needs_no_run),
        cmocka_unit_test(a_pin_that_lays_itself_on_the_wall_is_mapped_at_the_floor),
        cmocka_unit_test(what_cannot_be_mapped_is_said_so),
        cmocka_unit_test(a_bad_setting_is_told_with_what_would_be_right),
        cmocka_unit_test(the_advised_penalty_is_enough_and_half_of_it_is_not),
        cmocka_unit_test(what_gives_all_back_gains_nothing),
        cmocka_unit_test(a_row_gives_the_pair_it_was_made_from),
        cmocka_unit_test(rows_that_are_no_spring_and_damper_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
