// Makes a row of ODE that presses and never pulls.
//
// An angle: an angular motor of one axis at its low stop. Its angle is set to -1, so that the row's
// speed is dParamStopERP / h.
// A way: a contact. ODE turns its normal where the first body is the world, and so does what it
// says of the force.
#include "world/pressing_row.h"

static const double AT_STOP = -1.0; // rad, below the low stop at 0
static const double AWAY = 1.0;

dJointID pressing_row_of_angle(dWorldID world, const dBodyID bodies[2], dJointFeedback *feedback)
{
    const dJointID row = dJointCreateAMotor(world, 0);
    if (row == NULL) {
        return NULL;
    }
    // the first body of ODE's joint is never the world
    const int first = bodies[0] != NULL ? 0 : 1;
    dJointAttach(row, bodies[first], bodies[1 - first]);
    dJointSetAMotorMode(row, dAMotorUser);
    dJointSetAMotorNumAxes(row, 1);
    dJointSetAMotorParam(row, dParamLoStop, 0.0);
    dJointSetAMotorAngle(row, 0, AWAY);
    dJointSetFeedback(row, feedback);
    return row;
}

void pressing_row_set_axis(dJointID row, double x, double y, double z)
{
    dJointSetAMotorAxis(row, 0, 0, x, y, z);
}

void pressing_row_press(dJointID row, double cfm, double speed, double step_s)
{
    dJointSetAMotorAngle(row, 0, AT_STOP);
    dJointSetAMotorParam(row, dParamStopERP, speed * step_s);
    dJointSetAMotorParam(row, dParamStopCFM, cfm);
}

void pressing_row_rest(dJointID row)
{
    dJointSetAMotorAngle(row, 0, AWAY);
}

dJointID pressing_row_of_way(dWorldID world, dJointGroupID group, const dContact *contact,
                             const dBodyID bodies[2], dJointFeedback *feedback)
{
    const dJointID row = dJointCreateContact(world, group, contact);
    dJointAttach(row, bodies[0], bodies[1]);
    dJointSetFeedback(row, feedback);
    return row;
}

Vec3 pressing_row_force(const dJointFeedback *feedback, const dBodyID bodies[2])
{
    const double sign = bodies[0] != NULL ? 1.0 : -1.0;
    return (Vec3){sign * feedback->f1[0], sign * feedback->f1[1], sign * feedback->f1[2]};
}
