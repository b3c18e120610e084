// The world of a case as libjointplay steps it, made by the calls that tune_world.c writes down.
#pragma once

#include "base/err.h"
#include "model/scenario.h"

#include <jointplay/jointplay.h>

typedef struct LibraryWorld {
    const Scenario *scenario;
    dWorldID world;
    dBodyID *bodies;   // owned; by body
    dJointID *joints;  // owned; by joint, NULL where it is none of ODE's
    dJointID *dampers; // owned; by spring, NULL where it has none
    JpWorld *play;
    size_t steps;
} LibraryWorld;

// The world of a planar scenario that tune_world_lacks finds nothing wrong with, at its start.
// Fails with ERR_CASE where a law does not fit its joint, and with ERR_SOLVER where the library
// refuses; closed all the same.
bool library_world_open(const Scenario *scenario, LibraryWorld *world, Err *err);

// Steps by the scenario's step. Fails with ERR_SOLVER.
bool library_world_step(LibraryWorld *world, Err *err);

// Where all bodies stand and how fast they move, without accelerations.
void library_world_motions(const LibraryWorld *world, Motion *motions);

void library_world_close(LibraryWorld *world);
