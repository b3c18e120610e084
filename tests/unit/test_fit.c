// Are fits the limits that ISO 286 has for them?
//
// The truth of the tables is the standard's own formulas, which give them but for rounding, and the
// limits of fits as handbooks print them. The control is the table of the next step of sizes.
#include "casefile/fit.h"
#include "close.h"

#include <stdio.h>
#include <string.h>

// Limits as deviations from the nominal size, um.
static void limits_of(const char *text, bool is_hole, double nominal_mm, double *low, double *high)
{
    FitLimits limits;
    Complaint complaint = {.text = ""};
    if (!fit_read(text, is_hole, &limits, &complaint)) {
        fail_msg("%s: %s", text, complaint.text);
    }
    *low = 1e3 * (limits.low - nominal_mm);
    *high = 1e3 * (limits.high - nominal_mm);
}

static void fits_are_those_of_handbooks(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool is_hole;
        double size; // mm
        double low;  // um
        double high;
    } KNOWN[] = {
        {"30 H7/g6", true, 30.0, 0.0, 21.0},       {"30 H7/g6", false, 30.0, -20.0, -7.0},
        {"25 mm H7", true, 25.0, 0.0, 21.0},       {"25 f7", false, 25.0, -41.0, -20.0},
        {"10 h6", false, 10.0, -9.0, 0.0},         {"50 H8", true, 50.0, 0.0, 39.0},
        {"50 e8", false, 50.0, -89.0, -50.0},      {"40 k6", false, 40.0, 2.0, 18.0},
        {"40 n6", false, 40.0, 17.0, 33.0},        {"40 p6", false, 40.0, 26.0, 42.0},
        {"20 m6", false, 20.0, 8.0, 21.0},         {"60 js6", false, 60.0, -9.5, 9.5},
        {"60 JS7", true, 60.0, -15.0, 15.0},       {"100 F8", true, 100.0, 36.0, 90.0},
        {"16 G7", true, 16.0, 6.0, 24.0},          {"200 d9", false, 200.0, -285.0, -170.0},
        {"500 H11", true, 500.0, 0.0, 400.0},      {"3 g5", false, 3.0, -6.0, -2.0},
        {"12.7 H9/d9", false, 12.7, -93.0, -50.0},
    };
    for (size_t i = 0; i < sizeof KNOWN / sizeof *KNOWN; i++) {
        double low;
        double high;
        limits_of(KNOWN[i].text, KNOWN[i].is_hole, KNOWN[i].size, &low, &high);
        assert_near(low, KNOWN[i].low, 1e-6);
        assert_near(high, KNOWN[i].high, 1e-6);
    }
}

// i = 0.45 D^(1/3) + 0.001 D, D the geometric mean of the ends of the step, 3 mm and below as from
// 1 mm. The standard rounds by 5 % or half a micrometre, and by twice that where a step is small.
static void grades_follow_their_formula(void **state)
{
    (void)state;
    static const double ENDS[] = {1, 3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500};
    static const double TIMES[] = {7, 10, 16, 25, 40, 64, 100, 160};
    size_t close = 0;
    size_t close_to_next = 0;
    for (size_t step = 0; step < 13; step++) {
        const double mean = sqrt(ENDS[step] * ENDS[step + 1]);
        const double unit = 0.45 * cbrt(mean) + 0.001 * mean;
        for (int grade = 5; grade <= 12; grade++) {
            char text[32];
            double low;
            double high;
            snprintf(text, sizeof text, "%g H%d", ENDS[step + 1], grade);
            limits_of(text, true, ENDS[step + 1], &low, &high);
            const double formula = TIMES[grade - 5] * unit;
            assert_near(low, 0.0, 1e-9);
            // that of the smallest sizes is rounded up
            assert_near(high, formula, step == 0 ? 0.16 * formula : fmax(0.05 * formula, 1.0));
            close += fabs(high - formula) <= 0.05 * formula ? 1 : 0;
            if (step + 1 < 13) {
                snprintf(text, sizeof text, "%g H%d", ENDS[step + 2], grade);
                limits_of(text, true, ENDS[step + 2], &low, &high);
                close_to_next += fabs(high - formula) <= 0.05 * formula ? 1 : 0;
            }
        }
    }
    assert_true(close > 90);
    assert_true(close_to_next < 10);
}

// es of d, e, f, g: -16 D^0.44, -11 D^0.41, -5.5 D^0.41, -2.5 D^0.34; ei of n 5 D^0.34.
static void letters_follow_their_formulas(void **state)
{
    (void)state;
    static const double ENDS[] = {1, 3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500};
    static const struct {
        char letter;
        double factor;
        double power;
    } FORMULAS[] = {
        {'d', 16.0, 0.44}, {'e', 11.0, 0.41}, {'f', 5.5, 0.41}, {'g', 2.5, 0.34}, {'n', 5.0, 0.34},
    };
    for (size_t i = 0; i < sizeof FORMULAS / sizeof *FORMULAS; i++) {
        for (size_t step = FORMULAS[i].letter == 'n' ? 1 : 0; step < 13; step++) {
            char text[32];
            double low;
            double high;
            const double mean = sqrt(ENDS[step] * ENDS[step + 1]);
            const double formula = FORMULAS[i].factor * pow(mean, FORMULAS[i].power);
            snprintf(text, sizeof text, "%g %c7", ENDS[step + 1], FORMULAS[i].letter);
            limits_of(text, false, ENDS[step + 1], &low, &high);
            const double deviation = FORMULAS[i].letter == 'n' ? low : -high;
            assert_near(deviation, formula, fmax(0.05 * formula, 1.2));
        }
    }
}

static void what_is_no_fit_is_refused_by_name(void **state)
{
    (void)state;
    assert_true(fit_is("30 H7"));
    assert_true(fit_is_of_both("30 H7/g6"));
    assert_false(fit_is_of_both("30 H7"));
    static const char *const NONE[] = {"30 mm", "30 m",   "30",          "H7",
                                       "30 H",  "30 H7/", "30 H7/g6/h6", "30 +- 1 mm"};
    for (size_t i = 0; i < sizeof NONE / sizeof *NONE; i++) {
        assert_false(fit_is(NONE[i]));
    }
    static const struct {
        const char *text;
        bool is_hole;
        const char *named;
    } WRONG[] = {
        {"30 K7", true, "K7"},  {"30 zc6", false, "zc6"}, {"30 H4", true, "H4"},
        {"30 k8", false, "k8"}, {"501 H7", true, "H7"},   {"30 h6", true, "h6"},
        {"30 H7", false, "H7"}, {"0 H7", true, "H7"},     {"30 c9", false, "c9"},
    };
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        FitLimits limits = {42.0, 42.0};
        Complaint complaint = {.text = ""};
        assert_false(fit_read(WRONG[i].text, WRONG[i].is_hole, &limits, &complaint));
        assert_true(limits.low == 42.0);
        assert_non_null(strstr(complaint.text, WRONG[i].named));
        assert_true(strlen(complaint.allowed) > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fits_are_those_of_handbooks),
        cmocka_unit_test(grades_follow_their_formula),
        cmocka_unit_test(letters_follow_their_formulas),
        cmocka_unit_test(what_is_no_fit_is_refused_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
