// ODE as a leapfrog: second order in any program that calls dWorldStep(world, h).
// ODE does v' = v + h a(x), x' = x + h v'. That is the leapfrog if x belongs to a time h/2 after v:
//   start    move every body forward by h/2 of its velocities; for output move it back: x - h/2 v
//   joints   world ERP 1: each step closes the gap that the last one left
//   contact  CFM = 2 / c, ERP = h F0 / (c/2 d), F0 = k d + c/2 closing; depth d from these x, the
//            closing speed from before the step: damper on the mean speed; c > 0, sqrt(k/m) h < 2
// Still first order: a touchdown inside a step, as c makes the force jump; gyroscopic torque.
// Here a pendulum's bob hits a stiff, damped, smooth, sloping floor and moves uphill on it.
// cc leapfrog.c $(pkg-config --cflags --libs ode) -lm; ./a.out 0.001; ./a.out 0.001 plain
#include <ode/ode.h>
#include <stdio.h>
#include <stdlib.h>

static void move_on(dBodyID b, double time)
{
    const dReal *x = dBodyGetPosition(b), *v = dBodyGetLinearVel(b), *w = dBodyGetAngularVel(b);
    dQuaternion turn, turned;
    dQFromAxisAndAngle(turn, w[0], w[1], w[2], time * dCalcVectorLength3(w));
    dQMultiply0(turned, turn, dBodyGetQuaternion(b));
    dBodySetQuaternion(b, turned);
    dBodySetPosition(b, x[0] + time * v[0], x[1] + time * v[1], x[2] + time * v[2]);
}

int main(int argc, char **argv)
{
    const double h = argc > 1 ? atof(argv[1]) : 0.001, k = 1e4, c = 40.0, floor_z = -1.8; // SI
    const int plain = argc > 2; // as the textbook does, for comparison
    dInitODE();
    dWorldID world = dWorldCreate();
    dWorldSetGravity(world, 0.0, -5.0, -8.5); // z at right angles to the floor
    dWorldSetERP(world, plain ? 0.2 : 1.0);
    dBodyID bob = dBodyCreate(world); // of 1 kg and 1 kg m^2, ODE's own choice
    dBodySetPosition(bob, 2.4, 0.0, floor_z);
    dBodySetLinearVel(bob, -0.036, 2.88, -0.048);
    dBodySetAngularVel(bob, 0.0, 0.02, 1.2);
    dBodySetFiniteRotationMode(bob, !plain);
    dJointID pivot = dJointCreateBall(world, 0);
    dJointAttach(pivot, bob, 0);
    dJointSetBallAnchor(pivot, 0.0, 0.0, 0.0);
    move_on(bob, plain ? 0.0 : h / 2.0);
    const dReal *x = dBodyGetPosition(bob), *v = dBodyGetLinearVel(bob); // these stay up to date
    for (int n = 0; n < (int)(0.4 / h + 0.5); n++) {
        // set a driven (kinematic) body here: its position at (n + 1/2) h, its velocity at n h for
        // the closing speed; right before dWorldStep set its velocity at (n + 1) h
        const double d = floor_z - x[2], force = k * d - c / 2.0 * v[2];
        dContact touch = {.geom = {.pos = {x[0], x[1], x[2]}, .normal = {[2] = 1.0}, .depth = d}};
        touch.surface.mode = dContactSoftERP | dContactSoftCFM;
        touch.surface.soft_erp = plain ? h * k / (h * k + c) : h * force / (c / 2.0 * d);
        touch.surface.soft_cfm = plain ? 1.0 / (h * k + c) : 2.0 / c;
        dJointID contact = dJointCreateContact(world, 0, &touch);
        dJointAttach(contact, d > 0.0 ? bob : 0, 0); // to nothing without a contact
        dWorldStep(world, h);
        dJointDestroy(contact);
    }
    move_on(bob, plain ? 0.0 : -h / 2.0);
    printf("%.17g %.17g %.17g %.17g %.17g %.17g\n", x[0], x[1], x[2], v[0], v[1], v[2]);
    dWorldDestroy(world);
    dCloseODE();
}
