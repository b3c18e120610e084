// Writes how the start of a scenario was found as JSON.
#include "write/settled.h"

#include "run/drive_torque.h"
#include "write/json_value.h"
#include "write/units.h"

#include <stdio.h>

enum { KEY_SIZE = 64 };

static void set_part(json_t *object, const char *stem, const char *part, const char *unit,
                     double value)
{
    char key[KEY_SIZE];
    snprintf(key, sizeof key, "%s_%s_%s", stem, part, unit);
    json_value_set(object, key, value);
}

void settled_json_number(json_t *object, const char *stem, const char *unit,
                         const SettledNumber *number)
{
    set_part(object, stem, "max", unit, number->headline);
    set_part(object, stem, "max_low", unit, number->low);
    set_part(object, stem, "max_high", unit, number->high);
    set_part(object, stem, "median", unit, number->median);
    set_part(object, stem, "median_low", unit, number->median_low);
    set_part(object, stem, "median_high", unit, number->median_high);
    set_part(object, stem, "largest", unit, number->largest);
}

// The angular velocities at the ends of the revolutions of a motion, by body.
static json_t *sections_json(const Scenario *scenario, const SettledMotion *motion)
{
    const Linkage *linkage = &scenario->linkage;
    json_t *bodies = json_object();
    for (size_t i = 0; i < linkage->body_count; i++) {
        json_t *values = json_array();
        for (size_t k = 0; k < motion->section_count; k++) {
            json_array_append_new(values,
                                  json_value_real(motion->sections[k * linkage->body_count + i]));
        }
        json_object_set_new(bodies, linkage->bodies[i].name, values);
    }
    json_t *object = json_object();
    json_object_set_new(object, "bodies", bodies);
    return object;
}

static json_t *named(const char *name)
{
    json_t *object = json_object();
    json_object_set_new(object, "name", json_value_text(name));
    return object;
}

static json_t *joints_json(const Scenario *scenario, const SettledMotion *motion)
{
    json_t *joints = json_array();
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (!linkage_has_play(joint)) {
            continue;
        }
        const SettledJoint *did = &motion->joints[i];
        const JointUnits *units = joint_units(joint);
        const char *force = linkage_is_torsional(joint) ? "torque" : "force";
        json_t *of = named(joint->name);
        settled_json_number(of, force, units->force_key, &did->force);
        set_part(of, force, "max_from_start", units->force_key, scenario->settled.first[i]);
        settled_json_number(of, "penetration", units->length_key, &did->depth);
        json_value_set(of, "impacts_per_revolution", did->impacts.mean);
        json_value_set(of, "contact_fraction", did->contact.mean);
        json_array_append_new(joints, of);
    }
    return joints;
}

static json_t *bodies_json(const Scenario *scenario, const SettledMotion *motion)
{
    const Linkage *linkage = &scenario->linkage;
    json_t *bodies = json_array();
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (!linkage_is_driven(linkage, (int)i)) {
            json_t *of = named(linkage->bodies[i].name);
            settled_json_number(of, "alpha_size", "rad_s2", &motion->alpha[i]);
            json_array_append_new(bodies, of);
        }
    }
    return bodies;
}

static json_t *drives_json(const Scenario *scenario, const SettledMotion *motion)
{
    const Linkage *linkage = &scenario->linkage;
    json_t *drives = json_array();
    for (size_t i = 0; i < drive_torque_count(linkage); i++) {
        json_t *of = named(linkage->joints[linkage_drive(linkage, i)->joint].name);
        settled_json_number(of, "torque", "N_m", &motion->drives[i]);
        json_array_append_new(drives, of);
    }
    return drives;
}

static void set_count(json_t *object, const char *key, size_t count)
{
    json_object_set_new(object, key, json_integer((json_int_t)count));
}

