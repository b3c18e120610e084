// Does a call with any numbers at all end, and in finite numbers wherever it says JP_OK?
//
// Functions without a world, thousands of times, with numbers drawn from the worst there are. The
// same draws without a check of the results hold numbers that are not finite: the control.
#include "close.h"

#include "base/lcg.h"

#include <jointplay/jointplay.h>

#include <float.h>
#include <string.h>

enum { CALLS = 10000, KINDS = 10 };

// What a call is made with, at random; seeded.
typedef struct Draw {
    uint64_t seed;
} Draw;

// A number in [0, 1).
static double share(Draw *draw)
{
    return 0.5 * (lcg_draw(&draw->seed) + 1.0);
}

static size_t pick(Draw *draw, size_t count)
{
    return (size_t)(share(draw) * (double)count);
}

// Every second number is an ordinary one, so that calls get past the checks at the door.
static double number(Draw *draw)
{
    static const double WORST[] = {
        NAN,    INFINITY, -INFINITY,   0.0,   -0.0,  -1.0,  1e-310, 4.9e-324, DBL_MIN, 1e-300,
        1e-160, 1e-155,   DBL_EPSILON, 1e155, 1e160, 1e300, 1e308,  DBL_MAX,  -1e308,  1.0,
    };
    const bool is_worst = pick(draw, 2) == 0;
    return is_worst ? WORST[pick(draw, sizeof WORST / sizeof *WORST)]
                    : pow(10.0, 16.0 * share(draw) - 8.0);
}

static JpContact contact_of(Draw *draw)
{
    JpContact contact = jp_contact_default();
    contact.stiffness = number(draw);
    contact.damping = (JpDamping)((int)pick(draw, 10) - 1);
    contact.restitution = pick(draw, 2) == 0 ? share(draw) : number(draw);
    contact.damper = number(draw);
    contact.exponent = pick(draw, 3) == 0 ? number(draw) : 1.0 + 0.5 * (double)pick(draw, 2);
    if (pick(draw, 4) == 0) {
        contact.speed_floor = number(draw);
    }
    if (pick(draw, 4) == 0) {
        contact.stiffness = 0.0;
        contact.compliance = number(draw);
        contact.offset = pick(draw, 2) == 0 ? 20.0 : number(draw);
    }
    return contact;
}

static JpInstant instant_of(Draw *draw)
{
    return (JpInstant){.depth = number(draw),
                       .closing = number(draw),
                       .impact_speed = number(draw),
                       .mass = number(draw),
                       .step = number(draw)};
}

// What came of a call: numbers that all have to be finite where the status is JP_OK.
typedef struct Outcome {
    JpStatus status;
    JpError error;
    double numbers[16];
} Outcome;

static void call_mapping(Draw *draw, size_t kind, Outcome *out)
{
    const JpContact contact = contact_of(draw);
    const JpInstant at = instant_of(draw);
    const JpMap map = (JpMap)((int)pick(draw, 6) - 1);
    const JpRow given = pick(draw, 2) == 0 ? jp_row_of(number(draw), number(draw))
                                           : (JpRow){number(draw), number(draw), number(draw)};
    JpRow row = {0};
    JpSpring spring = {0};
    switch (kind) {
    case 0:
        out->status = jp_row(map, &contact, &at, &row, &out->error);
        memcpy(out->numbers, &row, sizeof row);
        break;
    case 1:
        out->status = jp_spring_of(map, given, &at, &spring, &out->error);
        memcpy(out->numbers, &spring, sizeof spring);
        break;
    case 2:
        out->status = jp_row_of_gazebo(number(draw), number(draw), number(draw), &row, &out->error);
        memcpy(out->numbers, &row, sizeof row);
        break;
    default:
        out->status = jp_bounce_of_row(number(draw), number(draw), number(draw), number(draw),
                                       out->numbers, &out->error);
        break;
    }
}

static void call_contact(Draw *draw, size_t kind, Outcome *out)
{
    JpContact contact = contact_of(draw);
    const JpPin pin = {number(draw),
                       number(draw),
                       number(draw),
                       number(draw),
                       pick(draw, 2) == 0 ? 0.3 : number(draw),
                       pick(draw, 2) == 0 ? 0.0 : number(draw),
                       pick(draw, 2) == 0 ? 0.0 : number(draw),
                       number(draw)};
    switch (kind) {
    case 4:
        contact = jp_contact_default();
        out->status =
            jp_contact_of_pin((JpPinLaw)((int)pick(draw, 7) - 1), &pin, &contact, &out->error);
        out->numbers[0] = contact.stiffness;
        out->numbers[1] = contact.exponent;
        out->numbers[2] = contact.compliance;
        out->numbers[3] = contact.offset;
        break;
    case 5:
        out->status =
            jp_damper_of(number(draw), number(draw), number(draw), out->numbers, &out->error);
        break;
    case 6:
        out->status =
            jp_restitution_of(number(draw), number(draw), number(draw), out->numbers, &out->error);
        break;
    default:
        out->status = jp_contact_check(&contact, &out->error);
        break;
    }
}

