// What drivers share whose contacts are integrated within the engine's steps, by the contact
// kernel.
#pragma once

#include "drivers/common/place.h"
#include "kernel/columns.h"
#include "kernel/kernel.h"

// A step in the coordinates of a tree, in the words of drivers/common/trial.c: what does not depend
// on how the engine is asked. Rows are those of the places (drivers/common/place.h). Steps may have
// any length; where accelerations jump the scheme starts anew.
typedef struct Within {
    const DriverCase *of;
    size_t rows;
    size_t count; // coordinates
    Kernel kernel;
    KernelSums sums;
    double *q; // of the step's start; by coordinate, as the next ones; owned, as all arrays
    double *v;
    double *q_next;
    double *v_next;
    double *a; // beside the contacts', at mid-step; its rate there, and that of its rate
    double *a_rate;
    double *a_bend;
    double *a_change; // from the mid-step before to this one
    double *ahead;    // a as it is to be expected: that of the step before, after its impulses
    double *q_middle; // of mid-step, as far as they are to be expected there
    double *v_middle;
    double *free; // G, at mid-step
    double *nudged;
    double *response; // A: row by row
    double *rate;     // A'
    double *jacobian; // row by row
    double *bend;     // B
    double *bend_rate;
    double *bend_before;
    double *drift;       // S
    double *free_before; // by row
    double *work;
    size_t known;      // steps since the scheme was started
    size_t calm_steps; // in a row, in which the contacts pushed little
    double before_s;   // length of the step before
    double fastest;    // the largest that the velocities have been, all together
} Within;

// Makes the contacts of a case, one a place, and all room.
void within_open(const DriverCase *of, size_t count, Within *in);

// Starts the scheme, at the start of a run or where accelerations jump: what was before is
// forgotten.
void within_start(Within *in);

// Adds sums over the rows of A, or of A', to something by coordinate.
void within_add_rows(const Within *in, const double *columns, const double *by_row, double scale,
                     double *target);

// Where mid-step is to be expected, and how fast it goes there, from the accelerations of the steps
// before.
void within_find_middle(Within *in, double step_s);

// What the free accelerations are behind the step's impulses, which have changed them by 2 S P; and
// how they change by themselves, from those.
void within_keep_free(Within *in);
void within_find_free_rate(Within *in, double step_s);

// From the middle of the step before to that of this one, s.
double within_apart(const Within *in, double step_s);

// Whether the contacts have pushed in the step that has been integrated.
bool within_has_pushed(const Within *in);

// Where the rows are at the step's start, and how fast they go.
void within_find_rows(Within *in, const DriverMotion *motions);

// The contacts over the step, by the kernel; its sums are those of the end.
void within_integrate(Within *in, double step_s);

// Whether impulses change the velocities so much in the step that has been integrated that it is
// too long for what accelerations are of second degree in.
bool within_is_rough(const Within *in, double step_s);

// Carries all that a step has changed by then.
void within_carry(Within *in, Carry *carry);

// From `a` as the engine gave it at mid-step under the mean force: without what the contacts did,
// and how it has changed.
void within_take_accelerations(Within *in, const double *a, double step_s);

// Positions and velocities at a time in the step, from the kernel's sums then; and those of its
// end.
void within_find_inside(const Within *in, double since_s, double step_s, const KernelSums *sums,
                        double *q, double *v);
void within_find_end(Within *in, double step_s);

// The next step starts where this one has ended.
void within_go_on(Within *in, double step_s);

// How all bodies move at a time since the start of the step, s, from the kernel's sums there.
typedef void (*WithinMotions)(void *adapter, double since_s, const KernelSums *sums,
                              DriverMotion *motions);

// A step that the kernel has integrated.
typedef struct WithinStep {
    const Kernel *kernel;  // a contact of it is a place
    DriverContact *states; // by place: whether it touched at the step's start
    double start_s;
    double step_s;
    WithinMotions motions;
    void *adapter;
    DriverMotion *room; // by body
    KernelSums *sums;   // likewise room
} WithinStep;

// Makes the samples in the step, the records of its parts, from node to node, and the totals.
void within_look(const WithinStep *step, DriverRun *run);
