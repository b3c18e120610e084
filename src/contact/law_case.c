// Makes the force law of a joint of a case.
#include "contact/damping.h"
#include "contact/law.h"
#include "model/joint_friction.h"

#include <math.h>

static void take_own_damping(const Joint *joint, ContactOptions *own)
{
    // one depth for all joints is a length
    const bool grows = own->damping == DAMPING_STEP && !linkage_is_torsional(joint);
    if (joint->contact.viscous > 0.0) {
        own->damping = grows ? DAMPING_STEP : DAMPING_VISCOUS;
        own->viscous_coefficient = joint->contact.viscous;
    }
    if (joint->contact.full_depth > 0.0) {
        own->damping = DAMPING_STEP;
        own->full_damping_depth = joint->contact.full_depth;
    }
    if (joint->contact.dissipation > 0.0) {
        own->damping = DAMPING_DISSIPATION;
        own->dissipation = joint->contact.dissipation;
    }
}

ContactOptions law_options(const ContactOptions *contact, const Joint *joint)
{
    ContactOptions own = *contact;
    own.law = law_chosen(own.law, joint->clearance.width);
    // one stiffness for all joints is one of lengths
    if (joint->contact.stiffness > 0.0 && (!contact->is_for_all || linkage_is_torsional(joint))) {
        own.stiffness = joint->contact.stiffness;
        own.exponent = joint->contact.exponent;
    }
    if (!contact->is_damping_for_all) {
        take_own_damping(joint, &own);
    }
    if (joint->contact.has_restitution) {
        own.restitution = joint->contact.restitution;
    }
    // that of an ideal joint is its own (model/joint_friction.h)
    if (joint->contact.has_friction && !joint_is_ideal(joint->kind)) {
        own.friction = joint->contact.friction;
    }
    const JointFriction friction = joint_friction_whole(contact, joint);
    own.friction_law = friction.law;
    own.friction_speed = friction.speed;
    own.breakaway_ratio = friction.ratio;
    own.presliding = friction.presliding;
    own.presliding_damping = friction.damping;
    return own;
}

bool law_is_asked(const Scenario *scenario)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (linkage_has_play(joint) && law_options(&scenario->contact, joint).stiffness == 0.0) {
            return true;
        }
    }
    return false;
}

bool law_has_friction(const Scenario *scenario)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (linkage_has_play(joint) && scenario_friction(scenario, joint) > 0.0) {
            return true;
        }
    }
    return false;
}

static const double LOOSEST = 3e-5;
static const double LOOSEST_AT_1 = 1e-5; // at chi 1
static const double LOOSEST_POWER = 0.6;
static const double CHI_MOST = 1e9; // beyond it rounding decides

double law_loosest_tolerance(const Scenario *scenario)
{
    double chi = 0.0; // largest
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (linkage_has_play(joint)) {
            const ContactOptions own = law_options(&scenario->contact, joint);
            chi = fmax(chi, damping_factor(own.damping, own.restitution));
        }
    }
    return fmin(LOOSEST, LOOSEST_AT_1 * pow(fmin(chi, CHI_MOST), -LOOSEST_POWER));
}

double law_reference_tolerance(const Scenario *scenario)
{
    return fmin(scenario->reference.tolerance, law_loosest_tolerance(scenario));
}

bool law_of_joint(const Scenario *scenario, const Joint *joint, ForceLaw *law, Err *err)
{
    const ContactOptions own = law_options(&scenario->contact, joint);
    if (!joint_has_hole(joint->kind) && own.stiffness == 0.0) {
        return err_set(err, ERR_CASE,
                       "joint '%s' needs a stiffness: the law %s is for a pin in its hole",
                       joint->name, OPTIONS_LAWS[own.law]);
    }
    if (!law_build(&own, &scenario->material, &joint->clearance, scenario->linkage.driver.speed,
                   law, err)) {
        err_prefix(err, joint->name);
        return false;
    }
    law->bristle.mass = joint_friction_mass(&scenario->linkage, joint);
    return true;
}

bool law_is_damped(const ContactOptions *contact)
{
    switch (contact->damping) {
    case DAMPING_VISCOUS:
    case DAMPING_STEP:
        return contact->viscous_coefficient > 0.0;
    case DAMPING_DISSIPATION:
        return contact->dissipation > 0.0 ||
               damping_factor(contact->damping, contact->restitution) > 0.0;
    default:
        return damping_factor(contact->damping, contact->restitution) > 0.0;
    }
}

bool law_has_damping(const Scenario *scenario)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        const ContactOptions own = law_options(&scenario->contact, joint);
        if (linkage_has_play(joint) && law_is_damped(&own)) {
            return true;
        }
    }
    return false;
}
