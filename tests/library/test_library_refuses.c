// Is a wrong call an error with a sentence, and is what it was to fill in left alone?
#include "close.h"

#include <jointplay/jointplay.h>

#include <string.h>

// A call that was refused: its status and sentence.
#define assert_refused(call)                                                                       \
    do {                                                                                           \
        JpError error = {JP_OK, ""};                                                               \
        const JpStatus status = (call);                                                            \
        assert_true(status != JP_OK && error.status == status);                                    \
        assert_true(strlen(error.text) > 10 && strlen(error.text) + 1 < JP_ERROR_SIZE);            \
    } while (0)

static JpContact good(void)
{
    JpContact contact = jp_contact_default();
    contact.stiffness = 1e6;
    return contact;
}

static void a_contact_that_is_none_is_refused(void **state)
{
    (void)state;
    const JpContact none = jp_contact_default();
    assert_refused(jp_contact_check(NULL, &error));
    assert_refused(jp_contact_check(&none, &error));
    static const struct {
        size_t offset;
        double value;
    } WRONG[] = {
        {offsetof(JpContact, stiffness), NAN},      {offsetof(JpContact, stiffness), -1.0},
        {offsetof(JpContact, stiffness), INFINITY}, {offsetof(JpContact, exponent), 0.0},
        {offsetof(JpContact, restitution), -0.1},   {offsetof(JpContact, restitution), 1.1},
        {offsetof(JpContact, restitution), NAN},    {offsetof(JpContact, restitution), 0.0},
        {offsetof(JpContact, speed_floor), 0.0},    {offsetof(JpContact, compliance), 1e-9},
        {offsetof(JpContact, compliance), NAN},
    };
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        JpContact contact = good();
        memcpy((char *)&contact + WRONG[i].offset, &WRONG[i].value, sizeof(double));
        assert_refused(jp_contact_check(&contact, &error));
    }
    JpContact contact = good();
    contact.damping = (JpDamping)99;
    assert_refused(jp_contact_check(&contact, &error));
    contact = good();
    contact.damping = JP_DAMPING_VISCOUS;
    contact.damper = -1.0;
    assert_refused(jp_contact_check(&contact, &error));
    // and a right one is none
    contact = good();
    assert_int_equal(jp_contact_check(&contact, NULL), JP_OK);
}

static void a_pin_that_is_none_is_refused(void **state)
{
    (void)state;
    const JpPin pin = {0.0105, 0.0100, 0.02, 2.07e11, 0.3};
    JpContact contact = good();
    assert_refused(jp_contact_of_pin(JP_PIN_HERTZ, NULL, &contact, &error));
    assert_refused(jp_contact_of_pin(JP_PIN_HERTZ, &pin, NULL, &error));
    assert_refused(jp_contact_of_pin((JpPinLaw)9, &pin, &contact, &error));
    JpPin larger = pin;
    larger.pin_radius = 0.011;
    assert_refused(jp_contact_of_pin(JP_PIN_HERTZ, &larger, &contact, &error));
    JpPin thin = pin;
    thin.width = 0.0;
    assert_refused(jp_contact_of_pin(JP_PIN_JOHNSON, &thin, &contact, &error));
    assert_close(contact.stiffness, 1e6, 0.0);
}

static void a_row_that_is_none_is_refused(void **state)
{
    (void)state;
    const JpContact contact = good();
    const JpInstant at = {.depth = 1e-6, .closing = 0.1, .impact_speed = 0.1, .step = 1e-5};
    JpInstant no_step = at;
    no_step.step = 0.0;
    JpInstant no_depth = at;
    no_depth.depth = NAN;
    JpRow row = {7.0, 7.0, 7.0};
    JpSpring spring;
    assert_refused(jp_row(JP_MAP_TEXTBOOK, &contact, &at, NULL, &error));
    assert_refused(jp_row(JP_MAP_TEXTBOOK, &contact, NULL, &row, &error));
    assert_refused(jp_row(JP_MAP_TEXTBOOK, &contact, &no_step, &row, &error));
    assert_refused(jp_row(JP_MAP_TEXTBOOK, &contact, &no_depth, &row, &error));
    assert_refused(jp_row(JP_MAP_EXACT, &contact, &at, &row, &error));
    assert_refused(jp_row((JpMap)-1, &contact, &at, &row, &error));
    assert_refused(jp_row_of_gazebo(0.0, 0.0, 1e-3, &row, &error));
    assert_refused(jp_row_of_gazebo(1e6, 1.0, -1e-3, &row, &error));
    assert_refused(jp_spring_of(JP_MAP_TEXTBOOK, jp_row_of(0.5, 0.0), &at, &spring, &error));
    assert_refused(jp_spring_of(JP_MAP_TEXTBOOK, jp_row_of(NAN, 1.0), &at, &spring, &error));
    assert_close(row.erp, 7.0, 0.0);
}

static void an_impact_that_is_none_is_refused(void **state)
{
    (void)state;
    const JpContact contact = good();
    JpImpact impact;
    JpDelivered delivered;
    double number = 7.0;
    bool answer = false;
    assert_refused(jp_impact_of_law(&contact, 0.0, 1.0, &impact, &error));
    assert_refused(jp_impact_of_law(&contact, 1.0, NAN, &impact, &error));
    assert_refused(
        jp_impact_of_rows(JP_MAP_TEXTBOOK, &contact, 1.0, 1.0, 1e-30, &delivered, &error));
    assert_refused(
        jp_step_is_right(JP_MAP_TEXTBOOK, &contact, 1.0, 1.0, 0.0, 0.05, &answer, &error));
    assert_refused(jp_step_longest(JP_MAP_CORRECTED, &contact, 1.0, 1.0, 1e-12, &number, &error));
    assert_refused(jp_damper_of(1e6, 0.0, 1.0, &number, &error));
    assert_refused(jp_damper_of(1e6, 1.5, 1.0, &number, &error));
    assert_refused(jp_restitution_of(-1.0, 1.0, 1.0, &number, &error));
    assert_refused(jp_bounce_of_row(0.5, 1e-3, 0.0, 1e-3, &number, &error));
    assert_close(number, 7.0, 0.0);
    // a sentence that nobody wants
    assert_int_equal(jp_damper_of(1e6, 1.5, 1.0, &number, NULL), JP_ERROR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_contact_that_is_none_is_refused),
        cmocka_unit_test(a_pin_that_is_none_is_refused),
        cmocka_unit_test(a_row_that_is_none_is_refused),
        cmocka_unit_test(an_impact_that_is_none_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
