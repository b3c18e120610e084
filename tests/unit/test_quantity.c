// Are numbers, quantities and tolerances read as written, and everything else refused?
#include "casefile/tolerance.h"

#include "close.h"

#include <stdio.h>
#include <string.h>

static void numbers_are_decimal_and_nothing_else(void **state)
{
    (void)state;
    Complaint complaint;
    double value = 0.0;
    assert_true(quantity_number(" -1.5e3 ", &value, &complaint));
    assert_true(value == -1500.0);
    assert_true(quantity_number(".5", &value, &complaint));
    assert_true(value == 0.5);
    assert_true(quantity_number("5.", &value, &complaint));
    assert_true(value == 5.0);

    static const char *const WRONG[] = {
        "",    "-",   ".",   "e5",  "nan",   "inf",   "infinity", "0x10", "0x1p3",
        "1e",  "1e+", "1,5", "1 2", "1.2.3", "1e999", "1e-999",   "--1",  "1_000",
        "one", "+-1", "1f",  "NaN", "-inf",  ".nan",  "\u00bd",
    };
    for (size_t i = 0; i < sizeof WRONG / sizeof WRONG[0]; i++) {
        value = 42.0;
        assert_false(quantity_number(WRONG[i], &value, &complaint));
        assert_true(value == 42.0);
        assert_true(strlen(complaint.text) > 0);
        assert_true(strlen(complaint.allowed) > 0);
    }
}

static void whole_numbers_may_be_written_with_a_power(void **state)
{
    (void)state;
    Complaint complaint;
    size_t value = 7;
    assert_true(quantity_integer("1e6", &value, &complaint));
    assert_int_equal(value, 1000000);
    assert_true(quantity_integer("0", &value, &complaint));
    assert_int_equal(value, 0);
    static const char *const WRONG[] = {"-1", "1.5", "1e17", "x", "3 m"};
    for (size_t i = 0; i < sizeof WRONG / sizeof WRONG[0]; i++) {
        assert_false(quantity_integer(WRONG[i], &value, &complaint));
        assert_int_equal(value, 0);
    }
}

static void quantities_need_a_unit_of_their_dimension(void **state)
{
    (void)state;
    Complaint complaint;
    double value = 0.0;
    assert_true(quantity_parse("254 mm", DIMENSION_LENGTH, &value, &complaint));
    assert_true(value == 0.254);
    assert_true(quantity_parse("254mm", DIMENSION_LENGTH, &value, &complaint));
    assert_true(quantity_parse("1 \u00b5s", DIMENSION_TIME, &value, &complaint));
    assert_true(value == 1e-6);
    assert_true(quantity_parse("0.9", DIMENSION_NONE, &value, &complaint));

    // 0 is the same in every unit; every dimension has one that it is read in
    for (Dimension dimension = DIMENSION_LENGTH; dimension < DIMENSION_STIFFNESS; dimension++) {
        double zero = 1.0;
        const Unit *unit = NULL;
        assert_true(quantity_parse_unit("0", dimension, &zero, &unit, &complaint));
        assert_true(zero == 0.0);
        assert_int_equal(unit->dimension, dimension);
    }
    assert_true(quantity_parse("-0.0", DIMENSION_LENGTH, &value, &complaint));
    value = 0.9;
    assert_false(quantity_parse("1e-300", DIMENSION_LENGTH, &value, &complaint));
    assert_false(quantity_parse("254", DIMENSION_LENGTH, &value, &complaint));
    assert_string_equal(complaint.text, "'254' has no unit");
    assert_false(quantity_parse("254 kg", DIMENSION_LENGTH, &value, &complaint));
    assert_string_equal(complaint.text, "expected a length such as 254 mm; 'kg' is a mass");
    assert_false(quantity_parse("254 rmp", DIMENSION_ANGULAR_SPEED, &value, &complaint));
    assert_string_equal(complaint.text, "unknown unit 'rmp'; did you mean 'rpm'?");
    assert_false(quantity_parse("1e308 MPa", DIMENSION_PRESSURE, &value, &complaint));
    assert_false(quantity_parse("mm", DIMENSION_LENGTH, &value, &complaint));
    assert_false(quantity_parse("1,5 mm", DIMENSION_LENGTH, &value, &complaint));
    assert_string_equal(complaint.text, "a number has a decimal point, not a comma");
    assert_true(value == 0.9);
}

// A length as a case file has it, with its limits in m.
static bool read_length(const char *text, ToleratedLength *length, Complaint *complaint)
{
    Tolerated read;
    char number[QUANTITY_TEXT_SIZE];
    double nominal;
    double unit;
    if (!tolerance_read(schema_find("four-bar.crank.length"), text, &read, complaint)) {
        return false;
    }
    snprintf(number, sizeof number, "%.17g %s", read.nominal, read.unit);
    if (!quantity_parse(read.is_there ? number : text, DIMENSION_LENGTH, &nominal, complaint)) {
        return false;
    }
    *length = (ToleratedLength){.nominal = nominal};
    if (read.is_there) {
        unit = nominal / read.nominal;
        length->lower = unit * read.lower;
        length->upper = unit * read.upper;
    }
    return true;
}

