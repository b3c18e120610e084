#include "pushed_box.h"

#include <math.h>
#include <ode/ode.h>
#include <string.h>

double pushed_box_error(double step, double onset)
{
    const double duration = 0.1;
    const double force = 5.0;
    const double bound = 0.1 * 9.81;
    const dWorldID world = dWorldCreate();
    const dJointGroupID group = dJointGroupCreate(0);
    dWorldSetGravity(world, 0, 0, -9.81);
    dMass mass;
    dMassSetBoxTotal(&mass, 1.0, 0.2, 0.2, 0.2);
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &mass);
    for (long i = 0; i < lround(duration / step); i++) {
        const double share = fmin(fmax((double)(i + 1) - onset / step, 0.0), 1.0);
        dContact contact;
        memset(&contact, 0, sizeof contact);
        contact.surface.mode = dContactApprox1;
        contact.surface.mu = 0.1;
        contact.geom.normal[2] = 1.0;
        contact.geom.pos[0] = dBodyGetPosition(body)[0];
        dBodyAddForce(body, share * force, 0, 0);
        dJointAttach(dJointCreateContact(world, group, &contact), body, 0);
        const double before = dBodyGetLinearVel(body)[0];
        dWorldStep(world, step);
        dJointGroupEmpty(group);
        // positions by the mean of both speeds
        const dReal *at = dBodyGetPosition(body);
        const dReal *speed = dBodyGetLinearVel(body);
        dBodySetPosition(body, at[0] + 0.5 * step * (before - speed[0]), 0, 0);
    }
    const double pushed = duration - onset;
    const double error = dBodyGetPosition(body)[0] - 0.5 * (force - bound) * pushed * pushed;
    dJointGroupDestroy(group);
    dWorldDestroy(world);
    return fabs(error);
}
