// Reads the slots of a case, and checks that their pins fit and start in them.
#include "casefile/slot.h"

#include "base/zeroed.h"
#include "contact/touch.h"

#include <stdlib.h>

bool slot_store(const Target *target, Stop *stop)
{
    const Node *node = target->entry->node;
    const Node *pair[2];
    TargetNumber length = {.value = 0.0};
    TargetNumber width = length;
    if (!target_pair(node, pair)) {
        return target_refuse(target, node->span, "%s takes its length and its width", target->path);
    }
    if (!target_number(target, pair[0], &length) || !target_number(target, pair[1], &width)) {
        return false;
    }
    stop->slot = length.value;
    stop->radius_a = 0.5 * width.value;
    return true;
}

bool slot_check(const Entries *entries, size_t index, const Joint *joint, Err *err)
{
    const Stop *stop = &joint->stop;
    const Entry *profile = entries_find(entries, "joints.*.profile", index);
    if (!linkage_has_slot(joint)) {
        return true;
    }
    if (profile != NULL) {
        return entries_refuse(
            entries_blame(entries, "joints.*.slot joints.*.profile", index), err,
            "the first body of joint '%s' has a slot and a profile\nallowed: one of the two",
            joint->name);
    }
    return stop->radius_b < stop->radius_a ||
           entries_refuse(entries_blame(entries, "joints.*.radius joints.*.slot", index), err,
                          "the pin is %.6g mm thick, in a slot %.6g mm wide\nallowed: a radius "
                          "below half the width",
                          2e3 * stop->radius_b, 2e3 * stop->radius_a);
}

bool slot_check_starts(const Entries *entries, const Linkage *linkage, Err *err)
{
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    bool is_inside = true;
    linkage_start(linkage, motions);
    for (int i = 0; is_inside && i < (int)linkage->joint_count; i++) {
        Touch places[TOUCH_CORNERS];
        if (!linkage_has_slot(&linkage->joints[i])) {
            continue;
        }
        touch_places(linkage, i, places);
        const double gap = touch_pose(linkage, &places[0], motions).gap;
        is_inside =
            gap >= -LINKAGE_SEATED * places[0].clearance ||
            entries_refuse(
                entries_blame(entries, "joints.*.at-b joints.*.at-a joints.*.slot joints.*.radius",
                              (size_t)i),
                err,
                "the pin of joint '%s' starts %.6g um inside the wall of its slot\nallowed: at-b "
                "no further than %.6g um from the slot's middle line",
                linkage->joints[i].name, -1e6 * gap, 1e6 * places[0].clearance);
    }
    free(motions);
    return is_inside;
}