static void tolerances_have_many_spellings(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double lower; // um
        double upper; // um
    } CASES[] = {
        {"108 mm", 0.0, 0.0},
        {"+108 mm", 0.0, 0.0},
        {"1.08e+2 mm", 0.0, 0.0},
        {"108 +- 0.3 mm", -300.0, 300.0},
        {"108 +/- 0.3 mm", -300.0, 300.0},
        {"108 \u00b1 0.3 mm", -300.0, 300.0},
        {"108 mm \u00b10.3 mm", -300.0, 300.0},
        {"108 mm +- 300 um", -300.0, 300.0},
        {"108 +0.015/-0 mm", 0.0, 15.0},
        {"108 mm +0.1/-0.2 mm", -200.0, 100.0},
        {"1.08e+2 +1e-1/-2e-1 mm", -200.0, 100.0},
        {"10.8 cm +- 0.3 mm", -300.0, 300.0},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        Complaint complaint;
        ToleratedLength length;
        assert_true(read_length(CASES[i].text, &length, &complaint));
        assert_near(length.nominal, 0.108, 1e-16);
        assert_near(length.lower, 1e-6 * CASES[i].lower, 1e-16);
        assert_near(length.upper, 1e-6 * CASES[i].upper, 1e-16);
    }
}

static void wrong_tolerances_are_refused(void **state)
{
    (void)state;
    static const char *const WRONG[] = {
        "108",           "108 +- mm",         "108 +- 0.3",     "108 mm +0.3 mm",
        "108 +-",        "108 +0.1/+0.05 mm", "108 +- -0.3 mm", "108 kg +- 0.3 mm",
        "x +- 0.3 mm",   "108 mm +0.1/- mm",  "108 +- 0.3 kg",  "108 mm -0.1/+0.1 mm",
        "1e308 +- 1 in", "108 +1/x mm",
    };
    for (size_t i = 0; i < sizeof WRONG / sizeof WRONG[0]; i++) {
        Complaint complaint;
        ToleratedLength length = {.nominal = 42.0};
        assert_false(read_length(WRONG[i], &length, &complaint));
        assert_true(length.nominal == 42.0);
        assert_true(strlen(complaint.text) > 0);
    }
}

static void the_unit_of_a_stiffness_gives_its_exponent(void **state)
{
    (void)state;
    Complaint complaint;
    double stiffness = 0.0;
    double exponent = 0.0;
    assert_true(quantity_stiffness("6.6e10 N/m^1.5", DIMENSION_STIFFNESS, &stiffness, &exponent,
                                   &complaint));
    assert_true(stiffness == 6.6e10 && exponent == 1.5);
    assert_true(
        quantity_stiffness("2e7 N/m", DIMENSION_STIFFNESS, &stiffness, &exponent, &complaint));
    assert_true(stiffness == 2e7 && exponent == 1.0);
    assert_true(
        quantity_stiffness("2e4 N/mm", DIMENSION_STIFFNESS, &stiffness, &exponent, &complaint));
    assert_true(stiffness == 2e7 && exponent == 1.0);
    // F = K d^n with d = 1 m = 1000 mm: 1 N/mm^1.5 is 1000^1.5 N/m^1.5
    assert_true(
        quantity_stiffness("1 N/mm^1.5", DIMENSION_STIFFNESS, &stiffness, &exponent, &complaint));
    assert_close(stiffness, 31622.776601683792, 1e-15);
    assert_true(exponent == 1.5);

    static const char *const WRONG[] = {"6.6e10",       "6.6e10 N/m^", "6.6e10 N/m^x", "1 N/m^0.5",
                                        "1 N/m^4",      "x N/m",       "1 kg",         "1 N/mm^2",
                                        "1e308 N/mm^3", "1 N/kg^2",    "1 N/m^n"};
    for (size_t i = 0; i < sizeof WRONG / sizeof WRONG[0]; i++) {
        assert_false(
            quantity_stiffness(WRONG[i], DIMENSION_STIFFNESS, &stiffness, &exponent, &complaint));
        assert_true(exponent == 1.5);
        assert_true(strlen(complaint.text) > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_decimal_and_nothing_else),
        cmocka_unit_test(whole_numbers_may_be_written_with_a_power),
        cmocka_unit_test(quantities_need_a_unit_of_their_dimension),
        cmocka_unit_test(tolerances_have_many_spellings),
        cmocka_unit_test(wrong_tolerances_are_refused),
        cmocka_unit_test(the_unit_of_a_stiffness_gives_its_exponent),
    };
    return cmocka_run_group_tests_name("quantity", tests, NULL, NULL);
}
