// Is every unit what it says, however it is spelled?
#include "casefile/units.h"

#include "close.h"

#include <string.h>

static double in_si(Dimension dimension, const char *name, double value)
{
    const Unit *unit = units_find(dimension, name);
    assert_non_null(unit);
    assert_int_equal(unit->dimension, dimension);
    return value * unit->numerator / unit->denominator;
}

static void units_convert_to_si(void **state)
{
    (void)state;
    // exact where the decimal number has a nearest double
    assert_true(in_si(DIMENSION_LENGTH, "mm", 279.4) == 0.2794);
    assert_true(in_si(DIMENSION_LENGTH, "um", 14.5) == 14.5e-6);
    assert_true(in_si(DIMENSION_LENGTH, "micron", 14.5) == 14.5e-6);
    assert_true(in_si(DIMENSION_LENGTH, "in", 10.0) == 0.254);
    assert_true(in_si(DIMENSION_INERTIA, "kg mm^2", 173.92) == 173.92e-6);
    assert_true(in_si(DIMENSION_INERTIA, "g mm^2", 1e9) == 1.0);
    assert_true(in_si(DIMENSION_PRESSURE, "GPa", 207.0) == 2.07e11);
    assert_true(in_si(DIMENSION_PRESSURE, "N/mm^2", 2.07e5) == 2.07e11);
    assert_true(in_si(DIMENSION_DAMPING, "N s/mm", 973.33) == 973330.0);
    assert_near(in_si(DIMENSION_TORSION_DISSIPATION, "s/deg", 1.0), 180.0 / M_PI, 1e-14);
    assert_near(in_si(DIMENSION_ANGULAR_SPEED, "rpm", 1000.0), 104.71975511965977, 1e-13);
    assert_near(in_si(DIMENSION_ANGULAR_SPEED, "deg/s", 6000.0), 104.71975511965977, 1e-13);
    assert_near(in_si(DIMENSION_ANGLE, "deg", 180.0), 3.14159265358979312, 0.0);
}

static void si_units_are_in_the_table_with_factor_one(void **state)
{
    (void)state;
    for (int i = DIMENSION_LENGTH; i < DIMENSION_STIFFNESS; i++) {
        const Dimension dimension = (Dimension)i;
        assert_true(in_si(dimension, units_si(dimension), 1.0) == 1.0);
    }
    assert_string_equal(units_si(DIMENSION_NONE), "");
}

static void spellings_come_down_to_one(void **state)
{
    (void)state;
    static const char *const PAIRS[][2] = {
        {"  mm ", "mm"},
        {"\u00b5m", "um"},
        {"\u03bcs", "us"},
        {"kg   mm^2", "kg mm^2"},
        {"kg\u00b7mm\u00b2", "kg mm^2"},
        {"kg*mm^2", "kg mm^2"},
        {"N\ts/m", "N s/m"},
        {"", ""},
    };
    for (size_t i = 0; i < sizeof PAIRS / sizeof PAIRS[0]; i++) {
        char name[UNITS_NAME_SIZE];
        units_normalise(PAIRS[i][0], name);
        assert_string_equal(name, PAIRS[i][1]);
    }
    char name[UNITS_NAME_SIZE];
    units_normalise("a unit that is far too long to be one of any dimension", name);
    assert_true(strlen(name) < UNITS_NAME_SIZE);
}

static void a_unit_of_another_dimension_is_told_apart(void **state)
{
    (void)state;
    assert_int_equal(units_find(DIMENSION_LENGTH, "kg")->dimension, DIMENSION_MASS);
    assert_null(units_find(DIMENSION_LENGTH, "furlong"));
}

static void the_nearest_unit_is_suggested(void **state)
{
    (void)state;
    assert_string_equal(units_nearest(DIMENSION_INERTIA, "kg mm2"), "kg mm^2");
    assert_string_equal(units_nearest(DIMENSION_LENGTH, "nm"), "mm");
    assert_string_equal(units_nearest(DIMENSION_LENGTH, "microns"), "micron");
    assert_null(units_nearest(DIMENSION_ANGULAR_SPEED, "Hz"));
    assert_null(units_nearest(DIMENSION_LENGTH, "x"));
}

static void every_dimension_has_words_and_units(void **state)
{
    (void)state;
    for (int i = DIMENSION_LENGTH; i < DIMENSION_COUNT; i++) {
        Text list;
        text_init(&list);
        units_list((Dimension)i, &list);
        assert_true(list.length > 0);
        assert_true(strlen(units_dimension_name((Dimension)i)) > 0);
        assert_true(strlen(units_example((Dimension)i)) > 0);
        text_finish(&list);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units_convert_to_si),
        cmocka_unit_test(si_units_are_in_the_table_with_factor_one),
        cmocka_unit_test(spellings_come_down_to_one),
        cmocka_unit_test(a_unit_of_another_dimension_is_told_apart),
        cmocka_unit_test(the_nearest_unit_is_suggested),
        cmocka_unit_test(every_dimension_has_words_and_units),
    };
    return cmocka_run_group_tests_name("units", tests, NULL, NULL);
}
