// Makes the force law that a caller's contact stands for.
#include "world/contact.h"

#include "contact/damping.h"
#include "contact/law.h"

#include <math.h>
#include <string.h>

// slower than any impact of a body of millimetres that one sees
static const double DEFAULT_SPEED_FLOOR = 1e-6;

#define CONTACT_DAMPING(name, ...) [JP_DAMPING_##name] = DAMPING_##name,
static const DampingKind KINDS[] = {OPTIONS_DAMPING_LIST(CONTACT_DAMPING)};

static const LawKind PIN_LAWS[] = {
    [JP_PIN_HERTZ] = LAW_HERTZ_SOCKET,
    [JP_PIN_JOHNSON] = LAW_JOHNSON,
    [JP_PIN_RADZIMOVSKY] = LAW_RADZIMOVSKY,
    [JP_PIN_ESDU_78035] = LAW_ESDU_78035,
    [JP_PIN_DUBOWSKY_FREUDENSTEIN] = LAW_DUBOWSKY_FREUDENSTEIN,
    [JP_PIN_ELASTIC] = LAW_ELASTIC,
};

// the program alone has a law that depends on the case, and those of the paper's tables, which
// follow from no theory of contact
enum { CASE_LAWS = 3 };
_Static_assert(sizeof KINDS / sizeof *KINDS == DAMPING_COUNT,
               "JpDamping has a damping that OPTIONS_DAMPING_LIST lacks");
_Static_assert(sizeof PIN_LAWS / sizeof *PIN_LAWS + CASE_LAWS == LAW_COUNT,
               "a law of OPTIONS_LAW_LIST is missing: add it to JpPinLaw and to PIN_LAWS");

JpContact jp_contact_default(void)
{
    return (JpContact){
        .exponent = 1.0,
        .damping = JP_DAMPING_EXACT,
        .restitution = 0.5,
        .speed_floor = DEFAULT_SPEED_FLOOR,
    };
}

static JpStatus check_elastic(const JpContact *contact, JpError *error)
{
    REFUSAL_TRY(refusal_of_negative(contact->play, "the contact's play", error));
    if (contact->compliance == 0.0) {
        REFUSAL_TRY(refusal_of_positive(contact->stiffness, "the contact's stiffness", error));
        return refusal_of_positive(contact->exponent, "the contact's exponent", error);
    }
    REFUSAL_TRY(refusal_of_positive(contact->compliance, "the contact's compliance", error));
    REFUSAL_TRY(refusal_of_finite(contact->offset, "the contact's offset", error));
    return contact->stiffness == 0.0
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT,
                         "the contact has both a stiffness and a compliance; set one of them to 0");
}

static JpStatus check_restitution(const JpContact *contact, JpError *error)
{
    const double asked = contact->restitution;
    if (!(asked >= 0.0 && asked <= 1.0)) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the contact's restitution is %g; it must be between 0 and 1", asked);
    }
    // the exact factor is sought below 1 / e
    const bool is_known = (asked > 0.0 || contact->damping != JP_DAMPING_EXACT) &&
                          isfinite(damping_factor(KINDS[contact->damping], asked));
    return is_known ? JP_OK
                    : refusal(error, JP_ERROR_ARGUMENT,
                              "the contact's restitution is %g, for which its kind of damping is "
                              "infinite; take a larger one",
                              asked);
}

static JpStatus check_damping(const JpContact *contact, JpError *error)
{
    if ((size_t)contact->damping >= sizeof KINDS / sizeof *KINDS) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the contact's damping is %d, which is no JpDamping", (int)contact->damping);
    }
    REFUSAL_TRY(refusal_of_positive(contact->speed_floor, "the contact's speed floor", error));
    switch (contact->damping) {
    case JP_DAMPING_NONE:
        return JP_OK;
    case JP_DAMPING_VISCOUS:
        return refusal_of_negative(contact->damper, "the contact's damper", error);
    case JP_DAMPING_STEP:
        REFUSAL_TRY(refusal_of_negative(contact->damper, "the contact's damper", error));
        return refusal_of_positive(contact->full_damping_depth,
                                   "the contact's depth of full damping", error);
    case JP_DAMPING_DISSIPATION:
        return refusal_of_negative(contact->dissipation, "the contact's dissipation", error);
    default:
        REFUSAL_TRY(
            refusal_of_negative(contact->resting_speed, "the contact's resting speed", error));
        return check_restitution(contact, error);
    }
}

