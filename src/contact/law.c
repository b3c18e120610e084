// Makes the force law of a pin, its hole, their material and the case's options.
#include "contact/law.h"

#include "contact/damping.h"
#include "contact/eye.h"
#include "contact/penalty.h"

#include <math.h>

#define MEMBER(id, word, law) [id] = &law,
static const Law *const LAWS[] = {OPTIONS_LAW_LIST(MEMBER)};

const Law *law_get(LawKind kind)
{
    return LAWS[kind];
}

double law_effective_modulus(const ContactPair *pair)
{
    if (pair->pin_modulus == 0.0) {
        const MaterialOptions both = {pair->youngs_modulus, pair->poisson_ratio};
        return penalty_effective_modulus(&both);
    }
    const double hole = 1.0 - pair->poisson_ratio * pair->poisson_ratio;
    const double pin = 1.0 - pair->pin_ratio * pair->pin_ratio;
    return 1.0 / (hole / pair->youngs_modulus + pin / pair->pin_modulus);
}

static bool check_pair(LawKind kind, const ContactPair *pair, Err *err)
{
    const Law *law = law_get(kind);
    const char *name = OPTIONS_LAWS[kind];
    if (!(pair->pin_radius > 0.0 && pair->hole_radius > pair->pin_radius)) {
        return err_set(err, ERR_CASE, "the contact law %s needs a pin smaller than its hole", name);
    }
    if (!(pair->youngs_modulus > 0.0) || !(fabs(pair->poisson_ratio) < 1.0) ||
        !(pair->pin_modulus >= 0.0) || !(fabs(pair->pin_ratio) < 1.0)) {
        return err_set(err, ERR_CASE,
                       "the contact law %s needs a Young's modulus above 0 and a Poisson's ratio"
                       " between -1 and 1",
                       name);
    }
    if (law->needs_width && !(pair->width > 0.0)) {
        return err_set(err, ERR_CASE, "the contact law %s needs the width of the joint", name);
    }
    if (pair->eye_radius > 0.0 && pair->eye_radius < EYE_LEAST * pair->hole_radius) {
        return err_set(err, ERR_CASE,
                       "the eye's radius, %.6g mm, is not %.2g times that of its hole, %.6g mm",
                       1e3 * pair->eye_radius, EYE_LEAST, 1e3 * pair->hole_radius);
    }
    if (law->needs_force && !(pair->reference_force > 0.0)) {
        return err_set(err, ERR_CASE, "the contact law %s needs a reference force above 0", name);
    }
    return true;
}

bool law_make(LawKind kind, const ContactPair *pair, ForceLaw *law, Err *err)
{
    if (!check_pair(kind, pair, err)) {
        return false;
    }
    ForceLaw made;
    law_get(kind)->make(pair, &made);
    if (!force_law_is_sound(&made)) {
        return err_set(err, ERR_CASE,
                       "the contact law %s of these radii, this width and this material is out of a"
                       " double's range; are they in m and Pa?",
                       OPTIONS_LAWS[kind]);
    }
    *law = made;
    return true;
}

static double own_or(double own, double common)
{
    return own > 0.0 ? own : common;
}

ContactPair law_pair(const Clearance *clearance, const MaterialOptions *material, double speed)
{
    const bool is_one = clearance->modulus[0] == clearance->modulus[1] &&
                        clearance->poisson[0] == clearance->poisson[1];
    return (ContactPair){
        .hole_radius = clearance->hole_radius,
        .pin_radius = clearance->pin_radius,
        .width = clearance->width,
        .eye_radius = clearance->eye_radius,
        .youngs_modulus = own_or(clearance->modulus[0], material->youngs_modulus),
        .poisson_ratio = own_or(clearance->poisson[0], material->poisson_ratio),
        .pin_modulus = is_one ? 0.0 : own_or(clearance->modulus[1], material->youngs_modulus),
        .pin_ratio = is_one ? 0.0 : own_or(clearance->poisson[1], material->poisson_ratio),
        .reference_force = penalty_reference_force(speed),
    };
}

double law_restitution(const ForceLaw *law, double speed)
{
    return damping_delivered(law->hysteresis * speed / fmax(speed, law->impact_speed_floor));
}

// of the pin's radius: the laws are for depths small against it, and steel has yielded long before
static const double LAW_DEPTH_SHARE = 0.1;

bool law_build(const ContactOptions *contact, const MaterialOptions *material,
               const Clearance *clearance, double speed, ForceLaw *law, Err *err)
{
    ForceLaw built;
    if (contact->stiffness > 0.0) {
        built = force_law_power(contact->stiffness, contact->exponent);
    } else {
        const ContactPair pair = law_pair(clearance, material, speed);
        if (!law_make(contact->law, &pair, &built, err)) {
            return false;
        }
        built.depth_most = fmin(built.depth_most, LAW_DEPTH_SHARE * clearance->pin_radius);
    }
    built.impact_speed_floor = contact->impact_speed_floor;
    built.friction = contact->friction;
    built.friction_speed = contact->friction_speed;
    built.bristle = (BristlePair){.law = contact->friction_law,
                                  .ratio = contact->breakaway_ratio,
                                  .limit = contact->presliding,
                                  .speed = contact->friction_speed,
                                  .zeta = contact->presliding_damping};
    if (contact->model == CONTACT_POISSON && contact->restitution == 0.0) {
        built.hysteresis = 0.0; // some factors are infinite there, and its loss is the bounce
    } else if (contact->damping == DAMPING_VISCOUS) {
        built.viscous = contact->viscous_coefficient;
    } else if (contact->damping == DAMPING_STEP) {
        built.viscous = contact->viscous_coefficient;
        built.full_damping_depth = contact->full_damping_depth;
    } else if (contact->damping == DAMPING_DISSIPATION) {
        law_set_dissipation(contact->dissipation > 0.0
                                ? contact->dissipation
                                : damping_factor(contact->damping, contact->restitution) /
                                      contact->restitution_speed,
                            &built);
    } else {
        built.hysteresis = damping_factor(contact->damping, contact->restitution);
    }
    built.viscous *= contact->damping_scale;
    built.hysteresis *= contact->damping_scale;
    const bool has_memory = built.hysteresis > 0.0 && contact->damping != DAMPING_DISSIPATION;
    built.resting_speed = has_memory ? contact->resting_speed : 0.0;
    *law = built;
    return true;
}
