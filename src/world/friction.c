// Lets hinges and sliders of ODE rub: a row about or along the axis of each (contact/rub_row.c).
//
// Of a hinge the row is a motor of an angle. Of a slider it is the friction of a contact at the
// first body's centre, with a bound that does not depend on what presses, so that it pushes both
// bodies at one point: a motor of a way would push each at its own centre, and turn the two.
//
// What presses is the force of ODE's joint across its axis. No step tells that of the first one,
// which is therefore tried until friction no longer changes it.
#include "world/friction.h"

#include "world/contact.h"
#include "world/fault.h"
#include "world/trial.h"

#include <math.h>
#include <string.h>

// Each leaves a share of mu of what was wrong.
enum { TRIALS = 6 };

JpFriction jp_friction_default(void)
{
    return (JpFriction){.law = JP_FRICTION_STICK, .speed = 1e-3, .breakaway_ratio = 1.0};
}

static JpStatus check_friction(const JpFriction *friction, bool is_hinge, JpError *error)
{
    REFUSAL_TRY(refusal_of_negative(friction->steady, "the steady friction", error));
    REFUSAL_TRY(refusal_of_negative(friction->coefficient, "the friction coefficient", error));
    REFUSAL_TRY(refusal_of_positive(friction->speed, "the friction speed", error));
    REFUSAL_TRY(refusal_of_finite(friction->breakaway_ratio, "the breakaway ratio", error));
    if (friction->law != JP_FRICTION_STICK && friction->law != JP_FRICTION_REGULARIZED) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the law of friction is %d, which is no JpFrictionLaw", (int)friction->law);
    }
    if (!(friction->breakaway_ratio >= 1.0)) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the breakaway ratio is %g; it must not be below 1",
                       friction->breakaway_ratio);
    }
    if ((friction->steady > 0.0) == (friction->coefficient > 0.0)) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the steady friction is %g and the friction coefficient %g; one of the two "
                       "must be above 0",
                       friction->steady, friction->coefficient);
    }
    return is_hinge && friction->coefficient > 0.0
               ? refusal_of_positive(friction->radius, "the radius of the hinge's pin", error)
               : JP_OK;
}

// The body that ODE's row has first, which is never the world.
static int first_of(const JpJoint *joint)
{
    return joint->bodies[0] != NULL ? 0 : 1;
}

static double sign_of(const JpJoint *joint)
{
    return joint->bodies[0] != NULL ? 1.0 : -1.0;
}

// The motor of a hinge. Returns false where ODE has no memory for it.
static bool make_motor(JpJoint *joint)
{
    Rub *rub = &joint->rub;
    Fault fault;
    fault_begin(&fault);
    if (setjmp(fault.left) == 0) {
        const int first = first_of(joint);
        rub->motor = dJointCreateAMotor(joint->world->id, 0);
        dJointAttach(rub->motor, joint->bodies[first], joint->bodies[1 - first]);
        dJointSetAMotorMode(rub->motor, dAMotorUser);
        dJointSetAMotorNumAxes(rub->motor, 1);
        dJointSetFeedback(rub->motor, &rub->feedback);
        dJointDisable(rub->motor);
    }
    fault_end(&fault);
    return rub->motor != NULL;
}

JpStatus jp_friction_create(JpWorld *world, dJointID on, const JpFriction *friction,
                            JpJoint **created, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(created, "the pointer for the joint", error));
    REFUSAL_TRY(refusal_of_null(friction, "the friction", error));
    REFUSAL_TRY(play_check_joint(world, on, error));
    const Coordinate coordinate = coordinate_of(on);
    REFUSAL_TRY(check_friction(friction, coordinate.is_angle, error));
    JpJoint *joint = play_add(world, PLAY_FRICTION, coordinate.bodies);
    if (joint == NULL) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for a joint");
    }
    joint->coordinate = coordinate;
    joint->rub.found.row = (RubRow){
        .pair = {.law = friction->law == JP_FRICTION_STICK ? BRISTLE_STICK : BRISTLE_REGULARIZED,
                 .ratio = friction->breakaway_ratio,
                 .speed = friction->speed},
        .steady = friction->steady,
        .arm = friction->coefficient * (coordinate.is_angle ? friction->radius : 1.0),
    };
    if (coordinate.is_angle && !make_motor(joint)) {
        jp_joint_destroy(joint);
        return refusal(error, JP_ERROR_MEMORY, "ODE has no memory for the joint's motor");
    }
    *created = joint;
    return refusal_none(error);
}

// A unit vector across another.
static void across(const dReal *axis, dVector3 normal)
{
    dVector3 other;
    dPlaneSpace(axis, normal, other);
}

