// Writes a resolved case as the request of the driver protocol (docs/drivers.md).
//
// Everything is in SI units; the settled start is resolved, with the contacts that it begins with.
// What the protocol has no words for is refused by name: a driver is never given half a case.
#include "engine/protocol.h"

#include "contact/law.h"
#include "engine/features.h"

#include <assert.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>

const char ENGINE_HELLO[] = "{\"jointplay-driver\": 1, \"ask\": \"hello\"}\n";

enum { REQUEST_FLAGS = JSON_REAL_PRECISION(17) | JSON_COMPACT };

bool engine_refuse(const char *engine, const char *what, Err *err)
{
    return err_set(err, ERR_CASE, "%s cannot run this case: its driver does not take %s", engine,
                   what);
}

// What the protocol calls a kind of joint.
static const char *word_of(JointKind kind)
{
    switch (kind) {
    case JOINT_REVOLUTE:
        return "revolute";
    case JOINT_CLEARANCE:
        return "pin-in-hole";
    case JOINT_PRISMATIC:
        return "prismatic";
    case JOINT_GUIDE:
        return "guide";
    case JOINT_STOP:
        return "stop";
    case JOINT_GEAR:
        return "gears";
    case JOINT_RACK:
        return "rack";
    case JOINT_KIND_COUNT:
        break;
    }
    return "joint";
}

static bool check_joint(const char *engine, const Joint *joint, Err *err)
{
    const char *lacks = joint->friction.law == BRISTLE_LUGRE ? "LuGre's friction" : NULL;
    char words[ENGINE_NEED_SIZE];
    snprintf(words, sizeof words, "%s (joint '%s')", lacks != NULL ? lacks : "", joint->name);
    return lacks == NULL || engine_refuse(engine, words, err);
}

bool engine_check(const char *engine, const Scenario *scenario, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    if (linkage->is_spatial) {
        return engine_refuse(engine, "a mechanism in space", err);
    }
    if (scenario->contact.model != CONTACT_IMPACT && scenario_has_clearance(scenario)) {
        return engine_refuse(engine, "contact.model: poisson", err);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (!check_joint(engine, &linkage->joints[i], err)) {
            return false;
        }
    }
    return true;
}

json_t *engine_pair(Vec2 value)
{
    return json_pack("[f, f]", value.x, value.y);
}

static json_t *body_object(const Body *body)
{
    const Motion *start = &body->start;
    return json_pack("{s:s, s:f, s:f, s:o, s:f, s:o, s:f}", "name", body->name, "mass_kg",
                     body->mass, "inertia_kg_m2", body->inertia, "position_m",
                     engine_pair(start->position), "angle_rad", start->angle, "velocity_m_s",
                     engine_pair(start->velocity), "omega_rad_s", start->omega);
}

static json_t *series_array(const ForceLaw *law)
{
    json_t *array = json_array();
    for (size_t i = 0; i < CONFORMING_TERMS; i++) {
        json_array_append_new(array, json_real(law->conforming.series[i]));
    }
    return array;
}

static json_t *elastic_object(const ForceLaw *law)
{
    switch (law->family) {
    case FORCE_LAW_POWER:
        return json_pack("{s:s, s:f, s:f}", "family", "power", "stiffness_N_m", law->stiffness,
                         "exponent", law->exponent);
    case FORCE_LAW_LOGARITHMIC:
        return json_pack("{s:s, s:f, s:f, s:f}", "family", "logarithmic", "compliance_m_N",
                         law->compliance, "offset", law->offset, "log_scale", law->log_scale);
    case FORCE_LAW_CONFORMING:
        break;
    }
    return json_pack("{s:s, s:f, s:f, s:o}", "family", "conforming", "stiffness_N_m",
                     law->conforming.stiffness, "play_m", law->conforming.play, "series",
                     series_array(law));
}

json_t *engine_law_object(const ForceLaw *law)
{
    json_t *object = elastic_object(law);
    const int is_added = json_object_update_new(
        object, json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "hysteresis", law->hysteresis,
                          "viscous_N_s_m", law->viscous, "full_damping_depth_m",
                          law->full_damping_depth, "impact_speed_floor_m_s",
                          law->impact_speed_floor, "resting_speed_m_s", law->resting_speed,
                          "friction", law->friction, "friction_speed_m_s", law->friction_speed));
    assert(is_added == 0);
    const BristlePair *bristle = &law->bristle;
    if (bristle->law == BRISTLE_STICK && law->friction > 0.0) {
        json_object_set_new(object, "bristle",
                            json_pack("{s:f, s:f, s:f, s:f, s:f}", "presliding_m", bristle->limit,
                                      "breakaway_ratio", bristle->ratio, "breakaway_speed_m_s",
                                      bristle->speed, "damping_ratio", bristle->zeta, "mass_kg",
                                      bristle->mass));
    }
    return object;
}

