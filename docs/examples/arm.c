// arm.c: an arm of three hinges, one with backlash, beside a ball on a floor
#include <jointplay/jointplay.h>
#include <math.h>
#include <stdio.h>

int main(void)
{
    dInitODE2(0);
    const dWorldID world = dWorldCreate();
    const dSpaceID space = dSimpleSpaceCreate(0);
    dWorldSetGravity(world, 0, 0, -9.81);
    dWorldSetERP(world, 1);
    dCreatePlane(space, 0, 0, 1, 0);
    dMass mass;
    dMassSetCapsuleTotal(&mass, 0.8, 1, 0.02, 0.3);
    dBodyID bodies[4]; // the last one is the ball
    dJointID hinges[3];
    for (int i = 0; i < 4; i++) {
        bodies[i] = dBodyCreate(world);
        dBodySetMass(bodies[i], &mass);
        dBodySetPosition(bodies[i], i < 3 ? 0.15 + 0.3 * i : 2, 0, i < 3 ? 1 : 0.1);
    }
    dGeomSetBody(dCreateSphere(space, 0.1), bodies[3]);
    for (int i = 0; i < 3; i++) {
        hinges[i] = dJointCreateHinge(world, 0);
        dJointAttach(hinges[i], bodies[i], i > 0 ? bodies[i - 1] : 0);
        dJointSetHingeAnchor(hinges[i], 0.3 * i, 0, 1);
        dJointSetHingeAxis(hinges[i], 0, i == 0 ? 0 : 1, i == 0 ? 1 : 0);
    }
    // the shoulder turns at a steady speed, the wrist is held by a motor of ODE's
    dJointSetHingeParam(hinges[0], dParamVel, 1);
    dJointSetHingeParam(hinges[0], dParamFMax, 50);
    dJointSetHingeParam(hinges[2], dParamFMax, 20);

    JpWorldOptions options = jp_world_options_default();
    options.space = space; // whose geoms touch as ODE has it
    JpBacklash backlash = jp_backlash_default();
    backlash.gap = 0.6 * M_PI / 180;
    backlash.tooth.stiffness = 500; // N m/rad
    backlash.tooth.restitution = 0.4;
    backlash.rotor_inertia = 0.02;
    JpError error;
    JpWorld *play;
    JpJoint *elbow;
    JpJointState state = {0};
    if (jp_world_create(world, &options, &play, &error) == JP_OK &&
        jp_backlash_create(play, hinges[1], &backlash, &elbow, &error) == JP_OK) {
        for (int i = 0; i < 4000 && error.status <= JP_OK; i++) {
            // a servo on the rotor, which knows nothing of the arm behind the gap
            jp_backlash_hold(elbow, 0.3 * sin(3e-3 * i), 400, 6, NULL);
            jp_world_step(play, 0.5e-3, &error);
        }
        jp_joint_state(elbow, &state, NULL);
    }
    printf("rotor %.3f rad, arm %.3f rad, up to %.0f N m; ball at %.3f m%s\n", state.rotor_position,
           state.position, fmax(state.low.force_max, state.high.force_max),
           dBodyGetPosition(bodies[3])[2], error.text);
    return error.status > JP_OK;
}
