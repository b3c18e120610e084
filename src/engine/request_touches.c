// Writes what touches in a case, but for pins in holes, as a part of the request of the driver
// protocol (docs/drivers.md): the places that the solvers see (contact/touch.h), each with its law.
#include "engine/protocol.h"

#include "contact/touch.h"

#include <stdlib.h>

static const char *word_of(TouchShape shape)
{
    switch (shape) {
    case TOUCH_HOLE:
        return "hole";
    case TOUCH_DISC:
        return "disc";
    case TOUCH_LINE:
        return "line";
    case TOUCH_CAM:
        return "cam";
    case TOUCH_SLOT:
        return "slot";
    case TOUCH_TURN:
        return "turn";
    case TOUCH_TEETH:
        return "teeth";
    case TOUCH_RACK:
        return "rack";
    }
    return "nothing";
}

static json_t *profile_object(const Profile *profile)
{
    json_t *points = json_array();
    for (size_t i = 0; i < profile->count; i++) {
        json_array_append_new(points, engine_pair((Vec2){profile->angles[i], profile->radii[i]}));
    }
    return json_pack("{s:o, s:f}", "points", points, "period_rad", profile->period);
}

static json_t *table_of(const Linkage *linkage, size_t number)
{
    return number > 0 ? profile_object(&linkage->profiles[number - 1]) : json_null();
}

// What a shape has beside what all have.
static void add_own(const Linkage *linkage, const Touch *place, json_t *object)
{
    const Joint *joint = &linkage->joints[place->joint];
    if (place->shape == TOUCH_CAM) {
        json_object_set_new(object, "is_flat", json_boolean(place->cam.is_flat));
        json_object_set_new(object, "facing_rad", json_real(place->cam.facing));
        json_object_set_new(object, "profile", profile_object(place->cam.profile));
    }
    if (place->shape == TOUCH_TEETH) {
        json_object_set_new(object, "middle_m", json_real(joint->limits.middle));
        json_object_set_new(object, "pressure_angle_rad", json_real(joint->gear.pressure_angle));
        json_object_set_new(object, "zero_rad", json_real(joint->gear.zero));
        json_object_set_new(object, "transmission_error", table_of(linkage, joint->gear.error));
        json_object_set_new(object, "relief", table_of(linkage, joint->gear.relief));
    }
}

static json_t *touch_object(const Linkage *linkage, const Touch *place)
{
    const Joint *joint = &linkage->joints[place->joint];
    const bool has_corners = joint_has_guides(joint->kind);
    // a rack's pitch circle is a line, of no radius in JSON
    const double radius_a = place->shape == TOUCH_RACK ? 0.0 : place->radius_a;
    json_t *object = json_pack(
        "{s:i, s:s, s:o, s:o, s:f, s:f, s:f, s:f, s:f, s:f, s:[i, i], s:o, s:o}", "joint",
        place->joint, "shape", word_of(place->shape), "anchor_a_m", engine_pair(place->anchor_a),
        "anchor_b_m", engine_pair(place->anchor_b), "direction_rad", place->direction, "clearance",
        place->clearance, "sign", place->sign, "radius_a_m", radius_a, "radius_b_m",
        place->radius_b, "half_length_m", place->half_length, "siblings",
        has_corners ? -place->place : 0, has_corners ? TOUCH_CORNERS - 1 - place->place : 0, "law",
        engine_law_object(&place->law), "contact",
        engine_contact_object(&joint->contacts[place->place]));
    add_own(linkage, place, object);
    return object;
}

bool engine_add_touches(const Scenario *scenario, json_t *request, Err *err)
{
    Touch *places;
    size_t count;
    if (!touch_list(scenario, &places, &count, err)) {
        return false;
    }
    json_t *touches = json_array();
    for (size_t i = 0; i < count; i++) {
        if (places[i].shape != TOUCH_HOLE) {
            json_array_append_new(touches, touch_object(&scenario->linkage, &places[i]));
        }
    }
    free(places);
    json_object_set_new(request, "touches", touches);
    return true;
}
