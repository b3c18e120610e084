// Has a number for people no more digits than its interval leaves it?
#include "write/units.h"

#include "close.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Shown {
    double value;
    double low;
    double high;
    const char *unit;
    const char *words;
} Shown;

static void an_interval_leaves_its_first_digit(void **state)
{
    (void)state;
    static const Shown ALL[] = {
        {3412.0, 3230.0, 3590.0, "N", "3.4 kN (3.2 to 3.6)"},
        {3412.0, 3408.0, 3416.0, "N", "3.41 kN (3.40 to 3.42)"},
        {1171.0, 1060.0, 1290.0, "N", "1.2 kN (1.0 to 1.3)"},
        {503.0, 430.0, 560.0, "N", "500 N (430 to 560)"},
        {968.0, 901.0, 1010.0, "N", "970 N (900 to 1010)"},
        {0.33329, 0.3330, 0.3335, "N", "333 mN (333 to 334)"},
        // three digits where the interval would leave more, one where it leaves none
        {3412.3, 3412.2, 3412.4, "N", "3.41 kN (3.41 to 3.42)"},
        {900.0, 100.0, 4000.0, "N", "900 N (100 to 4000)"},
        // no interval
        {2682.0, 2682.0, 2682.0, "N", "2.68 kN"},
        {0.0, 0.0, 0.0, "N", "0.00 N"},
        // smaller than any prefix
        {3e-16, 3e-16, 3e-16, "rad/s^2", "0.00 prad/s^2"},
        // too few revolutions for an upper end
        {3412.0, 3230.0, INFINITY, "N", "at least 3.23 kN"},
    };
    for (size_t i = 0; i < sizeof ALL / sizeof *ALL; i++) {
        Text text;
        text_init(&text);
        units_append_interval(&text, ALL[i].value, ALL[i].low, ALL[i].high, ALL[i].unit);
        assert_string_equal(text.data, ALL[i].words);
        text_finish(&text);
    }
}

// The ends that are shown hold the interval between them. The control: the same ends rounded to the
// nearest of their digits would not.
static void the_shown_interval_holds_the_interval(void **state)
{
    (void)state;
    int missed = 0;
    for (int i = 0; i < 1000; i++) {
        const double value = 100.0 + 0.73 * i;
        const double low = value * (1.0 - 0.0001 * (1 + i % 97));
        const double high = value * (1.0 + 0.0001 * (1 + i % 89));
        Text text;
        text_init(&text);
        units_append_interval(&text, value, low, high, "N");
        double shown;
        double from;
        double to;
        assert_int_equal(sscanf(text.data, "%lf N (%lf to %lf)", &shown, &from, &to), 3);
        assert_true(from <= low + 1e-6 && to >= high - 1e-6);
        const char *digits = strchr(text.data, '(');
        const char *point = strchr(digits, '.');
        const int decimals = point == NULL ? 0 : (int)strcspn(point + 1, " ");
        char nearest[32];
        snprintf(nearest, sizeof nearest, "%.*f", decimals, low);
        missed += strtod(nearest, NULL) > low ? 1 : 0;
        text_finish(&text);
    }
    assert_true(missed > 0);
}

static void a_column_beside_another_has_its_prefix(void **state)
{
    (void)state;
    Text text;
    text_init(&text);
    units_append_beside(&text, 503.0, 450.0, 560.0, 1171.0, 1060.0, 1290.0);
    text_append(&text, " ");
    units_append_beside(&text, 3392.0, 3392.0, 3392.0, 1171.0, 1060.0, 1290.0);
    text_append(&text, " ");
    units_append_beside(&text, 503.0, 450.0, 560.0, 968.0, 901.0, 1010.0);
    text_append(&text, " ");
    units_append_digits(&text, 45.23, 43.1, 47.9);
    assert_string_equal(text.data, "0.50 3.39 500 45");
    text_finish(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_interval_leaves_its_first_digit),
        cmocka_unit_test(the_shown_interval_holds_the_interval),
        cmocka_unit_test(a_column_beside_another_has_its_prefix),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
