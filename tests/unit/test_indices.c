// Are Sobol's indices of a study those of a function whose indices are known?
#include "close.h"
#include "commands/study/design.h"
#include "commands/study/indices.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

enum { INPUTS = 3, BASE = 4096 };

static Spec sobol_spec(uint64_t base)
{
    Spec spec = {.method = DRAW_SOBOL, .draw_base = base, .draws = base * (INPUTS + 2), .seed = 3};
    static const char *const KEYS[INPUTS] = {"a", "b", "c"};
    for (size_t i = 0; i < INPUTS; i++) {
        Variable *variable = &spec.variables[spec.variable_count++];
        *variable = (Variable){.is_drawn = true, .kind = VARIABLE_UNIFORM, .low = -PI, .high = PI};
        snprintf(variable->key, sizeof variable->key, "%s", KEYS[i]);
    }
    return spec;
}

static double drawn(const Spec *spec, size_t input, uint64_t draw)
{
    const Variable *variable = &spec->variables[input];
    return draw_value(variable, draw_variable_share(spec, variable, draw));
}

// Ishigami and Homma (1990) with a = 7, b = 0.1: all of it is known.
static double ishigami(const double x[INPUTS])
{
    return sin(x[0]) + 7.0 * pow(sin(x[1]), 2.0) + 0.1 * pow(x[2], 4.0) * sin(x[0]);
}

static double *ishigami_runs(const Spec *spec)
{
    double *results = calloc(spec->draws, sizeof *results);
    for (uint64_t draw = 0; draw < spec->draws; draw++) {
        const double x[INPUTS] = {drawn(spec, 0, draw), drawn(spec, 1, draw), drawn(spec, 2, draw)};
        results[draw] = ishigami(x);
    }
    return results;
}

static void each_sample_has_one_input_of_the_second(void **state)
{
    (void)state;
    const Spec spec = sobol_spec(16);
    for (uint64_t draw = 0; draw < 16; draw++) {
        for (size_t input = 0; input < INPUTS; input++) {
            const double first = drawn(&spec, input, draw);
            const double second = drawn(&spec, input, 16 + draw);
            assert_true(first != second);
            for (size_t sample = 0; sample < INPUTS; sample++) {
                const double there = drawn(&spec, input, (2 + sample) * 16 + draw);
                assert_true(there == (sample == input ? second : first));
            }
        }
    }
}

static void ishigamis_indices_are_found(void **state)
{
    (void)state;
    // V = a^2/8 + b pi^4/5 + b^2 pi^8/18 + 1/2, V_1 = (1 + b pi^4/5)^2 / 2, V_2 = a^2/8,
    // V_13 = 8 b^2 pi^8 / 225
    const double b4 = 0.1 * pow(PI, 4.0);
    const double variance = 49.0 / 8.0 + b4 / 5.0 + b4 * b4 / 18.0 + 0.5;
    const double one = 0.5 * pow(1.0 + b4 / 5.0, 2.0) / variance;
    const double two = 49.0 / 8.0 / variance;
    const double both = 8.0 * b4 * b4 / 225.0 / variance;
    const double first[INPUTS] = {one, two, 0.0};
    const double total[INPUTS] = {one + both, two, both};
    const Spec spec = sobol_spec(BASE);
    double *results = ishigami_runs(&spec);
    Indices found;
    assert_true(indices_find(results, BASE, INPUTS, &found));
    assert_int_equal(found.used, BASE);
    assert_close(found.variance, variance, 0.03);
    for (size_t i = 0; i < INPUTS; i++) {
        // the intervals are some 0.02 to 0.04 to each side
        assert_near(found.first[i].value, first[i], 0.05);
        assert_near(found.total[i].value, total[i], 0.05);
        assert_true(found.first[i].low < found.first[i].high);
        assert_true(found.first[i].high - found.first[i].low < 0.15);
        assert_true(found.total[i].low - 0.02 < total[i] && total[i] < found.total[i].high + 0.02);
    }
    // the control: the samples of two inputs exchanged
    double *exchanged = calloc(spec.draws, sizeof *exchanged);
    memcpy(exchanged, results, spec.draws * sizeof *exchanged);
    memcpy(exchanged + 2 * BASE, results + 4 * BASE, BASE * sizeof *exchanged);
    memcpy(exchanged + 4 * BASE, results + 2 * BASE, BASE * sizeof *exchanged);
    Indices wrong;
    assert_true(indices_find(exchanged, BASE, INPUTS, &wrong));
    assert_true(fabs(wrong.first[0].value - first[0]) > 0.2);
    free(exchanged);
    free(results);
}

// Draws with a run that failed are left out whole; of few, or of a result that does not vary, none.
static void draws_without_a_result_are_left_out(void **state)
{
    (void)state;
    const Spec spec = sobol_spec(BASE);
    double *results = ishigami_runs(&spec);
    results[3 * BASE + 17] = NAN;
    results[BASE + 18] = NAN;
    Indices found;
    assert_true(indices_find(results, BASE, INPUTS, &found));
    assert_int_equal(found.used, BASE - 2);
    assert_near(found.first[1].value, 0.4424, 0.05);
    assert_false(indices_find(results, 7, INPUTS, &found));
    for (uint64_t draw = 0; draw < spec.draws; draw++) {
        results[draw] = 5.0;
    }
    assert_false(indices_find(results, BASE, INPUTS, &found));
    free(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_sample_has_one_input_of_the_second),
        cmocka_unit_test(ishigamis_indices_are_found),
        cmocka_unit_test(draws_without_a_result_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
