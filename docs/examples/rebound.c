// rebound.c: a door of .01 kg m^2 hits its stop and is to come back with .859 of its speed
#include <jointplay/jointplay.h>
#include <stdio.h>

int main(void)
{
    dInitODE2(0);
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_STAGGERED; stepping++) {
        const dWorldID world = dWorldCreate();
        dMass mass;
        dMassSetParameters(&mass, 1, 0, 0, 0, .01, .01, .01, 0, 0, 0);
        const dBodyID door = dBodyCreate(world);
        dBodySetMass(door, &mass);
        dBodySetAngularVel(door, 0, 0, 2);
        const dJointID hinge = dJointCreateHinge(world, 0);
        dJointAttach(hinge, door, 0);
        dJointSetHingeAxis(hinge, 0, 0, 1);

        JpWorldOptions options = jp_world_options_default();
        options.stepping = (JpStepping)stepping;
        JpWorld *play;
        JpJoint *stop;
        JpError error;
        JpStops stops = jp_stops_default();
        stops.high = 0.05;
        stops.contact.stiffness = 1e4; // N m/rad
        stops.contact.restitution = 0.859;
        if (jp_world_create(world, &options, &play, &error) != JP_OK ||
            jp_stops_create(play, hinge, &stops, &stop, &error) != JP_OK) {
            printf("%s\n", error.text);
            return 1;
        }
        JpJointState state;
        do {
            jp_world_step(play, 0.3e-3, &error);
            jp_joint_state(stop, &state, &error);
        } while (state.high.impacts == 0 || state.high.force > 0);
        printf("%s: %.3f, at most %.1f N m\n",
               stepping == JP_STEPPING_PLAIN ? "plain" : "staggered", -state.speed / 2,
               state.high.force_max);
        jp_world_destroy(play);
        dWorldDestroy(world);
    }
    dCloseODE();
    return 0;
}
