// Checks that the values of a joint with play fit together.
#include "casefile/check_joints.h"

#include "casefile/cam.h"
#include "casefile/limits.h"
#include "casefile/slot.h"
#include "contact/damping.h"
#include "contact/eye.h"
#include "contact/law.h"

#include <math.h>

// Whether the stiffness of a joint is that of a law of its sizes.
static bool needs_sizes(const Scenario *scenario, const Joint *joint)
{
    const ContactOptions *contact = &scenario->contact;
    return contact->model == CONTACT_IMPACT && contact->stiffness == 0.0 &&
           joint->contact.stiffness == 0.0;
}

// Whether the law's force depends on the length of the cylinders.
static bool needs_width(const Scenario *scenario, const Joint *joint)
{
    const ContactOptions *contact = &scenario->contact;
    return law_get(contact->law)->needs_width && needs_sizes(scenario, joint);
}

static bool check_sizes(const Entries *entries, size_t index, const Joint *joint, Err *err)
{
    const Entry *hole = entries_find(entries, "joints.*.hole", index);
    const Entry *pin = entries_find(entries, "joints.*.pin", index);
    if (hole == NULL || linkage_radial_clearance(joint) > 0.0) {
        return true;
    }
    if (pin == NULL) {
        return entries_refuse(hole, err,
                              "in the middle of its limits the pin of the fit %.60s is not smaller "
                              "than the hole\nallowed: a fit with play, such as 30 H7/g6",
                              hole->node->text);
    }
    const Entry *culprit = entries_blame(entries, "joints.*.pin joints.*.hole", index);
    const bool hole_is_new = culprit == hole;
    return entries_refuse(
        culprit, err, "the pin (%.60s) must be smaller than the hole (%.60s)\nallowed: %s %.60s",
        pin->node->text, hole->node->text, hole_is_new ? "a hole above" : "a pin below",
        hole_is_new ? pin->node->text : hole->node->text);
}

// The elastic law's eye has a wall that counts.
static bool check_eye(const Entries *entries, size_t index, const Joint *joint, Err *err)
{
    const Entry *eye = entries_find(entries, "joints.*.eye-radius", index);
    const double least = EYE_LEAST * joint->clearance.hole_radius;
    return eye == NULL || joint->clearance.eye_radius >= least ||
           entries_refuse(eye, err,
                          "the eye of joint %s (%.60s) is hardly larger than its hole\nallowed: "
                          "%.6g mm, %.2g times the hole's radius, or more",
                          joint->name, eye->node->text, 1e3 * least, EYE_LEAST);
}

static bool check_pin(const Entries *entries, size_t index, const Scenario *scenario, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    const EntryGroup *group = entries_group(entries, "joints.*", index);
    if (!check_sizes(entries, index, joint, err) || !check_eye(entries, index, joint, err)) {
        return false;
    }
    const double radial = linkage_radial_clearance(joint);
    const double start = vec2_length(joint->clearance.start);
    if (!(start <= radial)) {
        return entries_refuse(
            entries_blame(entries,
                          "joints.*.start joints.*.at-b joints.*.at-a joints.*.radial-clearance "
                          "joints.*.hole joints.*.pin",
                          index),
            err,
            "the pin %s %.6g um off the centre%s, inside the metal\n"
            "allowed: up to the radial clearance, %.6g um",
            joint->is_apart ? "stands" : "starts", 1e6 * start,
            joint->is_apart ? " of its hole" : "", 1e6 * radial);
    }
    const Entry *clearance = entries_find(entries, "joints.*.radial-clearance", index);
    if (needs_sizes(scenario, joint) && clearance != NULL &&
        entries_find(entries, "joints.*.pin", index) == NULL) {
        return entries_refuse(clearance, err,
                              "the law %s needs the diameter of the pin\nallowed: pin: 10 mm "
                              "beside radial-clearance, or contact.stiffness such as 6.6e10 "
                              "N/m^1.5",
                              OPTIONS_LAWS[law_options(&scenario->contact, joint).law]);
    }
    if (needs_width(scenario, joint) && joint->clearance.width == 0.0) {
        const Entry *law = entries_find(entries, "contact.law", 0);
        static const char FORMAT[] = "the law %s needs the width of joint %s\n"
                                     "allowed: width: 13 mm, or a law without it";
        const char *name = OPTIONS_LAWS[scenario->contact.law];
        return law != NULL && law->source->is_override
                   ? entries_refuse(law, err, FORMAT, name, joint->name)
                   : entries_refuse_group(group, err, FORMAT, name, joint->name);
    }
    return true;
}

