// Says how a contact began that is under way when its joint is made.
#include "world/play.h"

#include <math.h>

// A side of a joint by its number, and what is seen of it.
typedef struct Found {
    Place *place;
    size_t number; // of the side in its place
    JpSide side;
} Found;

static JpStatus find_of_pin(JpJoint *joint, size_t side, Found *found, JpError *error)
{
    JpPinState state;
    REFUSAL_TRY(jp_pin_state(joint, &state, error));
    if (side < joint->pin.hole_count) {
        *found = (Found){.place = &joint->places[side], .side = state.ends[side]};
    } else if (side >= PIN_ENDS && side < PIN_ENDS + SIDE_COUNT &&
               joint->place_count > joint->pin.hole_count) {
        *found = (Found){
            .place = &joint->places[joint->pin.hole_count],
            .number = side - PIN_ENDS,
            .side = state.collars[side - PIN_ENDS],
        };
    }
    return JP_OK;
}

static JpStatus find_of_line(JpJoint *joint, size_t side, Found *found, JpError *error)
{
    JpJointState state;
    REFUSAL_TRY(jp_joint_state(joint, &state, error));
    if (side < SIDE_COUNT) {
        *found = (Found){
            .place = &joint->places[0],
            .number = side,
            .side = side == 0 ? state.low : state.high,
        };
    }
    return JP_OK;
}

static void begin_side(const Found *found, const JpBegun *begun)
{
    Side *side = &found->place->sides[found->number];
    side->state = contact_state_begun(begun->impact_speed);
    side->state.age_s = side->age = begun->age;
    side->state.bend = 0.0 - begun->bend; // as place_bend has it
    side->state.is_released = begun->is_released || begun->is_resting;
    if (begun->is_resting && side->law.resting_speed > 0.0) {
        contact_state_rest(&side->state, side->law.resting_speed);
    }
    side->inside = -found->side.gap;
    found->place->inside[found->number].state.age_s = begun->age;
}

static JpStatus check_bend(const Found *found, const JpBegun *begun, JpError *error)
{
    const BristlePair *bristle = &found->place->bristle;
    const double most = bristle->law == BRISTLE_STICK ? bristle->limit : 0.0;
    return fabs(begun->bend) <= most
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT,
                         "the bend is %g m; the friction there bends by %g m at most", begun->bend,
                         most);
}

JpStatus jp_joint_begun(JpJoint *joint, size_t side, const JpBegun *begun, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(joint, "the joint", error));
    REFUSAL_TRY(refusal_of_null(begun, "how it began", error));
    REFUSAL_TRY(refusal_of_negative(begun->impact_speed, "the impact speed", error));
    REFUSAL_TRY(refusal_of_negative(begun->age, "the age", error));
    Found found = {.place = NULL};
    REFUSAL_TRY(joint->kind == PLAY_PIN ? find_of_pin(joint, side, &found, error)
                                        : find_of_line(joint, side, &found, error));
    if (found.place == NULL) {
        return refusal(error, JP_ERROR_ARGUMENT, "the joint has no side %zu", side);
    }
    if (!(found.side.gap < 0.0)) {
        return refusal(error, JP_ERROR_NONE, "side %zu does not touch: its gap is %g", side,
                       found.side.gap);
    }
    REFUSAL_TRY(check_bend(&found, begun, error));
    begin_side(&found, begun);
    return refusal_none(error);
}
