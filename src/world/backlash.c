// Makes, drives and reads backlash and stops on the coordinate of a hinge or slider.
#include "world/contact.h"
#include "world/fault.h"
#include "world/play.h"
#include "world/pressing_row.h"

#include <math.h>

JpBacklash jp_backlash_default(void)
{
    return (JpBacklash){.tooth = jp_contact_default()};
}

JpStops jp_stops_default(void)
{
    return (JpStops){.low = -INFINITY, .high = INFINITY, .contact = jp_contact_default()};
}

// The row of an angle. Returns false where ODE has no memory for it.
static bool make_motor(JpJoint *joint)
{
    PlaceRow *row = &joint->places[0].row;
    Fault fault;
    fault_begin(&fault);
    if (setjmp(fault.left) == 0) {
        row->motor = pressing_row_of_angle(joint->world->id, joint->bodies, &row->feedback);
    }
    fault_end(&fault);
    return row->motor != NULL;
}

static JpStatus make_joint(JpWorld *world, PlayKind kind, dJointID on, const ForceLaw *law,
                           const double limits[2], JpJoint **created, JpError *error)
{
    const Coordinate coordinate = coordinate_of(on);
    JpJoint *joint = play_add(world, kind, coordinate.bodies);
    if (joint == NULL) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for a joint");
    }
    joint->coordinate = coordinate;
    joint->place_count = 1;
    joint->places[0].shape = PLACE_LINE;
    for (int i = 0; i < SIDE_COUNT; i++) {
        joint->places[0].sides[i] =
            (Side){.law = *law, .sign = i == 0 ? 1.0 : -1.0, .limit = limits[i]};
    }
    if (coordinate.is_angle && !make_motor(joint)) {
        jp_joint_destroy(joint);
        return refusal(error, JP_ERROR_MEMORY, "ODE has no memory for the joint's motor");
    }
    *created = joint;
    return refusal_none(error);
}

JpStatus jp_backlash_create(JpWorld *world, dJointID on, const JpBacklash *backlash,
                            JpJoint **created, JpError *error)
{
    ForceLaw law;
    REFUSAL_TRY(refusal_of_null(created, "the pointer for the joint", error));
    REFUSAL_TRY(refusal_of_null(backlash, "the backlash", error));
    REFUSAL_TRY(play_check_joint(world, on, error));
    REFUSAL_TRY(refusal_of_negative(backlash->gap, "the gap", error));
    REFUSAL_TRY(refusal_of_finite(backlash->offset, "the gap's offset", error));
    REFUSAL_TRY(refusal_of_negative(backlash->rotor_inertia, "the rotor's inertia", error));
    REFUSAL_TRY(contact_law(&backlash->tooth, &law, error));
    const double limits[] = {backlash->offset - 0.5 * backlash->gap,
                             backlash->offset + 0.5 * backlash->gap};
    JpJoint *joint = NULL;
    REFUSAL_TRY(make_joint(world, PLAY_BACKLASH, on, &law, limits, &joint, error));
    joint->rotor_inertia = backlash->rotor_inertia;
    if (backlash->rotor_inertia > 0.0) {
        joint->rotor.inertia = backlash->rotor_inertia;
    }
    *created = joint;
    return JP_OK;
}

JpStatus jp_stops_create(JpWorld *world, dJointID on, const JpStops *stops, JpJoint **created,
                         JpError *error)
{
    ForceLaw law;
    REFUSAL_TRY(refusal_of_null(created, "the pointer for the joint", error));
    REFUSAL_TRY(refusal_of_null(stops, "the stops", error));
    REFUSAL_TRY(play_check_joint(world, on, error));
    if (!(stops->low < stops->high) || stops->low == INFINITY || stops->high == -INFINITY) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the stops are at %g and %g; the low one must be below the high one",
                       stops->low, stops->high);
    }
    REFUSAL_TRY(contact_law(&stops->contact, &law, error));
    const double limits[] = {stops->low, stops->high};
    return make_joint(world, PLAY_STOPS, on, &law, limits, created, error);
}

static JpStatus check_backlash(const JpJoint *joint, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(joint, "the joint", error));
    return joint->kind == PLAY_BACKLASH
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT,
                         "the joint has no backlash: nothing of it is driven");
}

JpStatus jp_backlash_drive(JpJoint *joint, double force, JpError *error)
{
    REFUSAL_TRY(check_backlash(joint, error));
    REFUSAL_TRY(refusal_of_finite(force, "the force on the rotor", error));
    if (!(joint->rotor_inertia > 0.0)) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the backlash has no rotor to be driven; give it a rotor_inertia");
    }
    joint->rotor.inertia = joint->rotor_inertia;
    joint->rotor.drive = force;
    return refusal_none(error);
}

JpStatus jp_backlash_hold(JpJoint *joint, double position, double stiffness, double damper,
                          JpError *error)
{
    REFUSAL_TRY(check_backlash(joint, error));
    REFUSAL_TRY(refusal_of_finite(position, "the position to be held", error));
    REFUSAL_TRY(refusal_of_negative(stiffness, "the servo's stiffness", error));
    REFUSAL_TRY(refusal_of_negative(damper, "the servo's damper", error));
    const Rotor *rotor = &joint->rotor;
    return jp_backlash_drive(
        joint, stiffness * (position - rotor->position) - damper * rotor->speed, error);
}

JpStatus jp_backlash_lead(JpJoint *joint, double position, double speed, JpError *error)
{
    REFUSAL_TRY(check_backlash(joint, error));
    REFUSAL_TRY(refusal_of_finite(position, "the rotor's position", error));
    REFUSAL_TRY(refusal_of_finite(speed, "the rotor's speed", error));
    joint->rotor = (Rotor){.inertia = INFINITY, .position = position, .speed = speed};
    return refusal_none(error);
}

JpStatus jp_joint_state(const JpJoint *joint, JpJointState *state, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(joint, "the joint", error));
    REFUSAL_TRY(refusal_of_null(state, "the state", error));
    if (joint->kind == PLAY_PIN || joint->kind == PLAY_FRICTION) {
        return refusal(error, JP_ERROR_ARGUMENT, "the joint is %s",
                       joint->kind == PLAY_PIN
                           ? "a pin in a hole; read it with jp_pin_state"
                           : "the friction of one of ODE; read it with jp_friction_state");
    }
    REFUSAL_TRY(play_check_bodies(joint, error));
    Coordinate coordinate = joint->coordinate; // so that reading changes nothing
    const Direction along = coordinate_direction(&coordinate);
    const Side *sides = joint->places[0].sides;
    const double position = coordinate_read(&coordinate);
    const double off = position - joint->rotor.position;
    const JpJointState found = {
        .position = position,
        .speed = direction_rate(&along),
        .rotor_position = joint->rotor.position,
        .rotor_speed = joint->rotor.speed,
        .force = sides[0].force - sides[1].force,
        .low = play_side(&sides[0], off),
        .high = play_side(&sides[1], off),
    };
    const double all = found.position + found.speed + found.rotor_position + found.rotor_speed;
    if (!isfinite(all) || !play_is_side_finite(&found.low) || !play_is_side_finite(&found.high)) {
        return refusal(error, JP_ERROR_WORLD, "the joint's state is out of a double's range");
    }
    *state = found;
    return refusal_none(error);
}
