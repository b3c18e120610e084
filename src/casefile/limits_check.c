// Checks that the limits of a joint's coordinate go with the rest of the case.
#include "casefile/limits.h"

#include "base/zeroed.h"
#include "contact/touch.h"
#include "model/space_coordinate.h"

#include <math.h>

static const char *describe(const Joint *joint)
{
    return joint_has_teeth(joint->kind)           ? joint_words(joint->kind)
           : joint->limits.kind == LIMIT_BACKLASH ? "one with backlash"
                                                  : "one with stops";
}

// In which unit a stiffness, and a damping, of a joint's limits stand.
static const char *stiffness_example(const Joint *joint)
{
    return joint_has_angle(joint->kind) ? "500 N m/rad here" : "1e8 N/m here or in contact";
}

static bool check_order(const Entries *entries, size_t index, const Joint *joint, Err *err)
{
    const Limits *limits = &joint->limits;
    if (limits->kind == LIMIT_STOPS && !(limits->low < limits->high)) {
        return entries_refuse(entries_blame(entries, "joints.*.high joints.*.low", index), err,
                              "the stops of joint '%s' leave nothing between them\nallowed: a low "
                              "below the high",
                              joint->name);
    }
    // half of a gap, and what rounding makes of it
    return limits->kind != LIMIT_BACKLASH ||
           fabs(limits->start) <= (0.5 + LINKAGE_SEATED) * limits->backlash ||
           entries_refuse(entries_find(entries, "joints.*.start", index), err,
                          "joint '%s' starts beyond its backlash\nallowed: up to half of the "
                          "backlash to either side, or centred",
                          joint->name);
}

// Whether a pivot has a damping of its own where that of the contact is one of lengths.
static bool check_damping(const Entries *entries, size_t index, const Scenario *scenario, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    const ContactOptions *contact = &scenario->contact;
    const EntryGroup *group = entries_group(entries, "joints.*", index);
    const JointContact *own = &joint->contact;
    if (!joint_has_angle(joint->kind) || own->dissipation > 0.0) {
        return true;
    }
    if (own->viscous > 0.0) {
        return contact->damping != DAMPING_STEP || own->full_depth > 0.0 ||
               entries_refuse_group(group, err,
                                    "joint '%s', %s, needs its own full-damping-depth: that of "
                                    "the contact is a length\nallowed: full-damping-depth: 0.1 "
                                    "deg, or another contact.damping",
                                    joint->name, describe(joint));
    }
    if (contact->damping == DAMPING_VISCOUS || contact->damping == DAMPING_STEP) {
        return entries_refuse_group(group, err,
                                    "joint '%s', %s, needs its own viscous-coefficient: that of "
                                    "the contact is a force over a speed\nallowed: "
                                    "viscous-coefficient: 0.1 N m s/rad, or another "
                                    "contact.damping",
                                    joint->name, describe(joint));
    }
    return contact->damping != DAMPING_DISSIPATION || contact->dissipation == 0.0 ||
           entries_refuse_group(group, err,
                                "joint '%s', %s, needs its own dissipation: that of the contact "
                                "is by a speed\nallowed: dissipation: 0.3 s/rad, or another "
                                "contact.damping",
                                joint->name, describe(joint));
}

static bool check_contact(const Entries *entries, size_t index, const Scenario *scenario, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    const EntryGroup *group = entries_group(entries, "joints.*", index);
    const bool is_turning = joint_has_angle(joint->kind);
    if (scenario->contact.model != CONTACT_IMPACT) {
        return entries_refuse(entries_find(entries, "contact.model", 0), err,
                              "the poisson model is for pins in holes, and joint '%s' is "
                              "%s\nallowed: impact",
                              joint->name, describe(joint));
    }
    if (!(joint->contact.stiffness > 0.0) && (is_turning || !(scenario->contact.stiffness > 0.0))) {
        return entries_refuse_group(group, err,
                                    "joint '%s', %s, needs a stiffness\nallowed: stiffness: %s",
                                    joint->name, describe(joint), stiffness_example(joint));
    }
    return check_damping(entries, index, scenario, err);
}

bool limits_check(const Entries *entries, size_t index, const Scenario *scenario, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    if (scenario->linkage.is_spatial && !joint_is_spatial(joint->kind)) {
        return entries_refuse_group(entries_group(entries, "joints.*", index), err,
                                    "joint '%s' is %s, which is not available in space\nallowed: "
                                    "space: planar, or pivots and pins in holes",
                                    joint->name, describe(joint));
    }
    if (joint_has_teeth(joint->kind) && joint->limits.kind == LIMIT_NONE) {
        return entries_refuse_group(entries_group(entries, "joints.*", index), err,
                                    "joints.%s.backlash is missing\nallowed: a length at the pitch "
                                    "circle such as 0.1 mm, or an angle of the %s",
                                    joint->name,
                                    joint_has_rack(joint->kind) ? "pinion" : "second gear");
    }
    return check_order(entries, index, joint, err) && check_contact(entries, index, scenario, err);
}

// How deep the flanks of gears are in one another at their start, m.
static double overlap_of(const Linkage *linkage, const Motion *motions, int number)
{
    Touch flanks[TOUCH_CORNERS];
    double deepest = 0.0;
    const size_t count = touch_places(linkage, number, flanks);
    for (size_t i = 0; i < count; i++) {
        deepest = fmax(deepest, -touch_pose(linkage, &flanks[i], motions).gap);
    }
    return deepest;
}

// Whether gears start clear of one another, by their transmission error and relief.
static bool check_flanks(const Entries *entries, const Linkage *linkage, const Motion *motions,
                         int number, Err *err)
{
    const Joint *joint = &linkage->joints[number];
    const double overlap = overlap_of(linkage, motions, number);
    return overlap <= LINKAGE_SEATED * joint->limits.backlash ||
           entries_refuse(entries_blame(entries,
                                        "joints.*.start joints.*.transmission-error "
                                        "joints.*.relief joints.*.backlash",
                                        (size_t)number),
                          err,
                          "the gears of joint '%s' start %.4g um inside one another\nallowed: a "
                          "start in the gap that their transmission-error and relief leave",
                          joint->name, 1e6 * overlap);
}

bool limits_check_starts(const Entries *entries, const Linkage *linkage, Err *err)
{
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    bool is_right = true;
    for (size_t i = 0; is_right && i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const Limits *limits = &joint->limits;
        if (linkage_has_teeth_tables(joint)) {
            is_right = check_flanks(entries, linkage, motions, (int)i, err);
        }
        if (limits->kind != LIMIT_STOPS) {
            continue;
        }
        const double at = linkage->is_spatial ? space_coordinate_start(linkage, (int)i)
                                              : coordinate_position(linkage, motions, (int)i);
        const double rounding = LINKAGE_SEATED * fmin(limits->high - limits->low, 1.0);
        const bool is_turning = joint_has_angle(joint->kind);
        is_right =
            (at >= limits->low - rounding && at <= limits->high + rounding) ||
            entries_refuse(entries_blame(entries, "joints.*.low joints.*.high", i), err,
                           "joint '%s' starts at %.6g %s, beyond its stops\nallowed: stops to both "
                           "sides of where it starts",
                           joint->name, at * (is_turning ? 180.0 / M_PI : 1e3),
                           is_turning ? "deg" : "mm");
    }
    free(motions);
    return is_right;
}
