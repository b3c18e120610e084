// Checks that a case's values make bodies and pins in space.
#include "casefile/check_space.h"

#include "model/space.h"

#include <stdio.h>

bool check_space(const Entries *entries, const Scenario *scenario, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    if (linkage->is_spatial && entries->form == SCHEMA_SLIDER_CRANK) {
        return entries_refuse(entries_find(entries, "space", 0), err,
                              "a slider-crank moves in the plane only\nallowed: space: planar");
    }
    for (size_t i = 0; linkage->is_spatial && i < linkage->body_count; i++) {
        char path[SCHEMA_PATH_SIZE] = "bodies.*";
        if (entries->form != SCHEMA_LONG) {
            const SchemaFormRow *form = schema_form(entries->form);
            snprintf(path, sizeof path, "%s.%s", form->key, form->links[i]);
        }
        const size_t index = entries->form != SCHEMA_LONG ? 0 : i;
        if (!space_is_possible(&linkage->bodies[i])) {
            return entries_refuse_group(
                entries_group(entries, path, index), err,
                "no rigid body can have the moments and products of inertia of '%s'\nallowed: each "
                "moment at "
                "most the sum of the other two, and products that go with them",
                linkage->bodies[i].name);
        }
    }
    for (size_t i = 0; linkage->is_spatial && i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        // limits_check refuses teeth
        if (!joint_is_spatial(joint->kind) && !joint_has_teeth(joint->kind)) {
            return entries_refuse_group(entries_group(entries, "joints.*", i), err,
                                        "joint '%s' slides or stops, which is not available in "
                                        "space\nallowed: space: planar, or pins in holes",
                                        joint->name);
        }
        if (joint_has_hole(joint->kind) && joint->clearance.width == 0.0) {
            return entries_refuse_group(entries_group(entries, "joints.*", i), err,
                                        "in space the joint '%s' needs a width\nallowed: width: "
                                        "13 mm, or space: planar",
                                        joint->name);
        }
    }
    if (linkage->is_spatial && linkage->further_count > 0) {
        return entries_refuse_group(entries_group(entries, "drives", 0), err,
                                    "several drives are not available in space\nallowed: space: "
                                    "planar, or one drive");
    }
    if (linkage->is_spatial && linkage->driver.table.count > 0) {
        return entries_refuse(entries_blame(entries, "space drive.speed drive.angle", 0), err,
                              "in space a drive turns at constant speed\nallowed: a speed such as "
                              "1000 rpm, or space: planar");
    }
    return true;
}
