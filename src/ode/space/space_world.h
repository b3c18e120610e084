// A linkage in space built in ODE: bodies with their full inertias, and ideal joints that are
// hinges. Contacts are made step by step (ode/space/space_contacts.h).
#pragma once

#include "model/scenario.h"
#include "model/space_response.h"
#include "ode/plane/world.h"

// The ideal joints of a world in space with many of them, held by forces that are found here
// instead of by rows of ODE: ode/plane/world_hold.h in space.
typedef struct SpaceHold SpaceHold;

// Builds the world of a scenario with its bodies in the motions given, and the response of its
// linkage with some places; and what holds its ideal joints, NULL where they are rows of ODE. Fails
// with ERR_SOLVER where ODE's joints cannot hold it without redundant rows. Neither must be copied,
// and both are to be finished after a failure too.
bool space_world_build(const Scenario *scenario, const SpaceMotion *motions,
                       const SpaceResponsePlace *places, size_t count, World *world,
                       SpaceResponse *response, SpaceHold **hold, Err *err);

// Builds the same world of a linkage that never leaves the plane (model/space_flat.h), for steps
// that know the plane alone; `flat` is the same scenario in the plane, which is to outlive the
// world. Fails likewise, and where the joints are redundant in the plane.
bool space_world_build_flat(const Scenario *scenario, const Scenario *flat, const Motion *planar,
                            World *world, Err *err);

// Moves the bodies of motions, and those of the world, half a step on, each ideal joint as far open
// as it stays: h^2 / 2 of how fast the rates of its rows change as the bodies turn. Fails with
// ERR_SOLVER where the ideal joints are redundant.
bool space_world_move_on(World *world, SpaceResponse *response, double step_s, SpaceMotion *motions,
                         Err *err);

// Puts one body where a motion says, with its velocities, and reads it back; accelerations are
// zero.
void space_world_place(World *world, size_t body, const SpaceMotion *motion);
SpaceMotion space_world_motion(const World *world, size_t body);

// Fails with ERR_SOLVER where a velocity is not finite.
bool space_world_check(const World *world, Err *err);

// The force that an ideal joint, not the drive's, put on its body b in the last step, N.
Vec3 space_world_force(const World *world, size_t joint);

// What it put on one of its two bodies: the force, and the moment about its centre of mass.
SpaceChange space_world_load(const World *world, size_t joint, int body);

// The torque, N m, that is to act on a body through a step of ODE so that its angular momentum
// changes by what else acts. The body has its position at mid-step and omega as it is at the step's
// start; `rest` is its angular acceleration, rad/s^2, by all that acts else, as well as it is
// known: exact for a free body, whose momentum is then kept to rounding. Writes the angular
// acceleration that the torque alone makes.
Vec3 space_world_gyration(const SpaceResponse *response, size_t body, const SpaceMotion *middle,
                          Vec3 rest, double step_s, Vec3 *alpha);

void space_hold_free(SpaceHold *hold);

// Pushes the bodies, on which all else acts already, so that a step keeps the joints closed, and
// fills in the feedback of the joints as ODE does. The response is that of the motions given: the
// bodies as the step has them.
void space_hold_push(SpaceHold *hold, const SpaceResponse *response, const SpaceMotion *motions,
                     double step_s, World *world);