static void call_impact(Draw *draw, size_t kind, Outcome *out)
{
    const JpContact contact = contact_of(draw);
    const JpMap map = (JpMap)((int)pick(draw, 6) - 1);
    JpImpact impact = {0};
    JpDelivered delivered = {0};
    bool is_right = false;
    if (kind == 8) {
        out->status = jp_impact_of_law(&contact, number(draw), number(draw), &impact, &out->error);
        memcpy(out->numbers, &impact, sizeof impact);
        return;
    }
    out->status = jp_impact_of_rows(map, &contact, number(draw), number(draw), number(draw),
                                    &delivered, &out->error);
    memcpy(out->numbers, &delivered, 13 * sizeof(double));
    if (out->status != JP_OK) {
        out->status = jp_step_is_right(map, &contact, number(draw), number(draw), number(draw),
                                       number(draw), &is_right, &out->error);
        memset(out->numbers, 0, sizeof out->numbers);
    }
}

// Impacts take milliseconds: two calls in a hundred.
static size_t kind_of(size_t number)
{
    const size_t quick = KINDS - 2;
    return number % 100 < 98 ? number % quick : quick + number % 2;
}

static Outcome call(Draw *draw, size_t kind)
{
    Outcome out = {0};
    (kind < 4 ? call_mapping : kind < 8 ? call_contact : call_impact)(draw, kind, &out);
    return out;
}

static void hostile_calls_end_in_finite_numbers_or_a_sentence(void **state)
{
    (void)state;
    Draw draw = {lcg_stirred(33)};
    size_t counts[KINDS] = {0};
    size_t refused = 0;
    for (int i = 0; i < CALLS; i++) {
        const size_t kind = kind_of((size_t)i);
        const Outcome out = call(&draw, kind);
        if (out.status != JP_OK) {
            refused++;
            assert_true(out.error.status == out.status && strlen(out.error.text) > 10);
            continue;
        }
        counts[kind]++;
        for (size_t k = 0; k < sizeof out.numbers / sizeof *out.numbers; k++) {
            if (!isfinite(out.numbers[k])) {
                fail_msg("call %d of kind %zu: number %zu is %g with JP_OK", i, kind, k,
                         out.numbers[k]);
            }
        }
    }
    // the control: calls of every kind got past the checks, and most draws are out of all range
    for (size_t kind = 0; kind < KINDS; kind++) {
        assert_true(counts[kind] > 0);
    }
    assert_true(refused > CALLS / 4);
}

// Calls that ended in an assertion, or in NaN with JP_OK.
static void calls_that_once_ended_the_program_are_answered(void **state)
{
    (void)state;
    double found = 7.0;
    JpError error;
    // e = exp(-2 asinh z), so that c = 2 z sqrt(k m) with z = 1 / (2 sqrt e), of which ln e is
    // right
    assert_int_equal(jp_damper_of(1.0, 1e-310, 1.0, &found, &error), JP_OK);
    assert_close(2.0 * log(found), -log(1e-310), 1e-9);
    assert_int_equal(jp_bounce_of_row(0.5, 1e300, 1e300, 1e-3, &found, &error), JP_ERROR_NONE);
    assert_int_equal(jp_restitution_of(1e-310, 0.0, 1e-310, &found, &error), JP_OK);
    assert_close(found, 1.0, 0.0);
    JpContact contact = jp_contact_default();
    const JpPin thick = {.hole_radius = 1e300,
                         .pin_radius = 1e299,
                         .width = 1e300,
                         .youngs_modulus = 1e308,
                         .poisson_ratio = 0.3};
    for (int law = JP_PIN_HERTZ; law <= JP_PIN_ELASTIC; law++) {
        assert_int_equal(jp_contact_of_pin((JpPinLaw)law, &thick, &contact, &error),
                         JP_ERROR_ARGUMENT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hostile_calls_end_in_finite_numbers_or_a_sentence),
        cmocka_unit_test(calls_that_once_ended_the_program_are_answered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