// A contact that is under way at the start, or null.
json_t *engine_contact_object(const ContactState *state)
{
    if (!state->is_touching) {
        return json_null();
    }
    json_t *object = json_pack("{s:b, s:b, s:b, s:f, s:f, s:f}", "is_slack", state->is_slack,
                               "is_released", state->is_released, "is_resting", state->is_resting,
                               "impact_speed_m_s", state->impact_speed, "damping_speed_m_s",
                               state->damping_speed, "age_s", state->age_s);
    if (state->bend != 0.0) {
        json_object_set_new(object, "bend_m", json_real(state->bend));
    }
    return object;
}

static json_t *joint_object(const Scenario *scenario, const Joint *joint, Err *err)
{
    json_t *object = json_pack("{s:s, s:s, s:i, s:i, s:o, s:o}", "name", joint->name, "kind",
                               word_of(joint->kind), "body_a", joint->body_a, "body_b",
                               joint->body_b, "anchor_a_m", engine_pair(joint->anchor_a),
                               "anchor_b_m", engine_pair(joint->anchor_b));
    if (joint_slides(joint->kind)) {
        json_object_set_new(object, "direction_rad", json_real(joint->direction));
        json_object_set_new(object, "held_angle_rad", json_real(joint->held_angle));
    }
    if (joint_has_hole(joint->kind)) {
        ForceLaw law;
        if (!law_of_joint(scenario, joint, &law, err)) {
            json_decref(object);
            return NULL;
        }
        json_object_set_new(object, "radial_clearance_m",
                            json_real(linkage_radial_clearance(joint)));
        json_object_set_new(object, "hole_radius_m", json_real(joint->clearance.hole_radius));
        json_object_set_new(object, "law", engine_law_object(&law));
        json_object_set_new(object, "contact", engine_contact_object(&joint->contacts[0]));
    }
    return object;
}

static json_t *times_array(const Scenario *scenario)
{
    json_t *times = json_array();
    for (size_t i = 0; i < scenario_sample_count(scenario); i++) {
        json_array_append_new(times, json_real(scenario_sample_time(scenario, i)));
    }
    return times;
}

static json_t *drive_object(const Linkage *linkage)
{
    const Driver *driver = &linkage->driver;
    return drive_is_steady(driver) ? json_pack("{s:i, s:i, s:f, s:f}", "joint", driver->joint,
                                               "body", linkage_driven_body(linkage), "speed_rad_s",
                                               driver->speed, "start_rad", driver->start)
                                   : json_null();
}

char *engine_request(const Scenario *scenario, const char *way, double record_s, bool wants_model,
                     Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    json_t *bodies = json_array();
    json_t *joints = json_array();
    bool is_whole = true;
    for (size_t i = 0; i < linkage->body_count; i++) {
        json_array_append_new(bodies, body_object(&linkage->bodies[i]));
    }
    for (size_t i = 0; is_whole && i < linkage->joint_count; i++) {
        json_t *joint = joint_object(scenario, &linkage->joints[i], err);
        is_whole = joint != NULL;
        if (is_whole) {
            json_array_append_new(joints, joint);
        }
    }
    char needed[ENGINE_NEED_SIZE];
    const int protocol = engine_needs(scenario, needed);
    json_t *request = json_pack(
        "{s:i, s:s, s:s, s:f, s:f, s:o, s:o, s:o, s:o, s:o}", "jointplay-driver", protocol, "ask",
        "run", "way", way, "step_s", scenario->run.step, "duration_s", scenario_duration(scenario),
        "gravity_m_s2", engine_pair(scenario_gravity(scenario)), "bodies", bodies, "joints", joints,
        "drive", drive_object(linkage), "sample_times_s", times_array(scenario));
    assert(request != NULL);
    if (protocol > 1) {
        engine_add_actions(scenario, request);
    }
    if (is_whole && engine_features_lack(scenario, 0, needed)) {
        engine_add_drives(scenario, request);
        engine_add_rubs(scenario, request);
        is_whole = engine_add_touches(scenario, request, err);
    }
    if (wants_model) {
        json_object_set_new(request, "model", json_true());
    }
    if (record_s > 0.0) {
        json_object_set_new(request, "record_s", json_real(record_s));
    }
    char *text = is_whole ? json_dumps(request, REQUEST_FLAGS) : NULL;
    json_decref(request);
    assert(text != NULL || !is_whole);
    return text;
}
