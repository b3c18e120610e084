// Are draws distributed as they say, spread as a Latin hypercube is, and independent?
//
// Seeds are fixed: a test that passes passes always. Bounds are those that true randomness breaks
// with a chance of 1e-6 or less.
#include "commands/study/design.h"

#include "close.h"

#include "commands/study/normal.h"

#include <stdlib.h>
#include <string.h>

enum { DRAWS = 20000 };

// A Kolmogorov-Smirnov distance of n draws is above this with a chance of 1e-6 (Dvoretzky, Kiefer
// and Wolfowitz, with Massart's constant): sqrt(ln(2 / 1e-6) / (2 n)).
static const double KS_LEVEL = 1e-6;
// Deviations that a normal variable exceeds with a chance of 6e-7.
static const double FIVE_DEVIATIONS = 5.0;

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

static Spec make_drawn_spec(DrawMethod method, uint64_t draws, uint64_t seed)
{
    return (Spec){.draws = draws, .method = method, .seed = seed};
}

static Variable make_variable(const char *key, VariableKind kind, double low, double high)
{
    Variable variable = {.kind = kind, .is_drawn = true, .low = low, .high = high};
    strcpy(variable.key, key);
    return variable;
}

static void draw_all(const Spec *spec, const Variable *variable, double *values)
{
    for (uint64_t i = 0; i < spec->draws; i++) {
        values[i] = draw_value(variable, draw_variable_share(spec, variable, i));
    }
}

typedef double (*Below)(const Variable *variable, double value);

static double below_uniform(const Variable *variable, double value)
{
    return (value - variable->low) / (variable->high - variable->low);
}

static double below_log_uniform(const Variable *variable, double value)
{
    return log(value / variable->low) / log(variable->high / variable->low);
}

static double below_normal(const Variable *variable, double value)
{
    const double low = (variable->low - variable->centre) / variable->deviation;
    const double high = (variable->high - variable->centre) / variable->deviation;
    const double z = (value - variable->centre) / variable->deviation;
    return 0.5 * (erfc(-z / sqrt(2.0)) - erfc(-low / sqrt(2.0))) / normal_between(low, high);
}

static double below_triangular(const Variable *variable, double value)
{
    const double width = variable->high - variable->low;
    const double up = value - variable->low;
    const double down = variable->high - value;
    return value <= variable->centre
               ? up * up / (width * (variable->centre - variable->low))
               : 1.0 - down * down / (width * (variable->high - variable->centre));
}

// The largest distance between the draws' steps and a distribution.
static double distance(const Variable *variable, const Spec *spec, Below below)
{
    double *values = malloc(spec->draws * sizeof *values);
    draw_all(spec, variable, values);
    qsort(values, spec->draws, sizeof *values, compare_numbers);
    const double count = (double)spec->draws;
    double largest = 0.0;
    for (uint64_t i = 0; i < spec->draws; i++) {
        const double share = below(variable, values[i]);
        largest = fmax(
            largest, fmax(fabs(share - (double)i / count), fabs(share - (double)(i + 1) / count)));
    }
    free(values);
    return largest;
}

typedef struct Family {
    Variable variable;
    Below below;
} Family;

enum { FAMILY_COUNT = 6 };

static void make_families(Family families[FAMILY_COUNT])
{
    families[0] = (Family){make_variable("uniform", VARIABLE_UNIFORM, -2.0, 5.0), below_uniform};
    families[1] =
        (Family){make_variable("log", VARIABLE_LOG_UNIFORM, 1e10, 1e12), below_log_uniform};
    families[2] =
        (Family){make_variable("normal", VARIABLE_NORMAL, -INFINITY, INFINITY), below_normal};
    families[3] = (Family){make_variable("cut", VARIABLE_NORMAL, 9.0, 10.5), below_normal};
    families[4] = (Family){make_variable("three", VARIABLE_TRIANGULAR, 1.0, 4.0), below_triangular};
    families[5] = (Family){make_variable("edge", VARIABLE_TRIANGULAR, 1.0, 4.0), below_triangular};
    families[2].variable.centre = families[3].variable.centre = 10.0;
    families[2].variable.deviation = families[3].variable.deviation = 0.5;
    families[4].variable.centre = 1.5;
    families[5].variable.centre = 1.0; // the mode at an end
}

