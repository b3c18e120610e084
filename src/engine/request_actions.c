// Writes what acts on the bodies of a case beside joints and gravity as a part of the request of
// the driver protocol (docs/drivers.md): springs, torsion springs, bushings, and loads.
//
// A drive by torque is a load over time along its joint's coordinate; what it takes per speed, of a
// motor or a soft drive, is a torsion damper. A soft drive that follows phi_0 + w t by a spring k
// and a damper c is a torsion spring to the angle 0 with a load k (phi_0 + w t) + c w; one that is
// held has no w.
#include "engine/features.h"
#include "engine/protocol.h"

#include "model/loads.h"

#include <assert.h>
#include <stdio.h>

static const char TORQUE_NAME[] = "drive";

static bool has_torque(const Linkage *linkage)
{
    return linkage->torque.table.count > 0;
}

int engine_needs(const Scenario *scenario, char what[ENGINE_NEED_SIZE])
{
    const Linkage *linkage = &scenario->linkage;
    what[0] = '\0';
    if (engine_features_lack(scenario, 0, what)) {
        return 3;
    }
    for (size_t i = 0; linkage->gap_damper_count > 0 && i < linkage->joint_count; i++) {
        if (linkage->joints[i].contact.gap_damping > 0.0) {
            snprintf(what, ENGINE_NEED_SIZE, "damping in a gap ('%s')", linkage->joints[i].name);
            return 3;
        }
    }
    if (linkage->bushing_count > 0) {
        snprintf(what, ENGINE_NEED_SIZE, "bushings ('%s')", linkage->bushings[0].name);
        return 3;
    }
    if (linkage->spring_count > 0) {
        snprintf(what, ENGINE_NEED_SIZE, "springs ('%s')", linkage->springs[0].name);
    } else if (linkage->torsion_count > 0) {
        snprintf(what, ENGINE_NEED_SIZE, "torsion springs ('%s')", linkage->torsions[0].name);
    } else if (linkage->load_count > 0) {
        snprintf(what, ENGINE_NEED_SIZE, "loads ('%s')", linkage->loads[0].name);
    } else if (has_torque(linkage)) {
        snprintf(what, ENGINE_NEED_SIZE, "a drive by torque");
    }
    return what[0] == '\0' ? 1 : 2;
}

static json_t *spring_object(const Spring *spring)
{
    return json_pack("{s:s, s:i, s:i, s:o, s:o, s:f, s:f, s:f}", "name", spring->name, "body_a",
                     spring->body_a, "body_b", spring->body_b, "anchor_a_m",
                     engine_pair(spring->anchor_a), "anchor_b_m", engine_pair(spring->anchor_b),
                     "stiffness_N_m", spring->stiffness, "length_m", spring->length,
                     "damping_N_s_m", spring->damping);
}

static json_t *torsion_object(const char *name, int joint, double stiffness, double angle,
                              double damping)
{
    return json_pack("{s:s, s:i, s:f, s:f, s:f}", "name", name, "joint", joint, "stiffness_N_m_rad",
                     stiffness, "angle_rad", angle, "damping_N_m_s_rad", damping);
}

static json_t *curve_points(const ForceCurve *curve)
{
    json_t *points = json_array();
    for (size_t i = 0; i < curve->count; i++) {
        json_array_append_new(points, engine_pair((Vec2){curve->at[i], curve->values[i]}));
    }
    return points;
}

static json_t *bushing_object(const Bushing *bushing)
{
    json_t *object = json_pack(
        "{s:s, s:i, s:i, s:o, s:o, s:f, s:f, s:o, s:o, s:f, s:f}", "name", bushing->name, "body_a",
        bushing->body_a, "body_b", bushing->body_b, "anchor_a_m", engine_pair(bushing->anchor_a),
        "anchor_b_m", engine_pair(bushing->anchor_b), "direction_rad", bushing->direction,
        "angle_rad", bushing->angle, "stiffness_N_m", engine_pair(bushing->stiffness),
        "damping_N_s_m", engine_pair(bushing->damping), "stiffness_N_m_rad",
        bushing->torsional_stiffness, "damping_N_m_s_rad", bushing->torsional_damping);
    json_object_set_new(object, "shape", json_string(FORCE_CURVE_SHAPES[bushing->interpolation]));
    json_object_set_new(object, "force_x", curve_points(&bushing->force_x));
    json_object_set_new(object, "force_y", curve_points(&bushing->force_y));
    json_object_set_new(object, "torque", curve_points(&bushing->torque));
    return object;
}

// The damper in the gap of a pin, the only one whose joint the protocol has words for, is a bushing
// without stiffness.
static json_t *gap_object(const Joint *joint)
{
    const double damping = joint->contact.gap_damping;
    Bushing bushing = {.body_a = joint->body_a,
                       .body_b = joint->body_b,
                       .anchor_a = joint->anchor_a,
                       .anchor_b = joint->anchor_b,
                       .damping = {damping, damping}};
    snprintf(bushing.name, sizeof bushing.name, "%s", joint->name);
    return bushing_object(&bushing);
}

