// Copies and frees what is known of a settled motion, and finds the loudest of several.
#include "model/settled.h"

#include "base/zeroed.h"

#include <stdlib.h>
#include <string.h>

// 1: by what a force has to exceed another's to be louder: the digits that a motion is told by
static const double LOUDER_LEAST = 0.01;

static SettledMotion copy_motion(const SettledMotion *motion, const Linkage *linkage)
{
    SettledMotion copy = *motion;
    copy.joints = zeroed_copy(motion->joints, linkage->joint_count, sizeof *motion->joints);
    copy.alpha = zeroed_copy(motion->alpha, linkage->body_count, sizeof *motion->alpha);
    copy.sections = zeroed_copy(motion->sections, motion->section_count * linkage->body_count,
                                sizeof *motion->sections);
    return copy;
}

void settled_motion_free(SettledMotion *motion)
{
    free(motion->joints);
    free(motion->alpha);
    free(motion->sections);
    *motion = (SettledMotion){0};
}

SettledStart settled_start_copy(const SettledStart *settled, const Linkage *linkage)
{
    SettledStart copy = *settled;
    copy.first = zeroed_copy(settled->first, linkage->joint_count, sizeof *settled->first);
    copy.motions = zeroed_copy(settled->motions, settled->motion_count, sizeof *settled->motions);
    for (size_t i = 0; i < settled->motion_count; i++) {
        copy.motions[i] = copy_motion(&settled->motions[i], linkage);
    }
    copy.others = NULL;
    return copy;
}

void settled_start_free(SettledStart *settled)
{
    for (size_t i = 0; i < settled->motion_count; i++) {
        settled_motion_free(&settled->motions[i]);
    }
    for (size_t i = 1; i < settled->motion_count && settled->others != NULL; i++) {
        linkage_free(&settled->others[i - 1]);
    }
    free(settled->others);
    free(settled->motions);
    free(settled->first);
    *settled = (SettledStart){0};
}

bool settled_is_louder(const SettledStart *settled, const Linkage *linkage, size_t *motion,
                       size_t *joint)
{
    double loudest = 1.0 + LOUDER_LEAST;
    bool is_louder = false;
    for (size_t k = 1; k < settled->motion_count; k++) {
        for (size_t i = 0; i < linkage->joint_count; i++) {
            const double shown = settled->motions[0].joints[i].force.headline;
            const double other = settled->motions[k].joints[i].force.headline;
            if (linkage_has_play(&linkage->joints[i]) && other > loudest * shown) {
                loudest = shown > 0.0 ? other / shown : loudest;
                *motion = k;
                *joint = i;
                is_louder = true;
            }
        }
    }
    return is_louder;
}