static void draws_follow_their_distributions(void **state)
{
    (void)state;
    Family families[FAMILY_COUNT];
    make_families(families);
    const Spec random = make_drawn_spec(DRAW_RANDOM, DRAWS, 1);
    const Spec spread = make_drawn_spec(DRAW_LATIN_HYPERCUBE, DRAWS, 1);
    const double bound = sqrt(log(2.0 / KS_LEVEL) / (2.0 * DRAWS));
    for (size_t i = 0; i < FAMILY_COUNT; i++) {
        assert_true(distance(&families[i].variable, &random, families[i].below) <= bound);
        // one draw a share: no step is further off than a share, and the cdf's rounding
        assert_true(distance(&families[i].variable, &spread, families[i].below) <=
                    1.0 / DRAWS + 1e-9);
    }
}

// The control: a distribution beside the right one is told from it.
static void draws_of_another_distribution_are_told(void **state)
{
    (void)state;
    Family families[FAMILY_COUNT];
    make_families(families);
    const Spec random = make_drawn_spec(DRAW_RANDOM, DRAWS, 1);
    const double bound = sqrt(log(2.0 / KS_LEVEL) / (2.0 * DRAWS));
    assert_false(distance(&families[1].variable, &random, below_uniform) <= bound);
    assert_false(distance(&families[3].variable, &random, below_uniform) <= bound);
    assert_false(distance(&families[4].variable, &random, below_uniform) <= bound);
}

static void means_and_variances_are_those_of_closed_forms(void **state)
{
    (void)state;
    static double values[DRAWS];
    Family families[FAMILY_COUNT];
    make_families(families);
    const Variable *uniform = &families[0].variable;
    const Variable *triangle = &families[4].variable;
    const double a = triangle->low;
    const double b = triangle->high;
    const double c = triangle->centre;
    const double means[] = {0.5 * (uniform->low + uniform->high), 10.0, (a + b + c) / 3.0};
    const double variances[] = {pow(uniform->high - uniform->low, 2.0) / 12.0, 0.25,
                                (a * a + b * b + c * c - a * b - a * c - b * c) / 18.0};
    const size_t places[] = {0, 2, 4};
    const Spec spec = make_drawn_spec(DRAW_RANDOM, DRAWS, 7);
    for (size_t i = 0; i < 3; i++) {
        draw_all(&spec, &families[places[i]].variable, values);
        double sum = 0.0;
        double squares = 0.0;
        for (size_t k = 0; k < DRAWS; k++) {
            sum += values[k];
            squares += (values[k] - means[i]) * (values[k] - means[i]);
        }
        const double deviation = sqrt(variances[i] / DRAWS);
        assert_near(sum / DRAWS, means[i], FIVE_DEVIATIONS * deviation);
        // the fourth moment of all three is at most 3 variances squared
        assert_near(squares / DRAWS, variances[i],
                    FIVE_DEVIATIONS * variances[i] * sqrt(2.0 / DRAWS));
    }
}

static void whole_numbers_have_equal_shares(void **state)
{
    (void)state;
    Variable variable = make_variable("ode.seed", VARIABLE_UNIFORM, 3.0, 9.0);
    variable.is_whole = true;
    const Spec spec = make_drawn_spec(DRAW_LATIN_HYPERCUBE, 700, 1);
    size_t counts[7] = {0};
    for (uint64_t i = 0; i < spec.draws; i++) {
        const double value = draw_value(&variable, draw_variable_share(&spec, &variable, i));
        assert_true(value == floor(value) && value >= 3.0 && value <= 9.0);
        counts[(size_t)value - 3]++;
    }
    for (size_t i = 0; i < 7; i++) {
        assert_int_equal(counts[i], 100);
    }
}