// The row of a slider: the friction of a contact whose normal the slider holds already.
static void make_contact(JpJoint *joint)
{
    Rub *rub = &joint->rub;
    const RubRow *row = &rub->found.row;
    const int first = first_of(joint);
    dContact contact;
    memset(&contact, 0, sizeof contact);
    contact.surface.mode =
        dContactFDir1 | dContactMu2 | dContactMotion1 | dContactMotionN | dContactSlip1;
    contact.surface.mu = row->most;
    contact.surface.motion1 = sign_of(joint) * row->wanted;
    contact.surface.slip1 = row->softness;
    // the normal never presses
    contact.surface.motionN = -(row->pair.speed + fabs(row->rate));
    memcpy(contact.fdir1, rub->along.axis, sizeof(dVector3));
    across(rub->along.axis, contact.geom.normal);
    memcpy(contact.geom.pos, dBodyGetPosition(joint->bodies[first]), 3 * sizeof(dReal));
    rub->motor = dJointCreateContact(joint->world->id, joint->world->rows, &contact);
    dJointAttach(rub->motor, joint->bodies[first], joint->bodies[1 - first]);
    dJointSetFeedback(rub->motor, &rub->feedback);
}

static void set_motor(JpJoint *joint)
{
    const Rub *rub = &joint->rub;
    const RubRow *row = &rub->found.row;
    const dReal *axis = rub->along.axis;
    dJointEnable(rub->motor);
    dJointSetAMotorAxis(rub->motor, 0, 0, axis[0], axis[1], axis[2]);
    dJointSetAMotorParam(rub->motor, dParamVel, sign_of(joint) * row->wanted);
    dJointSetAMotorParam(rub->motor, dParamCFM, row->softness);
    dJointSetAMotorParam(rub->motor, dParamFMax, row->most);
}

void friction_rest(JpJoint *joint)
{
    if (!joint->coordinate.is_angle) {
        joint->rub.motor = NULL;
    } else if (joint->rub.motor != NULL) {
        dJointDisable(joint->rub.motor);
    }
}

// How fast the rate of a slider changes by its turning alone: with u = v1 - v2, d = x1 - x2 and the
// axis a, of s' = a . (u - w2 x d) at constant speeds -2 a . (w2 x u) - (w2 x a) . (w2 x d).
static double turning_of(const JpJoint *joint, const dReal *axis)
{
    const dBodyID first = joint->bodies[0];
    const dBodyID second = joint->bodies[1];
    dVector3 u = {0.0};
    dVector3 d = {0.0};
    if (joint->coordinate.is_angle || second == NULL) {
        return 0.0;
    }
    for (int k = 0; k < 3; k++) {
        u[k] = (first != NULL ? dBodyGetLinearVel(first)[k] : 0.0) - dBodyGetLinearVel(second)[k];
        d[k] = (first != NULL ? dBodyGetPosition(first)[k] : 0.0) - dBodyGetPosition(second)[k];
    }
    dVector3 turned[3];
    const dReal *omega = dBodyGetAngularVel(second);
    dCalcVectorCross3(turned[0], omega, u);
    dCalcVectorCross3(turned[1], omega, axis);
    dCalcVectorCross3(turned[2], omega, d);
    return -2.0 * dCalcVectorDot3(axis, turned[0]) - dCalcVectorDot3(turned[1], turned[2]);
}

static void push_joint(JpJoint *joint, double step)
{
    Rub *rub = &joint->rub;
    RubRow *row = &rub->found.row;
    if (row->arm > 0.0 && dJointGetFeedback(joint->coordinate.joint) == NULL) {
        dJointSetFeedback(joint->coordinate.joint, &rub->reaction);
    }
    friction_rest(joint);
    rub->along = coordinate_direction(&joint->coordinate);
    row->mobility = direction_mobility(&rub->along);
    // the row is of the axis where forces are evaluated, and rates are those of the step's ends
    const bool is_staggered = joint->world->options.stepping != JP_STEPPING_PLAIN;
    const double later = 0.5 * step * turning_of(joint, rub->along.axis);
    rub_row_begin(row, direction_rate(&rub->along) - (is_staggered ? later : 0.0));
    rub_row_set(row, step, is_staggered);
    row->wanted -= later;
    if (row->has_row && joint->coordinate.is_angle) {
        set_motor(joint);
    } else if (row->has_row) {
        make_contact(joint);
    }
    if (row->pushed != 0.0) {
        direction_push(&rub->along, row->pushed);
    }
}

