// What is a joint with play made of, and how does it stand?
#include "world/play.h"

#include "world/contact.h"

#include <math.h>
#include <stdlib.h>

double play_rate(const JpJoint *joint)
{
    return coordinate_rate(&joint->coordinate) - joint->rotor.speed;
}

double play_position(JpJoint *joint)
{
    return coordinate_read(&joint->coordinate) - joint->rotor.position;
}

double play_mobility(const JpJoint *joint)
{
    return coordinate_mobility(&joint->coordinate) + 1.0 / joint->rotor.inertia;
}

JpBacklash jp_backlash_default(void)
{
    return (JpBacklash){.tooth = jp_contact_default()};
}

JpStops jp_stops_default(void)
{
    return (JpStops){.low = -INFINITY, .high = INFINITY, .contact = jp_contact_default()};
}

static JpStatus check_joint(const JpWorld *world, dJointID joint, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(refusal_of_null(joint, "the joint", error));
    const dJointType type = dJointGetType(joint);
    if (type != dJointTypeHinge && type != dJointTypeSlider) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the joint is of ODE's type %d; play is on a hinge or a slider", (int)type);
    }
    const dBodyID bodies[2] = {dJointGetBody(joint, 0), dJointGetBody(joint, 1)};
    if (bodies[0] == NULL && bodies[1] == NULL) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the joint is not attached to a body; attach it before it gets play");
    }
    for (int i = 0; i < 2; i++) {
        if (bodies[i] != NULL && dBodyGetWorld(bodies[i]) != world->id) {
            return refusal(error, JP_ERROR_ARGUMENT, "the joint is in another world");
        }
    }
    return JP_OK;
}

// The row of an angle: an axis of an angular motor at its low stop.
static bool make_motor(JpJoint *joint)
{
    const dBodyID *bodies = joint->coordinate.bodies;
    const dJointID motor = dJointCreateAMotor(joint->world->id, 0);
    if (motor == NULL) {
        return false;
    }
    // the first body of ODE's joint is never the world
    const int first = bodies[0] != NULL ? 0 : 1;
    dJointAttach(motor, bodies[first], bodies[1 - first]);
    dJointSetAMotorMode(motor, dAMotorUser);
    dJointSetAMotorNumAxes(motor, 1);
    dJointSetAMotorParam(motor, dParamLoStop, 0.0);
    dJointSetAMotorAngle(motor, 0, 1.0);
    dJointSetFeedback(motor, &joint->feedback);
    joint->motor = motor;
    return true;
}

static JpStatus make_joint(JpWorld *world, dJointID on, const ForceLaw *law, const double limits[2],
                           JpJoint **created, JpError *error)
{
    JpJoint *joint = calloc(1, sizeof *joint);
    if (joint == NULL) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for a joint");
    }
    joint->world = world;
    joint->coordinate = coordinate_of(on);
    joint->rotor.inertia = INFINITY;
    for (int i = 0; i < SIDE_COUNT; i++) {
        joint->sides[i] = (Side){.law = *law, .sign = i == 0 ? 1.0 : -1.0, .limit = limits[i]};
    }
    if (joint->coordinate.is_angle && !make_motor(joint)) {
        free(joint);
        return refusal(error, JP_ERROR_MEMORY, "ODE could not make the joint's motor");
    }
    joint->next = world->joints;
    world->joints = joint;
    *created = joint;
    return refusal_none(error);
}

JpStatus jp_backlash_create(JpWorld *world, dJointID on, const JpBacklash *backlash,
                            JpJoint **created, JpError *error)
{
    ForceLaw law;
    REFUSAL_TRY(refusal_of_null(created, "where the joint is to go", error));
    REFUSAL_TRY(refusal_of_null(backlash, "the backlash", error));
    REFUSAL_TRY(check_joint(world, on, error));
    REFUSAL_TRY(refusal_of_negative(backlash->gap, "the gap", error));
    REFUSAL_TRY(refusal_of_finite(backlash->offset, "the gap's offset", error));
    REFUSAL_TRY(refusal_of_negative(backlash->rotor_inertia, "the rotor's inertia", error));
    REFUSAL_TRY(contact_law(&backlash->tooth, &law, error));
    const double limits[] = {backlash->offset - 0.5 * backlash->gap,
                             backlash->offset + 0.5 * backlash->gap};
    JpJoint *joint = NULL;
    REFUSAL_TRY(make_joint(world, on, &law, limits, &joint, error));
    joint->is_backlash = true;
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
    REFUSAL_TRY(refusal_of_null(created, "where the joint is to go", error));
    REFUSAL_TRY(refusal_of_null(stops, "the stops", error));
    REFUSAL_TRY(check_joint(world, on, error));
    if (!(stops->low < stops->high) || stops->low == INFINITY || stops->high == -INFINITY) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the stops are at %g and %g; the low one must be below the high one",
                       stops->low, stops->high);
    }
    REFUSAL_TRY(contact_law(&stops->contact, &law, error));
    const double limits[] = {stops->low, stops->high};
    return make_joint(world, on, &law, limits, created, error);
}

void jp_joint_destroy(JpJoint *joint)
{
    if (joint == NULL) {
        return;
    }
    JpJoint **at = &joint->world->joints;
    while (*at != joint) {
        at = &(*at)->next;
    }
    *at = joint->next;
    if (joint->motor != NULL) {
        dJointDestroy(joint->motor);
    }
    free(joint);
}

static JpStatus check_backlash(const JpJoint *joint, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(joint, "the joint", error));
    return joint->is_backlash ? JP_OK
                              : refusal(error, JP_ERROR_ARGUMENT,
                                        "the joint has stops and no backlash: nothing of it is "
                                        "driven");
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

JpStatus jp_backlash_lead(JpJoint *joint, double position, double speed, JpError *error)
{
    REFUSAL_TRY(check_backlash(joint, error));
    REFUSAL_TRY(refusal_of_finite(position, "the rotor's position", error));
    REFUSAL_TRY(refusal_of_finite(speed, "the rotor's speed", error));
    joint->rotor = (Rotor){.inertia = INFINITY, .position = position, .speed = speed};
    return refusal_none(error);
}

static JpSide side_state(const Side *side, double position)
{
    const double gap = isfinite(side->limit) ? side_gap(side, position) : INFINITY;
    return (JpSide){
        .gap = gap,
        .force = side->force,
        .force_max = side->force_max,
        .depth_max = side->depth_max,
        .impulse = side->impulse,
        .work = side->work,
        .stored = gap < 0.0 ? force_law_energy(&side->law, -gap) : 0.0,
        .impact_speed = side->impact_speed,
        .impacts = side->impacts,
        .is_touching = gap < 0.0,
    };
}

JpStatus jp_joint_state(const JpJoint *joint, JpJointState *state, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(joint, "the joint", error));
    REFUSAL_TRY(refusal_of_null(state, "the state", error));
    Coordinate coordinate = joint->coordinate; // so that reading changes nothing
    const double position = coordinate_read(&coordinate);
    const double off = position - joint->rotor.position;
    *state = (JpJointState){
        .position = position,
        .speed = coordinate_rate(&coordinate),
        .rotor_position = joint->rotor.position,
        .rotor_speed = joint->rotor.speed,
        .force = joint->sides[0].force - joint->sides[1].force,
        .low = side_state(&joint->sides[0], off),
        .high = side_state(&joint->sides[1], off),
    };
    return refusal_none(error);
}
