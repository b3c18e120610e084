// Says what a program against libjointplay has no words for, of a mechanism and of a setting.
#include "commands/tune/tune_world.h"

#include "commands/tune/tune_bushings.h"
#include "commands/tune/tune_rubs.h"
#include "contact/law.h"

static const char *lacks_setting(const Scenario *scenario)
{
    const bool has_rows =
        scenario_has_clearance(scenario) && !scenario_integrates_contacts(scenario);
    if (scenario->ode.stepping == ODE_EXTRAPOLATED) {
        return "libjointplay does not extrapolate from several worlds; --schemes direct/staggered "
               "has a setting for it";
    }
    if (has_rows && scenario->ode.collider != ODE_COLLIDER_PIN_HOLE) {
        return "libjointplay has round holes and no polygons in their place";
    }
    return NULL;
}

static const char *lacks_joint(const Scenario *scenario, const Joint *joint)
{
    switch (joint->kind) {
    case JOINT_GUIDE:
        return "libjointplay has no block between guides";
    case JOINT_STOP:
        return linkage_has_slot(joint)
                   ? "libjointplay has no slot in which a pin plays"
                   : "libjointplay has no disc that meets a wall or another disc";
    case JOINT_GEAR:
        return "libjointplay has no pair of gears";
    case JOINT_RACK:
        return "libjointplay has no rack and pinion";
    case JOINT_REVOLUTE:
    case JOINT_CLEARANCE:
    case JOINT_PRISMATIC:
    case JOINT_KIND_COUNT:
        break;
    }
    const ContactOptions own = law_options(&scenario->contact, joint);
    if (linkage_has_play(joint) && own.friction_law != BRISTLE_REGULARIZED && own.friction > 0.0 &&
        !scenario_integrates_contacts(scenario)) {
        return "libjointplay has friction that sticks where it integrates contacts within the step "
               "alone";
    }
    const bool is_exact = own.damping == DAMPING_EXACT;
    return linkage_has_play(joint) && is_exact && scenario_restitution(scenario, joint) == 0.0
               ? "libjointplay has damping exact for restitutions above 0 alone"
               : NULL;
}

const char *tune_world_lacks(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    const char *lacks = lacks_setting(scenario);
    for (size_t i = 0; i < linkage->joint_count && lacks == NULL; i++) {
        lacks = lacks_joint(scenario, &linkage->joints[i]);
    }
    for (size_t i = 0; i < linkage->torsion_count && lacks == NULL; i++) {
        if (!joint_has_angle(linkage->joints[linkage->torsions[i].joint].kind)) {
            lacks = "the program has springs that turn the two sides of a hinge alone";
        }
    }
    if (lacks == NULL) {
        lacks = tune_bushings_lack(linkage);
    }
    if (lacks == NULL) {
        lacks = tune_rubs_lack(scenario);
    }
    if (linkage->gap_damper_count > 0 && lacks == NULL) {
        lacks = "the program has no damping within a gap";
    }
    return lacks;
}
