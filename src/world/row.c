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

static void make_angle_row(PlaceRow *row, double cfm, double erp)
{
    const dReal *axis = row->axis;
    dJointSetAMotorAxis(row->motor, 0, 0, axis[0], axis[1], axis[2]);
    dJointSetAMotorAngle(row->motor, 0, -1.0);
    dJointSetAMotorParam(row->motor, dParamStopERP, erp);
    dJointSetAMotorParam(row->motor, dParamStopCFM, cfm);
}

static void make_contact(JpJoint *joint, Place *place, const Side *side, double cfm, double speed)
{
    PlaceRow *row = &place->row;
    const dWorldID world = joint->world->id;
    const double limit = LIMIT_SHARE * dWorldGetContactMaxCorrectingVel(world);
    if (speed > limit) {
        row->pushed = (speed - limit) / cfm;
        direction_push(&place->along, side->sign * row->pushed);
    }
    dContact contact;
    memset(&contact, 0, sizeof contact);
    contact.surface.mode = dContactSoftERP | dContactSoftCFM | dContactMotionN;
    contact.surface.soft_cfm = cfm;
    contact.surface.motionN = fmin(speed, limit);
    contact.geom.pos[0] = place->point.x;
    contact.geom.pos[1] = place->point.y;
    contact.geom.pos[2] = place->point.z;
    // ODE turns the normal where the first body is the world, and so does its feedback
    const double first = joint->bodies[0] != NULL ? 1.0 : -1.0;
    for (int i = 0; i < 3; i++) {
        contact.geom.normal[i] = first * row->axis[i];
    }
    row->contact = dJointCreateContact(world, joint->world->rows, &contact);
    dJointAttach(row->contact, joint->bodies[0], joint->bodies[1]);
    dJointSetFeedback(row->contact, &row->feedback);
}

void row_make(JpJoint *joint, Place *place, const Side *side, double cfm, double speed, double step)
{
    PlaceRow *row = &place->row;
    memset(&row->feedback, 0, sizeof row->feedback);
    row->pushed = 0.0;
    const double sign = joint->bodies[0] != NULL ? side->sign : -side->sign;
    for (int i = 0; i < 3; i++) {
        row->axis[i] = sign * place->along.axis[i];
    }
    if (row->motor != NULL) {
        make_angle_row(row, cfm, speed * step);
    } else {
        make_contact(joint, place, side, cfm, speed);
    }
}

double row_take(Place *place)
{
    PlaceRow *row = &place->row;
    const dReal *found = row->motor != NULL ? row->feedback.t1 : row->feedback.f1;
    if (row->motor != NULL) {
        dJointSetAMotorAngle(row->motor, 0, 1.0);
    }
    row->contact = NULL;
    return dCalcVectorDot3(row->axis, found) + row->pushed;
}
