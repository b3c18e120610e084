// Is a stiffness that is given by a depth at a force the one that bears this force there?
#include "load_case.h"

#include "casefile/stiffness_for.h"
#include "contact/law.h"

static const char PIN[] = "cases/paper/impact-k66.yaml";

static void it_bears_the_force_at_the_depth(void **state)
{
    (void)state;
    static const struct {
        const char *words;
        double depth;
        double force;
        double exponent;
    } GIVEN[] = {
        {"contact.stiffness-for=0.1 mm at 500 N", 1e-4, 500.0, 1.0},
        {"contact.stiffness-for=5 um at 1.2 kN with exponent 1.5", 5e-6, 1200.0, 1.5},
        {"joints.crank-coupler.stiffness-for=20 um at 80 N with exponent 2", 2e-5, 80.0, 2.0},
    };
    for (size_t i = 0; i < sizeof GIVEN / sizeof *GIVEN; i++) {
        const Scenario scenario = load_with(PIN, GIVEN[i].words);
        const ContactOptions own = law_options(&scenario.contact, &scenario.linkage.joints[1]);
        const double force = own.stiffness * pow(GIVEN[i].depth, own.exponent);
        assert_near(force / GIVEN[i].force, 1.0, 1e-15);
        assert_near(own.exponent, GIVEN[i].exponent, 0.0);
        // half of the depth does not have the force
        assert_true(own.stiffness * pow(0.5 * GIVEN[i].depth, own.exponent) < 0.6 * force);
    }
}

static void of_an_angle_it_is_a_torque(void **state)
{
    (void)state;
    StiffnessFor read;
    Complaint complaint;
    assert_true(stiffness_for_read("0.2 deg at 3 N m", true, &read, &complaint));
    assert_near(read.depth, 0.2 * M_PI / 180.0, 1e-18);
    assert_near(read.force, 3.0, 0.0);
    assert_false(stiffness_for_read("0.2 deg at 3 N m", false, &read, &complaint));
    assert_false(stiffness_for_read("0.2 mm at 3 N", true, &read, &complaint));
}

// A stiffness on the command line takes the place of it, and the other way round.
static void a_stiffness_beside_it_is_its_rival(void **state)
{
    (void)state;
    const char *const overrides[] = {"contact.stiffness-for=0.1 mm at 500 N",
                                     "contact.stiffness=1e7 N/m"};
    Scenario scenario = load(PIN, overrides, 2);
    assert_near(scenario.contact.stiffness, 1e7, 0.0);
    assert_near(scenario.contact.for_depth, 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_bears_the_force_at_the_depth),
        cmocka_unit_test(of_an_angle_it_is_a_torque),
        cmocka_unit_test(a_stiffness_beside_it_is_its_rival),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