// How many of n equal shares of a variable have exactly one draw.
static uint64_t full_shares(const Spec *spec, const char *key)
{
    const Variable variable = make_variable(key, VARIABLE_UNIFORM, 0.0, 1.0);
    uint8_t *counts = calloc(spec->draws, 1);
    uint64_t full = 0;
    for (uint64_t i = 0; i < spec->draws; i++) {
        const double share = draw_variable_share(spec, &variable, i);
        assert_true(share > 0.0 && share < 1.0);
        uint8_t *count = &counts[(uint64_t)(share * (double)spec->draws)];
        *count = (uint8_t)(*count + (*count < 2 ? 1 : 0));
    }
    for (uint64_t i = 0; i < spec->draws; i++) {
        full += counts[i] == 1 ? 1 : 0;
    }
    free(counts);
    return full;
}

static void a_latin_hypercube_has_one_draw_in_each_share(void **state)
{
    (void)state;
    static const uint64_t COUNTS[] = {1, 2, 3, 7, 64, 1000, 10007};
    static const char *const KEYS[] = {"drive.speed", "contact.restitution", "a", "b"};
    for (size_t i = 0; i < sizeof COUNTS / sizeof COUNTS[0]; i++) {
        for (size_t k = 0; k < sizeof KEYS / sizeof KEYS[0]; k++) {
            const Spec spec = make_drawn_spec(DRAW_LATIN_HYPERCUBE, COUNTS[i], i + k);
            assert_int_equal(full_shares(&spec, KEYS[k]), COUNTS[i]);
        }
    }
    // the control: at random a share has one draw with a chance of 1 / e
    const Spec random = make_drawn_spec(DRAW_RANDOM, 10007, 1);
    assert_near((double)full_shares(&random, "a") / 10007.0, exp(-1.0),
                FIVE_DEVIATIONS * 0.5 / sqrt(10007.0));
}

static void check_order(uint64_t seed, uint64_t count)
{
    uint8_t *is_taken = calloc(count, 1);
    for (uint64_t i = 0; i < count; i++) {
        const uint64_t place = draw_position(seed, draw_stream("key"), count, i);
        if (place >= count || is_taken[place]) {
            fail_msg("of %llu items, item %llu goes where another one is",
                     (unsigned long long)count, (unsigned long long)i);
        }
        is_taken[place] = 1;
    }
    free(is_taken);
}

static void every_item_has_a_place_of_its_own(void **state)
{
    (void)state;
    for (uint64_t count = 1; count <= 2000; count++) {
        check_order(count, count);
    }
    check_order(1, 999983); // primes, well below and just below a power of four
    check_order(1, 1048573);
    // places of a count as large as there may be are in range, and differ
    const uint64_t most = (uint64_t)1 << 53;
    assert_true(draw_position(1, 2, most, most - 1) < most);
    assert_true(draw_position(1, 2, most, 0) != draw_position(1, 2, most, 1));
}

// Chi squared of the 24 orders of 4 items over so many streams.
static double orders_chi_squared(bool is_shuffled)
{
    enum { STREAMS = 24000, ORDERS = 256 };
    size_t counts[ORDERS] = {0};
    for (uint64_t stream = 0; stream < STREAMS; stream++) {
        size_t order = 0;
        for (uint64_t i = 0; i < 4; i++) {
            order = 4 * order + (size_t)(is_shuffled ? draw_position(1, stream, 4, i) : i);
        }
        counts[order]++;
    }
    const double expected = STREAMS / 24.0;
    double sum = 0.0;
    size_t found = 0;
    for (size_t i = 0; i < ORDERS; i++) {
        found += counts[i] > 0 ? 1 : 0;
        sum += counts[i] > 0 ? pow((double)counts[i] - expected, 2.0) / expected : 0.0;
    }
    return sum + (double)(24 - found) * expected;
}

static void every_order_is_as_likely_as_any_other(void **state)
{
    (void)state;
    // 23 degrees of freedom: above 71.2 with a chance of 1e-6
    assert_true(orders_chi_squared(true) <= 71.2);
    assert_false(orders_chi_squared(false) <= 71.2);
}

// The correlation of the ranks of two variables' draws.
static double rank_correlation(const Spec *spec, const char *first, const char *second)
{
    const Variable a = make_variable(first, VARIABLE_UNIFORM, 0.0, 1.0);
    const Variable b = make_variable(second, VARIABLE_UNIFORM, 0.0, 1.0);
    const double count = (double)spec->draws;
    double sum = 0.0;
    for (uint64_t i = 0; i < spec->draws; i++) {
        // of a Latin hypercube the share is the rank
        const double difference = floor(count * draw_variable_share(spec, &a, i)) -
                                  floor(count * draw_variable_share(spec, &b, i));
        sum += difference * difference;
    }
    return 1.0 - 6.0 * sum / (count * (count * count - 1.0));
}

