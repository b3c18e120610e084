// Does the penalty estimate reproduce the paper's single equation, by its own units and in SI?
#include "close.h"

#include "contact/penalty.h"

static double rad_per_s(double rpm)
{
    return rpm / 30.0 * acos(-1.0);
}

static void the_effective_modulus_is_that_of_the_papers_steel(void **state)
{
    (void)state;
    const MaterialOptions steel = material_options_default();
    assert_near(penalty_effective_modulus(&steel) * 1e-6, 113003.6, 0.05); // N/mm^2
}

static void the_force_is_table_1_at_1000_rpm_and_goes_with_the_square_of_the_speed(void **state)
{
    (void)state;
    const PenaltyReading reading = penalty_reading_of_tables();
    const double coupler = penalty_force(&reading, 11970.0, rad_per_s(1000.0));
    assert_near(coupler, 1.051416, 1e-5);
    assert_near(penalty_force(&reading, 12484.0, rad_per_s(1000.0)), 1.0966, 1e-4);
    assert_close(penalty_force(&reading, 11970.0, rad_per_s(-300.0)), 0.09 * coupler, 1e-14);
    assert_close(penalty_force(&reading, -11970.0, rad_per_s(1000.0)), coupler, 1e-15);
}

static void the_printed_penalty_is_the_papers_single_equation(void **state)
{
    (void)state;
    const MaterialOptions steel = material_options_default();
    const PenaltyReading reading = penalty_reading_of_tables();
    const double modulus = penalty_effective_modulus(&steel);
    for (double rpm = 100.0; rpm <= 1500.0; rpm += 100.0) {
        const double force = penalty_force(&reading, reading.alpha_at_1000, rad_per_s(rpm));
        assert_near(penalty_printed(&reading, modulus, force), 0.97333 * rpm, 6e-6 * rpm);
    }
    assert_close(penalty_printed(&reading, modulus, 1.0), 949.2303, 1e-6);
    // control: the exponent the text gives, 1.5, is five times off
    PenaltyReading text = reading;
    text.exponent = 1.5;
    const double ratio =
        penalty_printed(&text, modulus, 1.0) / penalty_printed(&reading, modulus, 1.0);
    assert_close(ratio, sqrt(0.042), 1e-12);
}

static void the_velocity_level_penalty_is_the_printed_number_a_thousand_times(void **state)
{
    (void)state;
    const MaterialOptions steel = material_options_default();
    assert_near(penalty_velocity_level(973.33), 973330.0, 1e-6); // 1 N s/mm = 1000 N s/m
    assert_close(penalty_estimate(rad_per_s(1000.0), &steel), 973330.0, 1e-5);
    assert_close(penalty_estimate(rad_per_s(-1500.0), &steel), 1459990.0, 1e-5);
}

static void stiffness_is_twice_radius_times_modulus(void **state)
{
    (void)state;
    const PenaltyReading reading = penalty_reading_of_tables();
    assert_close(penalty_contact_radius(&reading, 4.0), 0.2e-3, 1e-14);
    assert_close(penalty_stiffness(&reading, 1e11, 4.0), 2.0 * 0.2e-3 * 1e11, 1e-14);
}

static void the_mutual_approach_is_hertz_with_the_three_quarters_outside(void **state)
{
    (void)state;
    const MaterialOptions steel = material_options_default();
    const PenaltyReading reading = penalty_reading_of_tables();
    const double modulus = penalty_effective_modulus(&steel);
    const double delta = penalty_approach(&reading, modulus, 1.051416);
    assert_near(delta * 1e6, 0.1940, 5.1e-5);
    // Hertz's sphere of 5 mm on a plane gives a tenth more: the control
    const double hertz = pow(0.75 * 1.051416 / (modulus * sqrt(5e-3)), 2.0 / 3.0);
    assert_near(hertz * 1e6, 0.2136, 1e-4);
    // and a sphere of 20/3 mm gives the paper's number
    assert_close(pow(0.75 * 1.051416 / (modulus * sqrt(20e-3 / 3.0)), 2.0 / 3.0), delta, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_effective_modulus_is_that_of_the_papers_steel),
        cmocka_unit_test(the_force_is_table_1_at_1000_rpm_and_goes_with_the_square_of_the_speed),
        cmocka_unit_test(the_printed_penalty_is_the_papers_single_equation),
        cmocka_unit_test(the_velocity_level_penalty_is_the_printed_number_a_thousand_times),
        cmocka_unit_test(stiffness_is_twice_radius_times_modulus),
        cmocka_unit_test(the_mutual_approach_is_hertz_with_the_three_quarters_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
