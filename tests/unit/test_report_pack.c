// Is SHA-256 what its standard says, base64 what RFC 4648 says, and does a packed signal mean the
// values that went in?
#include "commands/report/report_pack.h"
#include "commands/report/report_sha256.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void expect_digest(const char *bytes, size_t count, const char *expected)
{
    unsigned char digest[SHA256_SIZE];
    char words[2 * SHA256_SIZE + 1];
    report_sha256(bytes, count, digest);
    for (int i = 0; i < SHA256_SIZE; i++) {
        snprintf(words + 2 * i, 3, "%02x", digest[i]);
    }
    assert_string_equal(words, expected);
}

static void digests_are_those_of_the_standard(void **state)
{
    (void)state;
    expect_digest("abc", 3, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    expect_digest("", 0, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    // its padding needs a block of its own
    const char *two = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    expect_digest(two, strlen(two),
                  "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    static char many[1000000];
    memset(many, 'a', sizeof many);
    expect_digest(many, sizeof many,
                  "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

static void base64_is_that_of_the_standard(void **state)
{
    (void)state;
    static const char *const PAIRS[][2] = {
        {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}};
    for (size_t i = 0; i < sizeof PAIRS / sizeof *PAIRS; i++) {
        Text text;
        text_init(&text);
        pack_base64((const unsigned char *)PAIRS[i][0], strlen(PAIRS[i][0]), &text);
        assert_string_equal(text.data, PAIRS[i][1]);
        text_finish(&text);
    }
}

// Reads value by value as report_pack.h describes it.
static void unpack(const Pack *pack, const PackedSignal *signal, double *values)
{
    const unsigned char *bytes = pack->bytes + signal->offset;
    uint16_t code = 0;
    for (size_t i = 0; i < signal->count; i++) {
        code = (uint16_t)(code + bytes[i] + 256 * bytes[signal->count + i]);
        values[i] =
            code == PACK_NONE ? NAN : signal->low + signal->slope * (double)i + signal->step * code;
    }
}

enum { COUNT = 1000 };

static void a_value_is_off_by_half_a_step_at_most(void **state)
{
    (void)state;
    Pack pack = {0};
    double values[2][COUNT];
    double back[COUNT];
    for (int i = 0; i < COUNT; i++) {
        values[0][i] = 1e4 * sin(0.1 * i) * exp(0.004 * i);
        values[1][i] = i == 7 ? NAN : -3.0 + 1e-6 * cos(i);
    }
    for (int k = 0; k < 2; k++) {
        const PackedSignal signal = pack_add(&pack, values[k], COUNT, false);
        assert_true(signal.step > 0.0);
        unpack(&pack, &signal, back);
        for (int i = 0; i < COUNT; i++) {
            assert_int_equal(isnan(back[i]), isnan(values[k][i]));
            assert_false(fabs(back[i] - values[k][i]) > 0.5000001 * signal.step);
        }
    }
    pack_finish(&pack);
}

static void an_angle_of_many_turns_is_as_exact_as_one_of_few(void **state)
{
    (void)state;
    Pack pack = {0};
    double angles[COUNT];
    double back[COUNT];
    for (int i = 0; i < COUNT; i++) {
        angles[i] = 0.4 * i + 0.01 * sin(i);
    }
    const PackedSignal signal = pack_add(&pack, angles, COUNT, true);
    unpack(&pack, &signal, back);
    double largest = 0.0;
    for (int i = 0; i < COUNT; i++) {
        largest = fmax(largest, fabs(back[i] - angles[i]));
    }
    assert_true(largest < 4e-7);
    // the control: with the turns left in it is not
    const PackedSignal coarse = pack_add(&pack, angles, COUNT, false);
    assert_true(coarse.step > 1e-3);
    pack_finish(&pack);
}

static void what_is_constant_but_for_rounding_is_constant(void **state)
{
    (void)state;
    Pack pack = {0};
    double values[COUNT];
    for (int i = 0; i < COUNT; i++) {
        values[i] = 5.0 + 1e-15 * (i % 3);
    }
    const PackedSignal signal = pack_add(&pack, values, COUNT, false);
    assert_true(signal.step == 0.0);
    assert_true(fabs(signal.low - 5.0) < 1e-14);
    pack_finish(&pack);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(digests_are_those_of_the_standard),
        cmocka_unit_test(base64_is_that_of_the_standard),
        cmocka_unit_test(a_value_is_off_by_half_a_step_at_most),
        cmocka_unit_test(an_angle_of_many_turns_is_as_exact_as_one_of_few),
        cmocka_unit_test(what_is_constant_but_for_rounding_is_constant),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