static json_t *motion_json(const Scenario *scenario, const SettledMotion *motion)
{
    json_t *found = json_object();
    set_count(found, "starts", motion->starts);
    json_value_set(found, "share_low", motion->share_low);
    json_value_set(found, "share_high", motion->share_high);
    set_count(found, "period", motion->period);
    json_value_set(found, "change", motion->change);
    set_count(found, "counted_revolutions", motion->counted);
    set_count(found, "watched_revolutions", motion->watched);
    json_object_set_new(found, "joints", joints_json(scenario, motion));
    json_object_set_new(found, "bodies", bodies_json(scenario, motion));
    json_object_set_new(found, "drives", drives_json(scenario, motion));
    if (motion->section_count > 0) {
        json_object_set_new(found, "section_omega_rad_s", sections_json(scenario, motion));
    }
    return found;
}

// The joint that is louder in another motion than in that of the runs; null where none is.
static json_t *louder_json(const Scenario *scenario)
{
    const SettledStart *settled = &scenario->settled;
    size_t number;
    size_t joint;
    if (!settled_is_louder(settled, &scenario->linkage, &number, &joint)) {
        return json_null();
    }
    const Joint *of = &scenario->linkage.joints[joint];
    const SettledMotion *motion = &settled->motions[number];
    const char *force = linkage_is_torsional(of) ? "torque" : "force";
    json_t *object = json_object();
    json_object_set_new(object, "joint", json_value_text(of->name));
    settled_json_number(object, force, joint_units(of)->force_key, &motion->joints[joint].force);
    json_value_set(object, "ratio",
                   motion->joints[joint].force.headline /
                       settled->motions[0].joints[joint].force.headline);
    set_count(object, "starts", motion->starts);
    json_value_set(object, "share_low", motion->share_low);
    json_value_set(object, "share_high", motion->share_high);
    return object;
}

// By what small changes are multiplied in a period, and which body the largest is of; null where
// only the growth was found.
static void set_multipliers(json_t *found, const Scenario *scenario)
{
    const SettledGrowth *growth = &scenario->settled.growth;
    if (growth->multiplier_count == 0) {
        json_object_set_new(found, "multipliers", json_null());
        json_object_set_new(found, "growing_body", json_null());
        return;
    }
    json_t *multipliers = json_array();
    for (size_t i = 0; i < growth->multiplier_count; i++) {
        const double *value = growth->multipliers[i];
        json_array_append_new(multipliers, json_pack("[f,f]", value[0], value[1]));
    }
    json_object_set_new(found, "multipliers", multipliers);
    json_object_set_new(found, "growing_body",
                        json_string(scenario->linkage.bodies[growth->body].name));
}

// What of it is of the search and not of one motion.
static void set_search(json_t *found, const Scenario *scenario)
{
    const SettledStart *settled = &scenario->settled;
    set_count(found, "revolutions", settled->revolutions);
    set_count(found, "starts_tried", settled->tried);
    set_count(found, "starts_decided", settled->starts);
    json_object_set_new(found, "is_spent", json_boolean(settled->is_spent));
    json_value_set(found, "width", settled->width);
    json_object_set_new(found, "louder", louder_json(scenario));
    if (settled->has_growth) {
        json_value_set(found, "growth_per_revolution", settled->growth.factor);
        json_object_set_new(found, "growth_is_at_most", json_boolean(settled->growth.is_at_most));
        set_multipliers(found, scenario);
    }
}

void settled_json(json_t *object, const Scenario *scenario)
{
    const SettledStart *settled = &scenario->settled;
    if (scenario->run.centred_because[0] != '\0') {
        json_object_set_new(object, "starts_as_written_because",
                            json_string(scenario->run.centred_because));
    }
    if (settled->motion_count == 0) {
        return;
    }
    json_t *found = motion_json(scenario, &settled->motions[0]);
    set_search(found, scenario);
    json_t *others = json_array();
    for (size_t i = 1; i < settled->motion_count; i++) {
        json_array_append_new(others, motion_json(scenario, &settled->motions[i]));
    }
    json_object_set_new(found, "other_motions", others);
    json_object_set_new(object, "settled", found);
}
