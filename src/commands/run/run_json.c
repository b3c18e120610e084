// What do other programs read of the runs of a case?
#include "commands/run/run_report.h"
#include "commands/run/slide_range.h"
#include "model/coordinate.h"
#include "write/joint_units.h"
#include "write/json_value.h"
#include "write/settings_json.h"
#include "write/units.h"

#include <inttypes.h>
#include <stdio.h>

// A number whose key ends in its unit.
static void set_in(json_t *object, const char *name, const char *unit, double value)
{
    char key[64];
    snprintf(key, sizeof key, "%s_%s", name, unit);
    json_value_set(object, key, value);
}

static json_t *bodies_object(const Linkage *linkage, const Trajectory *run)
{
    json_t *bodies = json_object();
    for (size_t i = 0; i < linkage->body_count; i++) {
        if ((int)i != linkage_driven_body(linkage)) {
            json_t *body = fields_json(RUN_BODY_FIELDS, FIELD_JSON, &run->bodies[i]);
            spike_json_set(body, RUN_ALPHA, linkage, &run->alpha_spikes[i]);
            json_object_set_new(bodies, linkage->bodies[i].name, body);
        }
    }
    return bodies;
}

static json_t *contacts_array(const Joint *joint, const JointExtremes *extremes, bool is_felt)
{
    const unsigned where = FIELD_JSON | run_report_contact(joint);
    json_t *contacts = json_array();
    for (size_t i = 0; is_felt && i < extremes->spike_count; i++) {
        json_array_append_new(contacts,
                              fields_json(RUN_CONTACT_FIELDS, where, &extremes->spikes[i]));
    }
    return contacts;
}

// Of a slider, at the samples; and of a block how it tilts.
static void set_slide(json_t *object, const Linkage *linkage, const Trajectory *run, size_t number,
                      bool is_felt)
{
    const Joint *joint = &linkage->joints[number];
    const SlideRange range = slide_range_find(linkage, run, number);
    json_value_set(object, "slide_min_m", range.position[0].value);
    json_value_set(object, "slide_max_m", range.position[1].value);
    json_value_set(object, "slide_velocity_min_m_s", range.velocity[0].value);
    json_value_set(object, "slide_velocity_max_m_s", range.velocity[1].value);
    json_value_set(object, "slide_acceleration_min_m_s2", range.acceleration[0].value);
    json_value_set(object, "slide_acceleration_max_m_s2", range.acceleration[1].value);
    if (joint->kind == JOINT_GUIDE) {
        json_value_set(object, "tilt_max_rad", is_felt ? run->joints[number].tilt_max.value : NAN);
        json_value_set(object, "tilt_limit_rad", linkage_guide_tilt(&joint->guide));
        json_value_set(object, "resultant_max_N", is_felt ? range.resultant.value : NAN);
    }
}

// The ends of a limited coordinate, and where it was at the samples.
static void set_limits(json_t *object, const Linkage *linkage, const Trajectory *run, size_t number)
{
    const Joint *joint = &linkage->joints[number];
    const char *unit = joint_units(joint)->length_key;
    double least = INFINITY;
    double most = -INFINITY;
    for (size_t i = 0; i < run->sample_count; i++) {
        const double now =
            linkage->is_spatial
                ? trajectory_state(run, i, number)->tilt
                : coordinate_position(linkage, trajectory_motion(run, i, 0), (int)number);
        least = fmin(least, now);
        most = fmax(most, now);
    }
    set_in(object, "limit_low", unit, coordinate_low(joint));
    set_in(object, "limit_high", unit, coordinate_high(joint));
    set_in(object, "coordinate_min", unit, least);
    set_in(object, "coordinate_max", unit, most);
}

static json_t *joint_object(const Linkage *linkage, const Trajectory *run, size_t number)
{
    const Joint *of = &linkage->joints[number];
    const bool has_play = linkage_has_play(of);
    const RunJoint numbers = run_fields_joint(linkage, run, number);
    const unsigned where =
        FIELD_JSON | run_report_contact(of) | (linkage->is_spatial ? RUN_SPATIAL : 0);
    json_t *joint = fields_json(RUN_JOINT_FIELDS, where, &numbers);
    if (slide_range_has(of)) {
        set_slide(joint, linkage, run, number, numbers.is_felt);
    }
    json_object_set_new(joint, "has_play", json_boolean(has_play));
    if (of->limits.kind != LIMIT_NONE) {
        set_limits(joint, linkage, run, number);
    } else if (has_play && of->kind != JOINT_STOP) {
        json_value_set(joint, "radial_clearance_m", linkage_radial_clearance(of));
    }
    json_object_set_new(joint, "spikes", contacts_array(of, &run->joints[number], numbers.is_felt));
    spike_json_set(joint, run_report_force(of), linkage, &run->force_spikes[number]);
    return joint;
}

static json_t *joints_object(const Linkage *linkage, const Trajectory *run)
{
    json_t *joints = json_object();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        json_object_set_new(joints, linkage->joints[i].name, joint_object(linkage, run, i));
    }
    return joints;
}

static json_t *run_object(const RunReport *report, size_t index)
{
    const Trajectory *run = report->runs[index];
    const Linkage *linkage = &report->scenario->linkage;
    json_t *object = fields_json(RUN_FIELDS, FIELD_JSON, run);
    if (!run->is_complete) {
        return object;
    }
    json_object_set_new(object, "bodies", bodies_object(linkage, run));
    json_object_set_new(object, "joints", joints_object(linkage, run));
    json_object_set_new(object, "error", run_truth_json_error(report, index));
    json_object_set_new(object, "energy", fields_json(RUN_ENERGY_FIELDS, FIELD_JSON, &run->energy));
    json_object_set_new(object, "spike_bands", spike_json_bands(report, run));
    json_object_set_new(object, "spike_match", run_truth_json_matches(report, index));
    json_object_set_new(object, "ensemble", run_truth_json_ensemble(report, index));
    json_object_set_new(object, "hash", json_sprintf("%016" PRIx64, run->hash));
    return object;
}

// Why something is missing.
static json_t *message_object(const char *message)
{
    json_t *object = json_object();
    json_object_set_new(object, "message", json_value_text(message));
    return object;
}

json_t *run_json_build(const void *of)
{
    const RunReport *report = of;
    json_t *object = json_object();
    settings_json_begin(object, report->scenario);
    if (report->summary != NULL) {
        json_object_set_new(object, "kinematics", analytic_json_kinematics(report));
        json_object_set_new(object, "inverse_dynamics", analytic_json_forces(report));
    } else if (report->no_summary != NULL) {
        json_object_set_new(object, "kinematics", message_object(report->no_summary));
        json_object_set_new(object, "inverse_dynamics", message_object(report->no_summary));
    }
    if (report->stackup != NULL && report->stackup->has_sources) {
        json_object_set_new(object, "stackup", analytic_json_stackup(report));
    } else if (report->no_stackup != NULL) {
        json_object_set_new(object, "stackup", message_object(report->no_stackup));
    }
    json_object_set_new(object, "truth", run_truth_json_truth(report));
    json_t *runs = json_array();
    for (size_t i = 0; i < report->run_count; i++) {
        json_array_append_new(runs, run_object(report, i));
    }
    json_object_set_new(object, "runs", runs);
    return object;
}
