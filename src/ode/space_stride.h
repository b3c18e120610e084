// One step of a linkage in space with contacts as rows of the world, as it is handed on.
#pragma once

#include "ode/space_contacts.h"
#include "ode/space_joints.h"
#include "ode/space_stops.h"

typedef struct SpaceStride {
    double start_s;
    SpaceMotion *first; // by body: speeds at the step's start, and positions there (plain) or at
                        // mid-step (staggered); owned, like the arrays below
    SpaceMotion *last;  // as ODE leaves them; accelerations are means of the step
    double *omega;      // rad/s, about z, at its end
    double *alpha;      // rad/s^2, about z, mean
    SpaceJoints joints;
    double *impulse; // by joint
    double *approach;
    JointTop *tops;
    double drive_work; // J
    ContactEnergy energy;
} SpaceStride;

void space_stride_create(const Linkage *linkage, SpaceStride *stride);
void space_stride_free(SpaceStride *stride);

// Fills in forces, energies, impulses and the drive's part of a step that has been taken, and
// removes its contacts. `driven` is the motion of the driven body in its rows.
void space_stride_book(SpaceStride *stride, const SpaceMotion *driven, double step_s,
                       const World *world, SpaceContacts *contacts, SpaceStops *stops);
