// What the files of Chipmunk's driver share: the space made of a case, and the ways to step it.
#pragma once

#include "drivers/common/native.h"

#include <chipmunk/chipmunk.h>

typedef struct ChipmunkRun {
    const DriverCase *of;
    Tree tree;
    int iterations;
    cpSpace *space;
    cpBody **bodies;         // by body; owned, as all arrays
    cpBody *first;           // the first of a step whose velocity is changed
    Vec2 *centres;           // of each body's frame, where the centre of mass is
    DriverContact *contacts; // by place
    DriverMotion *motions;
    DriverMotion *before;  // of the step before
    Vec2 *forces;          // by joint, on body b
    DriverAction *actions; // by body
    double from_s;         // between which loads act as their mean
    double to_s;
    bool is_native;
    Native native;         // of that way: what touches
    cpConstraint **rows;   // by row of it
    cpConstraint **slides; // by hole of it
    double *pushes;        // by place: what the engine pushed with in the last step
    double lag_s;          // of velocities behind positions, as the law is to know
    double now_s;          // of the positions
    DriverRun run;
} ChipmunkRun;

static inline cpVect chipmunk_vect(Vec2 a)
{
    return cpv(a.x, a.y);
}

// The space of a case, with the bodies at the start.
void chipmunk_make(const DriverCase *of, ChipmunkRun *run);

cpBody *chipmunk_body(const ChipmunkRun *run, int body);

// Adds a constraint whose error is corrected in the next step, all of it.
void chipmunk_add(ChipmunkRun *run, cpConstraint *constraint);

// A point of a body in the frame that Chipmunk has of it: a driven one turns about its pivot.
cpVect chipmunk_point(const ChipmunkRun *run, int body, Vec2 local);

void chipmunk_read(const ChipmunkRun *run, DriverMotion *motions);

// Lets forces and moments act on the bodies until the end of the step under way.
void chipmunk_push(const ChipmunkRun *run, const DriverAction *actions);

// How all bodies get from one position to the next; driven ones by their drives where the others
// move as is usual.
void chipmunk_let_move(ChipmunkRun *run, cpBodyPositionFunc how);

// Leaves a body where it is.
void chipmunk_stay(cpBody *body, cpFloat step_s);

void chipmunk_tell_settings(ChipmunkRun *run);

// What touches by Chipmunk's own means; before a step, that it has not pushed yet; and what it has
// pushed with in the last one, with the motions after it.
void chipmunk_make_native(ChipmunkRun *run);
void chipmunk_clear_native(ChipmunkRun *run);
void chipmunk_read_native(ChipmunkRun *run);

// The contacts integrated within the step, by jointplay's kernel.
void chipmunk_run_kernel(ChipmunkRun *run) __attribute__((noreturn));