static void variables_are_independent(void **state)
{
    (void)state;
    static const char *const KEYS[] = {"four-bar.crank.length", "four-bar.ground.length",
                                       "joints.crank-coupler.hole", "joints.crank-coupler.pin",
                                       "drive.speed"};
    enum { KEY_COUNT = sizeof KEYS / sizeof KEYS[0], COUNT = 1000 };
    const double bound = FIVE_DEVIATIONS / sqrt(COUNT - 1.0);
    for (uint64_t seed = 0; seed < 5; seed++) {
        const Spec spec = make_drawn_spec(DRAW_LATIN_HYPERCUBE, COUNT, seed);
        for (size_t i = 0; i < KEY_COUNT; i++) {
            for (size_t k = 0; k < i; k++) {
                assert_true(fabs(rank_correlation(&spec, KEYS[i], KEYS[k])) <= bound);
            }
        }
        // the control
        assert_near(rank_correlation(&spec, KEYS[0], KEYS[0]), 1.0, 0.0);
    }
}

// Neighbouring draws and neighbouring seeds: what a weak mixer of counters would correlate.
static void neighbours_are_independent(void **state)
{
    (void)state;
    double next = 0.0;
    double seeds = 0.0;
    double streams = 0.0;
    for (uint64_t i = 0; i < DRAWS; i++) {
        const double share = draw_share(1, 2, i) - 0.5;
        next += share * (draw_share(1, 2, i + 1) - 0.5);
        seeds += share * (draw_share(2, 2, i) - 0.5);
        streams += share * (draw_share(1, 3, i) - 0.5);
    }
    // of two independent uniform variables the product has the deviation 1 / 12
    const double bound = FIVE_DEVIATIONS / 12.0 * sqrt((double)DRAWS);
    assert_true(fabs(next) <= bound && fabs(seeds) <= bound && fabs(streams) <= bound);
}

// A hypercube's draws of a sum of variables are nearer to their mean than random ones: that is what
// it is for. The reason is closed: between shares nothing is left to chance.
static void a_latin_hypercube_finds_the_mean_of_a_sum_better(void **state)
{
    (void)state;
    double means[2] = {0.0, 0.0};
    for (uint64_t seed = 0; seed < 50; seed++) {
        for (int method = 0; method < 2; method++) {
            const Spec spec = make_drawn_spec((DrawMethod)method, 200, seed);
            double sum = 0.0;
            for (uint64_t i = 0; i < spec.draws; i++) {
                const Variable a = make_variable("a", VARIABLE_UNIFORM, -1.0, 1.0);
                const Variable b = make_variable("b", VARIABLE_UNIFORM, -1.0, 1.0);
                sum += draw_value(&a, draw_variable_share(&spec, &a, i)) +
                       draw_value(&b, draw_variable_share(&spec, &b, i));
            }
            means[method] += pow(sum / 200.0, 2.0) / 50.0;
        }
    }
    // variance 2/3 n of random draws, 2/3 n^3 of the hypercube's: a factor of n^2 = 40000, taken to
    // within the spread of 50 seeds
    assert_true(means[DRAW_LATIN_HYPERCUBE] * 10000.0 < means[DRAW_RANDOM]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(draws_follow_their_distributions),
        cmocka_unit_test(draws_of_another_distribution_are_told),
        cmocka_unit_test(means_and_variances_are_those_of_closed_forms),
        cmocka_unit_test(whole_numbers_have_equal_shares),
        cmocka_unit_test(a_latin_hypercube_has_one_draw_in_each_share),
        cmocka_unit_test(every_item_has_a_place_of_its_own),
        cmocka_unit_test(every_order_is_as_likely_as_any_other),
        cmocka_unit_test(variables_are_independent),
        cmocka_unit_test(neighbours_are_independent),
        cmocka_unit_test(a_latin_hypercube_finds_the_mean_of_a_sum_better),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
