// Writes the friction of ideal joints as a part of the request of the driver protocol
// (docs/drivers.md), of a joint that turns in angles.
#include "engine/features.h"
#include "engine/protocol.h"

#include "model/joint_friction.h"

static const char *word_of(BristleMode mode)
{
    switch (mode) {
    case BRISTLE_STICKING:
        return "sticks";
    case BRISTLE_YIELDING_FORTH:
        return "yields-forth";
    case BRISTLE_YIELDING_BACK:
        return "yields-back";
    case BRISTLE_SLIDING_FORTH:
        return "slides-forth";
    case BRISTLE_SLIDING_BACK:
        return "slides-back";
    }
    return "sticks";
}

static json_t *bristle_object(const BristlePair *pair, const ContactState *start)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:s}", "presliding", pair->limit, "breakaway_ratio",
                     pair->ratio, "breakaway_speed", pair->speed, "damping_ratio", pair->zeta,
                     "bend", start->bend, "mode", word_of(start->bristle));
}

static json_t *rub_object(const Scenario *scenario, int number)
{
    const Joint *joint = &scenario->linkage.joints[number];
    const BristlePair pair = joint_friction_pair(&scenario->contact, joint);
    const double length = joint_slides(joint->kind) ? joint->friction.length : 0.0;
    json_t *object =
        json_pack("{s:i, s:f, s:b, s:f, s:f}", "joint", number, "friction",
                  joint_friction_over(joint), "is_steady", joint->friction.steady > 0.0, "length_m",
                  length, "friction_speed", pair.speed);
    if (pair.law == BRISTLE_STICK) {
        // the friction of an ideal joint is behind the places at which it touches
        json_object_set_new(object, "bristle",
                            bristle_object(&pair, &joint->contacts[JOINT_PLACES - 1]));
    }
    return object;
}

void engine_add_rubs(const Scenario *scenario, json_t *request)
{
    json_t *rubs = json_array();
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (engine_rubs(&scenario->linkage, i)) {
            json_array_append_new(rubs, rub_object(scenario, (int)i));
        }
    }
    json_object_set_new(request, "rubs", rubs);
}
