// Writes how the start of a scenario was found.
#include "write/settled.h"

#include "write/json_value.h"

static void append_joint(const SettledStart *settled, const Joint *joint, const SettledJoint *did,
                         Text *text)
{
    const char *unit = linkage_is_torsional(joint) ? "N m" : "N";
    text_append(text, "              ");
    text_append_shown(text, joint->name);
    text_append(text, ": %.5g %s", did->force, unit);
    if (settled->period == 0) {
        text_append(text,
                    " in the median revolution, %.4g to %.4g in 5 to 95 %%;\n"
                    "             ",
                    did->low, did->high);
    } else {
        text_append(text, ";");
    }
    text_append(text, " %.5g %s from the start, not counted\n", did->first, unit);
}

void settled_text(const Scenario *scenario, Text *text)
{
    const SettledStart *settled = &scenario->settled;
    if (settled->revolutions == 0) {
        return;
    }
    text_append(text, "  start       settled: ");
    if (settled->period > 0) {
        text_append(text, "repeats every ");
        if (settled->period > 1) {
            text_append(text, "%zu ", settled->period);
        }
        text_append(text, "revolution%s, found in %zu\n", settled->period > 1 ? "s" : "",
                    settled->revolutions);
    } else {
        text_append(text, "does not repeat in %zu revolutions\n", settled->revolutions);
    }
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (linkage_has_play(&scenario->linkage.joints[i])) {
            append_joint(settled, &scenario->linkage.joints[i], &settled->joints[i], text);
        }
    }
}

void settled_json(json_t *object, const Scenario *scenario)
{
    const SettledStart *settled = &scenario->settled;
    if (settled->revolutions == 0) {
        return;
    }
    json_t *joints = json_array();
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (!linkage_has_play(joint)) {
            continue;
        }
        const SettledJoint *did = &settled->joints[i];
        const bool is_turn = linkage_is_torsional(joint);
        json_t *of = json_object();
        json_object_set_new(of, "name", json_value_text(joint->name));
        json_value_set(of, is_turn ? "torque_max_Nm" : "force_max_N", did->force);
        json_value_set(of, is_turn ? "torque_max_low_Nm" : "force_max_low_N", did->low);
        json_value_set(of, is_turn ? "torque_max_high_Nm" : "force_max_high_N", did->high);
        json_value_set(of, is_turn ? "first_torque_max_Nm" : "first_force_max_N", did->first);
        json_value_set(of, "impacts_per_revolution", did->impacts);
        json_array_append_new(joints, of);
    }
    json_t *found = json_object();
    json_object_set_new(found, "revolutions", json_integer((json_int_t)settled->revolutions));
    json_object_set_new(found, "period", json_integer((json_int_t)settled->period));
    json_value_set(found, "change", settled->change);
    json_object_set_new(found, "joints", joints);
    json_object_set_new(object, "settled", found);
}