// Blocks between guides and stops touch with a stiffness that is given: the laws of pins need the
// radii of pin and hole.
static bool check_stiffness(const Entries *entries, size_t index, const Scenario *scenario,
                            Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    const EntryGroup *group = entries_group(entries, "joints.*", index);
    const char *what = joint_words(joint->kind);
    if (scenario->contact.model != CONTACT_IMPACT) {
        return entries_refuse(entries_find(entries, "contact.model", 0), err,
                              "the poisson model is for pins in holes, and joint '%s' is "
                              "%s\nallowed: impact",
                              joint->name, what);
    }
    return joint->contact.stiffness > 0.0 || scenario->contact.stiffness > 0.0 ||
           entries_refuse_group(group, err,
                                "joint '%s', %s, needs a stiffness: the law %s is for pins in "
                                "holes\nallowed: stiffness: 1e8 N/m here or in contact",
                                joint->name, what,
                                OPTIONS_LAWS[law_chosen(scenario->contact.law, 0.0)]);
}

static bool check_guide(const Entries *entries, size_t index, const Scenario *scenario, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    const Guide *guide = &joint->guide;
    if (guide->opening == guide->height) {
        return entries_refuse(
            entries_blame(entries, "joints.*.block joints.*.guide", index), err,
            "the block is as high as the guide is wide: there is no play\nallowed: a block below "
            "%.6g mm, above it for a sleeve round a rod, or no guide, block and length",
            1e3 * guide->opening);
    }
    const double play = linkage_radial_clearance(joint);
    const double gap = linkage_guide_gap(guide, guide->start.x, guide->start.y);
    if (!(gap >= -LINKAGE_SEATED * play)) {
        return entries_refuse(entries_blame(entries,
                                            "joints.*.start joints.*.block joints.*.guide "
                                            "joints.*.length",
                                            index),
                              err,
                              "the block starts %.6g um inside the metal\nallowed: up to %.6g um "
                              "off the middle where it is not tilted, or centred",
                              -1e6 * gap, 1e6 * play);
    }
    return check_stiffness(entries, index, scenario, err);
}

// A joint's own restitution needs a damping that has a factor for it.
static bool check_restitution(const Entries *entries, size_t index, const Scenario *scenario,
                              Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    const Entry *own = entries_find(entries, "joints.*.restitution", index);
    return own == NULL || joint->contact.restitution > 0.0 ||
           scenario->contact.model != CONTACT_IMPACT ||
           isfinite(damping_factor(scenario->contact.damping, 0.0)) ||
           entries_refuse(own, err,
                          "damping %s has no finite factor at restitution 0\nallowed: above 0 "
                          "and up to 1, or another damping",
                          OPTIONS_DAMPINGS[scenario->contact.damping]);
}

// A joint has one damping, with all that this needs.
static bool check_damping(const Entries *entries, size_t index, const Scenario *scenario, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    const JointContact *own = &joint->contact;
    if (own->dissipation > 0.0 && (own->viscous > 0.0 || own->full_depth > 0.0)) {
        return entries_refuse(entries_find(entries, "joints.*.dissipation", index), err,
                              "joint '%s' has two dampings\nallowed: a viscous-coefficient or a "
                              "dissipation",
                              joint->name);
    }
    const bool has_coefficient =
        own->viscous > 0.0 || (!linkage_is_torsional(joint) &&
                               law_options(&scenario->contact, joint).viscous_coefficient > 0.0);
    return own->full_depth == 0.0 || has_coefficient ||
           entries_refuse(entries_find(entries, "joints.*.full-damping-depth", index), err,
                          "joint '%s' has a full-damping-depth and no "
                          "viscous-coefficient\nallowed: viscous-coefficient: %s here",
                          joint->name, linkage_is_torsional(joint) ? "0.1 N m s/rad" : "100 N s/m");
}

static bool check_joint(const Entries *entries, size_t index, const Scenario *scenario, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    if (!check_damping(entries, index, scenario, err)) {
        return false;
    }
    if (joint_has_teeth(joint->kind) || joint->limits.kind != LIMIT_NONE) {
        return limits_check(entries, index, scenario, err) &&
               check_restitution(entries, index, scenario, err);
    }
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        return check_pin(entries, index, scenario, err) &&
               check_restitution(entries, index, scenario, err);
    case JOINT_TOUCHES_GUIDES:
        return check_guide(entries, index, scenario, err) &&
               check_restitution(entries, index, scenario, err);
    case JOINT_TOUCHES_DISC:
        return slot_check(entries, index, joint, err) &&
               cam_check(entries, index, &scenario->linkage, err) &&
               check_stiffness(entries, index, scenario, err) &&
               check_restitution(entries, index, scenario, err);
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_TEETH:
        break;
    }
    return true;
}

bool check_joints(const Entries *entries, const Scenario *scenario, Err *err)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (!check_joint(entries, i, scenario, err)) {
            return false;
        }
    }
    return true;
}