// The force of ODE's joint across its axis in the last step, N.
static double pressing_of(const JpJoint *joint)
{
    const dJointFeedback *feedback = dJointGetFeedback(joint->coordinate.joint);
    if (feedback == NULL) {
        return 0.0;
    }
    const dReal *axis = joint->rub.along.axis;
    const double lengthwise = dCalcVectorDot3(axis, feedback->f1);
    dVector3 rest_of;
    for (int k = 0; k < 3; k++) {
        rest_of[k] = feedback->f1[k] - lengthwise * axis[k];
    }
    return dCalcVectorLength3(rest_of);
}

static bool is_rubbing(const JpJoint *joint)
{
    return joint->kind == PLAY_FRICTION;
}

static bool has_friction(const JpWorld *world)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        if (is_rubbing(joint)) {
            return true;
        }
    }
    return false;
}

static void push_all(JpWorld *world, double step)
{
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        if (is_rubbing(joint)) {
            push_joint(joint, step);
        }
    }
}

// Whether some joint does not know yet what presses on it.
static bool is_new(const JpWorld *world)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        if (is_rubbing(joint) && joint->rub.found.row.arm > 0.0 &&
            joint->rub.found.row.known == 0) {
            return true;
        }
    }
    return false;
}

// Tries a step, and takes what presses in it.
static JpStatus try_step(JpWorld *world, double step, JpError *error)
{
    push_all(world, step);
    const JpStatus status = trial_step(world, step, error);
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        if (is_rubbing(joint) && joint->rub.found.row.known == 0) {
            joint->rub.found.row.pressing[0] = pressing_of(joint);
        }
        if (is_rubbing(joint)) {
            friction_rest(joint);
        }
    }
    dJointGroupEmpty(world->rows);
    bodies_put_back(&world->bodies);
    return status;
}

JpStatus friction_push(JpWorld *world, double step, JpError *error)
{
    if (!has_friction(world)) {
        return JP_OK;
    }
    const bool can_try = is_new(world) && trial_check(world, NULL) == JP_OK;
    for (int i = 0; can_try && i < TRIALS; i++) {
        REFUSAL_TRY(try_step(world, step, error));
    }
    push_all(world, step);
    bodies_keep(&world->bodies);
    return JP_OK;
}

static double held_by(const JpJoint *joint)
{
    const Rub *rub = &joint->rub;
    if (!rub->found.row.has_row) {
        return 0.0;
    }
    const dReal *found = joint->coordinate.is_angle ? rub->feedback.t1 : rub->feedback.f1;
    return sign_of(joint) * dCalcVectorDot3(rub->along.axis, found);
}

// of the bound of a row: what rounding in ODE's solver leaves of it
static const double AT_BOUND = 1e-9;

static void book_joint(JpJoint *joint, double step)
{
    Rub *rub = &joint->rub;
    RubFound *found = &rub->found;
    RubRow *row = &found->row;
    const Direction now = coordinate_direction(&joint->coordinate);
    const double end_rate = direction_rate(&now);
    const double held = held_by(joint);
    found->force = row->pushed + held;
    found->slid -= step * found->force * 0.5 * (row->rate + end_rate);
    found->is_sticking =
        row->pair.law == BRISTLE_STICK && row->has_row && fabs(held) < (1.0 - AT_BOUND) * row->most;
    rub_row_end(row, end_rate);
    rub_row_note(row, row->arm > 0.0 ? pressing_of(joint) : 0.0);
    friction_rest(joint);
}

void friction_book(JpWorld *world, double step)
{
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        if (is_rubbing(joint)) {
            book_joint(joint, step);
        }
    }
}

JpStatus jp_friction_state(const JpJoint *joint, JpFrictionState *state, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(joint, "the joint", error));
    REFUSAL_TRY(refusal_of_null(state, "the state", error));
    if (!is_rubbing(joint)) {
        return refusal(error, JP_ERROR_ARGUMENT, "%s is no friction of a hinge or slider",
                       play_name(joint).text);
    }
    REFUSAL_TRY(play_check_bodies(joint, error));
    Coordinate coordinate = joint->coordinate; // so that reading changes nothing
    const Direction along = coordinate_direction(&coordinate);
    const RubFound *of = &joint->rub.found;
    const JpFrictionState found = {
        .position = coordinate_read(&coordinate),
        .speed = direction_rate(&along),
        .force = of->force,
        .most = of->row.torque,
        .slid = of->slid,
        .is_sticking = of->is_sticking,
    };
    if (!isfinite(found.position + found.speed + found.force + found.most + found.slid)) {
        return refusal(error, JP_ERROR_WORLD, "the joint's state is out of a double's range");
    }
    *state = found;
    return refusal_none(error);
}