static json_t *load_object(const Linkage *linkage, const Load *load)
{
    json_t *object = json_pack("{s:s}", "name", load->name);
    if (load->kind == LOAD_ALONG) {
        json_object_set_new(object, "joint", json_integer(load->joint));
    } else {
        json_object_set_new(object, "body", json_integer(load->body));
    }
    if (load->kind == LOAD_FORCE) {
        json_object_set_new(object, "anchor_m", engine_pair(load->anchor));
        json_object_set_new(object, "direction_rad", json_real(load->direction));
        json_object_set_new(object, "turns_along", json_boolean(load->frame == LOAD_IN_BODY));
    }
    const bool is_by_crank = load->over == LOAD_OVER_CRANK;
    if (load_is_timed(linkage, load)) {
        const Driver *driver = &linkage->driver;
        json_object_set_new(object, "rate", json_real(is_by_crank ? driver->speed : 1.0));
        json_object_set_new(object, "shift",
                            json_real(load->shift + (is_by_crank ? driver->start : 0.0)));
    } else {
        json_object_set_new(object, "over_joint",
                            json_integer(is_by_crank ? linkage->torque.joint : load->joint));
        json_object_set_new(object, "shift", json_real(is_by_crank ? load->shift : 0.0));
    }
    json_t *points = json_array();
    for (size_t i = 0; i < load->table.count; i++) {
        json_array_append_new(points,
                              engine_pair((Vec2){load->table.at[i], load->table.values[i]}));
    }
    json_object_set_new(object, "points", points);
    engine_add_wave(&load->table.wave, object);
    json_object_set_new(object, "shape", json_string(LOAD_SHAPES[load->table.shape]));
    json_object_set_new(object, "period", json_real(load->table.period));
    return object;
}

// A load over time along the coordinate of the torque's joint, whose points are given apart.
static json_t *torque_object(const Linkage *linkage, json_t *points, double period_s)
{
    return json_pack("{s:s, s:i, s:f, s:f, s:o, s:s, s:f}", "name", TORQUE_NAME, "joint",
                     linkage->torque.joint, "rate", 1.0, "shift", 0.0, "points", points, "shape",
                     LOAD_SHAPES[LOAD_LINEAR], "period", period_s);
}

// The drive's torque, and what a motor or soft drive adds to it.
static void add_torque(const Scenario *scenario, json_t *torsions, json_t *loads)
{
    const Linkage *linkage = &scenario->linkage;
    const Torque *torque = &linkage->torque;
    json_t *points = json_array();
    for (size_t i = 0; i < torque->table.count; i++) {
        json_array_append_new(points,
                              engine_pair((Vec2){torque->table.times[i], torque->table.values[i]}));
    }
    json_array_append_new(loads, torque_object(linkage, points, torque->table.period_s));
    const Driver *followed = &torque->followed;
    const double stiffness = followed->is_present ? torque->stiffness : 0.0;
    if (stiffness > 0.0 || torque->slope > 0.0) {
        json_array_append_new(
            torsions, torsion_object(TORQUE_NAME, torque->joint, stiffness, 0.0, torque->slope));
    }
    if (followed->is_present) {
        const double end_s = 2.0 * scenario_duration(scenario); // engines go a step beyond the end
        const double held = drive_is_held(followed) ? followed->table.values[0] : 0.0;
        const double start = stiffness * (followed->start + held) + torque->slope * followed->speed;
        points = json_pack("[o, o]", engine_pair((Vec2){0.0, start}),
                           engine_pair((Vec2){end_s, start + stiffness * followed->speed * end_s}));
        json_array_append_new(loads, torque_object(linkage, points, 0.0));
    }
}

void engine_add_actions(const Scenario *scenario, json_t *request)
{
    const Linkage *linkage = &scenario->linkage;
    json_t *springs = json_array();
    json_t *torsions = json_array();
    json_t *bushings = json_array();
    json_t *loads = json_array();
    for (size_t i = 0; i < linkage->spring_count; i++) {
        json_array_append_new(springs, spring_object(&linkage->springs[i]));
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *of = &linkage->torsions[i];
        json_array_append_new(
            torsions, torsion_object(of->name, of->joint, of->stiffness, of->angle, of->damping));
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        json_array_append_new(bushings, bushing_object(&linkage->bushings[i]));
    }
    for (size_t i = 0; linkage->gap_damper_count > 0 && i < linkage->joint_count; i++) {
        if (linkage->joints[i].contact.gap_damping > 0.0) {
            json_array_append_new(bushings, gap_object(&linkage->joints[i]));
        }
    }
    for (size_t i = 0; i < linkage->load_count; i++) {
        json_array_append_new(loads, load_object(linkage, &linkage->loads[i]));
    }
    if (has_torque(linkage) && !engine_has_servo(linkage)) {
        add_torque(scenario, torsions, loads);
    }
    if (json_array_size(bushings) > 0) {
        json_object_set_new(request, "bushings", bushings);
    } else {
        json_decref(bushings); // protocol 2 has no word for it
    }
    json_object_set_new(request, "springs", springs);
    json_object_set_new(request, "torsion_springs", torsions);
    const int is_added = json_object_set_new(request, "loads", loads);
    assert(is_added == 0);
}
