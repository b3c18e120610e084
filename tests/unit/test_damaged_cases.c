// Does a damaged case end in an error or in a sound scenario, and never in a crash?
//
// Worth most in a build with -Db_sanitize=address,undefined. Runs in the source root.
#include "casefile/casefile.h"

#include "close.h"
#include "sample.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CASE_SIZE = 4096, MUTATION_COUNT = 6000, OVERRIDE_COUNT = 3000 };

static char good[CASE_SIZE];
static size_t good_size;

// A linear congruential generator (Knuth's MMIX constants): the same bytes on every machine.
static unsigned next_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(*seed >> 33);
}

static void load_damaged(const char *text, size_t size, const char *const *overrides, size_t count)
{
    Scenario scenario = scenario_default();
    Err err = {0};
    if (casefile_load_text("damaged", text, size, overrides, count, &scenario, &err)) {
        assert_int_equal(err.kind, ERR_NONE);
        assert_true(scenario_check(&scenario, &err));
        assert_true(scenario.run.backend_count > 0);
        for (size_t i = 0; i < scenario.linkage.body_count; i++) {
            assert_true(isfinite(scenario.linkage.bodies[i].start.alpha));
        }
        scenario_free(&scenario);
    } else {
        assert_true(err.kind == ERR_CASE || err.kind == ERR_USAGE);
        assert_true(strlen(err.text) > 0 && strlen(err.text) < ERR_TEXT_SIZE - 1);
        assert_int_equal(scenario.linkage.body_count, 0);
    }
}

static int read_good(void **state)
{
    (void)state;
    FILE *file = fopen("cases/paper/stackup-impact.yaml", "rb");
    if (file == NULL) {
        return -1;
    }
    good_size = fread(good, 1, sizeof good - 1, file);
    fclose(file);
    return 0;
}

static void a_case_cut_anywhere_does_no_harm(void **state)
{
    (void)state;
    for (size_t size = 0; size <= good_size; size += sample_stride()) {
        load_damaged(good, size, NULL, 0);
    }
}

static void one_wrong_byte_does_no_harm(void **state)
{
    (void)state;
    uint64_t seed = 1;
    for (size_t i = 0; i < sample_size(MUTATION_COUNT); i++) {
        char text[CASE_SIZE];
        memcpy(text, good, good_size);
        const size_t at = next_random(&seed) % good_size;
        // half of them printable, to get past the test for text
        text[at] = (char)(i % 2 == 0 ? next_random(&seed) % 256 : 32 + next_random(&seed) % 95);
        load_damaged(text, good_size, NULL, 0);
    }
}

static void two_swapped_pieces_do_no_harm(void **state)
{
    (void)state;
    uint64_t seed = 2;
    for (size_t i = 0; i < sample_size(MUTATION_COUNT); i++) {
        char text[CASE_SIZE];
        memcpy(text, good, good_size);
        const size_t from = next_random(&seed) % good_size;
        const size_t to = next_random(&seed) % good_size;
        const size_t rest = good_size - (from > to ? from : to);
        const size_t size = 1 + next_random(&seed) % (rest < 20 ? rest : 20);
        memmove(text + to, good + from, size);
        load_damaged(text, good_size, NULL, 0);
    }
}

static void any_override_does_no_harm(void **state)
{
    (void)state;
    static const char *const PIECES[] = {
        "joints",    ".",       "crank-coupler",
        "=",         "pin",     "hole",
        "{",         "}",       "[",
        "]",         ",",       ": ",
        "&a",        "*a",      "!t",
        "run",       "step",    "contact",
        "stiffness", "law",     "1",
        "-",         "e5",      " mm",
        "N/m^1.5",   "points",  "tip",
        "body",      "coupler", "\"",
        "'",         "\n",      "\t",
        "\u00b5",    "\xff",    "start",
        "#",
    };
    uint64_t seed = 3;
    for (size_t i = 0; i < sample_size(OVERRIDE_COUNT); i++) {
        char override[256] = "";
        const unsigned pieces = next_random(&seed) % 12;
        for (unsigned j = 0; j < pieces; j++) {
            const char *piece = PIECES[next_random(&seed) % (sizeof PIECES / sizeof PIECES[0])];
            strncat(override, piece, sizeof override - strlen(override) - 1);
        }
        const char *overrides[] = {override};
        load_damaged(good, good_size, overrides, 1);
    }
}

// A thousand levels would let a parser that recurses run out of stack.
static void deep_and_wide_documents_end_at_once(void **state)
{
    (void)state;
    enum { LARGE = 1 << 20 };
    char *text = malloc(LARGE);
    assert_non_null(text);
    static const char *const PATTERNS[] = {"[",   "{a: ",   "- ",   "? ", "a: b\n",
                                           "&a ", "[a,b],", "\"\\", "#"};
    for (size_t i = 0; i < sizeof PATTERNS / sizeof PATTERNS[0]; i++) {
        const size_t length = strlen(PATTERNS[i]);
        for (size_t at = 0; at + length <= LARGE; at += length) {
            memcpy(text + at, PATTERNS[i], length);
        }
        load_damaged(text, LARGE - LARGE % length, NULL, 0);
    }
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_case_cut_anywhere_does_no_harm),
        cmocka_unit_test(one_wrong_byte_does_no_harm),
        cmocka_unit_test(two_swapped_pieces_do_no_harm),
        cmocka_unit_test(any_override_does_no_harm),
        cmocka_unit_test(deep_and_wide_documents_end_at_once),
    };
    return cmocka_run_group_tests_name("damaged_cases", tests, read_good, NULL);
}
