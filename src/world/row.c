// How does ODE get a row that presses and never pulls, for an angle and for a way?
//
// An angle: an angular motor of one axis at its low stop. Its angle is set to -1, so that the row's
// speed is dParamStopERP / h.
// A way: a contact at a depth of 0 whose dContactMotionN is the row's speed. A world may limit that
// speed (dWorldSetContactMaxCorrectingVel). Then F - F0 is the row's force, F0 = (speed - limit) /
// CFM what is put on from outside: the same row, for F of at least F0.
#include "world/row.h"

#include <math.h>
#include <string.h>

// so that rounding does not reach the limit
static const double LIMIT_SHARE = 0.999;

static void make_angle_row(JpJoint *joint, double cfm, double erp)
{
    const dReal *axis = joint->row_axis;
    dJointSetAMotorAxis(joint->motor, 0, 0, axis[0], axis[1], axis[2]);
    dJointSetAMotorAngle(joint->motor, 0, -1.0);
    dJointSetAMotorParam(joint->motor, dParamStopERP, erp);
    dJointSetAMotorParam(joint->motor, dParamStopCFM, cfm);
}

static void make_contact(JpJoint *joint, const Side *side, double cfm, double speed,
                         dJointGroupID group)
{
    const dWorldID world = joint->world->id;
    const double limit = LIMIT_SHARE * dWorldGetContactMaxCorrectingVel(world);
    if (speed > limit) {
        joint->pushed = (speed - limit) / cfm;
        coordinate_push(&joint->coordinate, side->sign * joint->pushed);
    }
    dContact contact;
    memset(&contact, 0, sizeof contact);
    contact.surface.mode = dContactSoftERP | dContactSoftCFM | dContactMotionN;
    contact.surface.soft_cfm = cfm;
    contact.surface.motionN = fmin(speed, limit);
    coordinate_point(&joint->coordinate, contact.geom.pos);
    // ODE turns the normal where the first body is the world, and so does its feedback
    const double first = joint->coordinate.bodies[0] != NULL ? 1.0 : -1.0;
    for (int i = 0; i < 3; i++) {
        contact.geom.normal[i] = first * joint->row_axis[i];
    }
    joint->contact = dJointCreateContact(world, group, &contact);
    dJointAttach(joint->contact, joint->coordinate.bodies[0], joint->coordinate.bodies[1]);
    dJointSetFeedback(joint->contact, &joint->feedback);
}

void row_make(JpJoint *joint, const Side *side, double cfm, double speed, double step,
              dJointGroupID group)
{
    memset(&joint->feedback, 0, sizeof joint->feedback);
    joint->pushed = 0.0;
    dVector3 axis;
    coordinate_axis(&joint->coordinate, axis);
    const double sign = joint->coordinate.bodies[0] != NULL ? side->sign : -side->sign;
    for (int i = 0; i < 3; i++) {
        joint->row_axis[i] = sign * axis[i];
    }
    if (joint->coordinate.is_angle) {
        make_angle_row(joint, cfm, speed * step);
    } else {
        make_contact(joint, side, cfm, speed, group);
    }
}

double row_take(JpJoint *joint)
{
    const dReal *found = joint->coordinate.is_angle ? joint->feedback.t1 : joint->feedback.f1;
    if (joint->coordinate.is_angle) {
        dJointSetAMotorAngle(joint->motor, 0, 1.0);
    }
    joint->contact = NULL;
    return dCalcVectorDot3(joint->row_axis, found) + joint->pushed;
}