JpStatus contact_law(const JpContact *contact, ForceLaw *law, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(contact, "the contact", error));
    REFUSAL_TRY(check_elastic(contact, error));
    REFUSAL_TRY(check_damping(contact, error));
    *law = contact->play > 0.0
               ? force_law_conforming(contact->stiffness, contact->play, contact->series)
           : contact->compliance == 0.0
               ? force_law_power(contact->stiffness, contact->exponent)
               : force_law_logarithmic(contact->compliance, contact->offset);
    if (contact->play > 0.0 && !force_law_is_sound(law)) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the contact's series gives no force above 0 over a play of %g; "
                       "jp_contact_of_pin fills both in",
                       contact->play);
    }
    if (!force_law_is_sound(law)) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the contact's compliance is %g and its offset %g, which is out of a "
                       "double's range",
                       contact->compliance, contact->offset);
    }
    law->impact_speed_floor = contact->speed_floor;
    if (contact->damping == JP_DAMPING_VISCOUS || contact->damping == JP_DAMPING_STEP) {
        law->viscous = contact->damper;
        law->full_damping_depth =
            contact->damping == JP_DAMPING_STEP ? contact->full_damping_depth : 0.0;
    } else if (contact->damping == JP_DAMPING_DISSIPATION) {
        law_set_dissipation(contact->dissipation, law);
    } else if (contact->damping != JP_DAMPING_NONE) {
        law->resting_speed = contact->resting_speed;
        law->hysteresis = damping_factor(KINDS[contact->damping], contact->restitution);
    }
    return refusal_none(error);
}

JpStatus jp_contact_check(const JpContact *contact, JpError *error)
{
    ForceLaw unused;
    return contact_law(contact, &unused, error);
}

void contact_set_elastic(const ForceLaw *law, JpContact *contact)
{
    const bool is_power = law->family == FORCE_LAW_POWER;
    contact->stiffness =
        law->family == FORCE_LAW_CONFORMING ? law->conforming.stiffness : law->stiffness;
    contact->exponent = is_power ? law->exponent : 1.0;
    contact->compliance = law->compliance;
    contact->offset = law->offset;
    contact->play = law->conforming.play;
    memcpy(contact->series, law->conforming.series, sizeof contact->series);
}

JpStatus jp_contact_of_pin(JpPinLaw kind, const JpPin *pin, JpContact *contact, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(pin, "the pin", error));
    REFUSAL_TRY(refusal_of_null(contact, "the contact", error));
    if ((size_t)kind >= sizeof PIN_LAWS / sizeof *PIN_LAWS) {
        return refusal(error, JP_ERROR_ARGUMENT, "the law is %d, which is no JpPinLaw", (int)kind);
    }
    REFUSAL_TRY(refusal_of_positive(pin->hole_radius, "the hole's radius", error));
    REFUSAL_TRY(refusal_of_positive(pin->pin_radius, "the pin's radius", error));
    REFUSAL_TRY(refusal_of_positive(pin->youngs_modulus, "Young's modulus", error));
    REFUSAL_TRY(refusal_of_negative(pin->width, "the pin's width", error));
    REFUSAL_TRY(refusal_of_negative(pin->pin_modulus, "the pin's Young's modulus", error));
    REFUSAL_TRY(refusal_of_negative(pin->eye_radius, "the eye's radius", error));
    const ContactPair pair = {
        .hole_radius = pin->hole_radius,
        .pin_radius = pin->pin_radius,
        .width = pin->width,
        .youngs_modulus = pin->youngs_modulus,
        .poisson_ratio = pin->poisson_ratio,
        .pin_modulus = pin->pin_modulus,
        .pin_ratio = pin->pin_modulus > 0.0 ? pin->pin_ratio : 0.0,
        .eye_radius = pin->eye_radius,
    };
    Err refused = {ERR_NONE, ""};
    ForceLaw law;
    if (!law_make(PIN_LAWS[kind], &pair, &law, &refused)) {
        return refusal(error, JP_ERROR_ARGUMENT, "%s", refused.text);
    }
    contact_set_elastic(&law, contact);
    return refusal_none(error);
}

JpStatus jp_damper_of(double stiffness, double restitution, double mass, double *damper,
                      JpError *error)
{
    REFUSAL_TRY(refusal_of_null(damper, "the damper", error));
    REFUSAL_TRY(refusal_of_positive(stiffness, "the stiffness", error));
    REFUSAL_TRY(refusal_of_positive(mass, "the mass", error));
    REFUSAL_TRY(refusal_of_positive(restitution, "the restitution", error));
    if (restitution > 1.0) {
        return refusal(error, JP_ERROR_ARGUMENT, "the restitution is %g; it must not be above 1",
                       restitution);
    }
    const double found = 2.0 * damping_linear_ratio(restitution) * sqrt(stiffness) * sqrt(mass);
    REFUSAL_TRY(refusal_of_result(found, "the damper", error));
    *damper = found;
    return refusal_none(error);
}

JpStatus jp_restitution_of(double stiffness, double damper, double mass, double *restitution,
                           JpError *error)
{
    REFUSAL_TRY(refusal_of_null(restitution, "the restitution", error));
    REFUSAL_TRY(refusal_of_positive(stiffness, "the stiffness", error));
    REFUSAL_TRY(refusal_of_positive(mass, "the mass", error));
    REFUSAL_TRY(refusal_of_negative(damper, "the damper", error));
    const double ratio = damper / (2.0 * sqrt(stiffness) * sqrt(mass));
    REFUSAL_TRY(refusal_of_result(ratio, "the ratio of damping", error));
    *restitution = damping_linear_restitution(ratio);
    return refusal_none(error);
}
