// Is every number found by what it stands for, and nothing else?
#include "base/lookup.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <stdio.h>
#include <string.h>

enum { COUNT = 3000 };

static char names[COUNT][16];

static bool is_name(size_t number, const void *sought)
{
    return strcmp(names[number], sought) == 0;
}

static Lookup make_lookup(bool is_one_hash)
{
    Lookup lookup = {.count = 0};
    for (size_t i = 0; i < COUNT; i++) {
        snprintf(names[i], sizeof names[i], "pin-%zu", i);
        lookup_add(&lookup, is_one_hash ? 7 : lookup_hash(names[i]), i);
    }
    return lookup;
}

static void every_name_is_found_in_a_lookup_and_its_copy(void **state)
{
    (void)state;
    Lookup lookup = make_lookup(false);
    Lookup copy = lookup_copy(&lookup);
    for (size_t i = 0; i < COUNT; i++) {
        assert_int_equal(lookup_find(&lookup, lookup_hash(names[i]), is_name, names[i]), i);
        assert_int_equal(lookup_find(&copy, lookup_hash(names[i]), is_name, names[i]), i);
    }
    assert_int_equal(lookup_find(&lookup, lookup_hash("pin-x"), is_name, "pin-x"), LOOKUP_NONE);
    lookup_finish(&lookup);
    lookup_finish(&copy);
}

// Where all have the same hash the names decide.
static void equal_hashes_are_told_apart(void **state)
{
    (void)state;
    Lookup lookup = make_lookup(true);
    assert_int_equal(lookup_find(&lookup, 7, is_name, "pin-2999"), 2999);
    assert_int_equal(lookup_find(&lookup, 7, is_name, "pin-x"), LOOKUP_NONE);
    assert_int_equal(lookup_find(&lookup, 8, is_name, "pin-2999"), LOOKUP_NONE);
    lookup_finish(&lookup);
}

static void an_empty_one_finds_nothing(void **state)
{
    (void)state;
    const Lookup lookup = {.count = 0};
    assert_int_equal(lookup_find(&lookup, 7, is_name, "pin-0"), LOOKUP_NONE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_name_is_found_in_a_lookup_and_its_copy),
        cmocka_unit_test(equal_hashes_are_told_apart),
        cmocka_unit_test(an_empty_one_finds_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
