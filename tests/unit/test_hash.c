// Does the fingerprint of a stream of numbers change with any bit and any order?
#include "base/hash.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

static void equal_streams_have_equal_hashes(void **state)
{
    (void)state;
    const uint64_t first = hash_number(hash_number(HASH_START, 1.0), 2.0);
    const uint64_t second = hash_number(hash_number(HASH_START, 1.0), 2.0);
    assert_true(first == second);
}

static void the_order_counts(void **state)
{
    (void)state;
    const uint64_t first = hash_number(hash_number(HASH_START, 1.0), 2.0);
    const uint64_t second = hash_number(hash_number(HASH_START, 2.0), 1.0);
    assert_true(first != second);
}

static void the_last_bit_counts(void **state)
{
    (void)state;
    const double next = nextafter(1.0, 2.0);
    assert_true(hash_number(HASH_START, 1.0) != hash_number(HASH_START, next));
    assert_true(hash_number(HASH_START, 0.0) != hash_number(HASH_START, -0.0));
}

static void a_zero_more_counts(void **state)
{
    (void)state;
    assert_true(hash_number(HASH_START, 0.0) != HASH_START);
    assert_true(hash_number(hash_number(HASH_START, 0.0), 0.0) != hash_number(HASH_START, 0.0));
}

static void many_numbers_have_many_hashes(void **state)
{
    (void)state;
    enum { COUNT = 2000 };
    static uint64_t hashes[COUNT];
    for (int i = 0; i < COUNT; i++) {
        hashes[i] = hash_number(HASH_START, 0.1 * i);
        for (int j = 0; j < i; j++) {
            assert_true(hashes[i] != hashes[j]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_streams_have_equal_hashes),
        cmocka_unit_test(the_order_counts),
        cmocka_unit_test(the_last_bit_counts),
        cmocka_unit_test(a_zero_more_counts),
        cmocka_unit_test(many_numbers_have_many_hashes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
