// One step of a world whose contacts are integrated within it: the scheme, over the coordinates of
// the bodies. What the world is stands behind a KernelAdapter: an engine with its joints, in the
// plane or in space.
//
// Arrays "by coordinate" have what bodies move and turn by, m and rad, or what their speeds change
// by, m/s and rad/s, in an order of the adapter's. Arrays "by row" have the rows of the kernel.
#pragma once

#include "kernel/columns.h"
#include "kernel/kernel.h"

// What a step asks of the world, in the order in which it asks. All are given what the step has in
// `own`. Driven bodies are where they are at any time: what changes others leaves them alone.
typedef struct KernelAdapter {
    // Of a step with drift before which there was none, or a kink: writes the accelerations beside
    // the contacts' at its start, by coordinate, and those of the kernel's rows. Returns false
    // where the world has none.
    bool (*find_start)(void *own, double *accelerations);
    // Puts the bodies to mid-step, where they are after half a step at the speeds of its start, and
    // then by `beyond`, by coordinate (NULL: not at all).
    void (*find_middle)(void *own, const double *beyond);
    // Finds what pushes do at mid-step. Writes the mobility, or the coupling of islands; of a step
    // with drift columns[0], rates and drift; and where the rows are at the start and how fast they
    // go, if that has not been done. Returns false where the world has no such response.
    bool (*respond)(void *own);
    // Writes the free accelerations of the kernel's rows at mid-step, at the speeds of the start
    // and what they gain until then, by coordinate.
    void (*accelerate)(void *own, const double *gained);
    // Writes what impulses in the rows do to the speeds, by coordinate, by the last response that
    // was found; so many s after the middle of its step, if that is known.
    void (*push)(void *own, double after_s, const double *impulses, double *speeds);
    // Steps the world at mid-step under the mean forces of the contacts, and moves the bodies by
    // half a step at the speeds of the start and half a step at those it gives. Returns false where
    // that fails.
    bool (*advance)(void *own);
    // Changes where the bodies are at the end and how fast they go, both by coordinate.
    void (*shift)(void *own, const double *positions, const double *speeds);
    // Writes how far ideal joints are open at the end and how fast they open, by ideal row; returns
    // how many rows there are.
    size_t (*find_openings)(void *own, double *positions, double *rates);
    // Writes what takes such openings away, by coordinate, and the impulses that take away rates.
    void (*close)(void *own, const double *openings, double *impulses, double *changes);
    // Writes, by coordinate, the speeds at the start and by how much these and the positions have
    // changed until the end.
    void (*compare)(void *own, double *speeds, double *gained, double *moved);
} KernelAdapter;

// What a step works with: arrays by coordinate, by row and by ideal row.
typedef struct KernelStepWork {
    double *changes[3];
    double *rows;
    double *ideal[2];
} KernelStepWork;

// A step, and what lives on to the next one. All arrays are owned but for rates and drift.
typedef struct KernelStep {
    const KernelAdapter *adapter;
    void *own;              // the adapter's
    Kernel kernel;          // a contact of it is a place
    KernelIslands *islands; // of the kernel's places; NULL where they are few
    KernelCoupling coupling;
    size_t coordinate_count;
    // time
    double start_s; // of the last step
    double end_s;
    double width_s;
    bool is_kink;  // whether accelerations have a jump at its end
    size_t count;  // of steps
    size_t steady; // before the last one since the start, or since a kink
    // by coordinate
    double *free;      // mean acceleration beside the contacts', 1/s of a speed
    double *free_rate; // its rate of change
    double *ahead;     // with drift, what it will be at mid-step: as in the step before, or at the
                       // start of a first one
    double *rest;      // of the end's positions, beyond the formula for inside
    double *moved[2];  // by the contacts in the whole step: speeds and positions
    double *closed;    // by how much closing the ideal joints has changed the speeds, 1/s of it
    // by row
    KernelSums total; // of the contacts, in the whole step
    double *pressing; // N, their mean forces
    double *closing;  // N s, of the ideal joints' rows, beside the world's step
    // what pushes do, and how that changes in the step; else as at mid-step
    bool has_drift;
    bool is_calm; // whether the contacts did not change the accelerations much in the last step
    double *columns[KERNEL_COLUMNS_KNOWN];  // by row what 1 N s there does to the speeds, by
                                            // coordinate, in this step and in those before
    double middles_s[KERNEL_COLUMNS_KNOWN]; // when these had their middles
    const double *rates;                    // of this step's columns
    const double *drift;                    // S of the mobility (kernel/motion.c)
    KernelStepWork work;
} KernelStep;

// How a step has ended.
typedef enum KernelStepEnd {
    KERNEL_STEP_TAKEN,
    KERNEL_STEP_REFUSED,  // by the adapter
    KERNEL_STEP_TOO_LONG, // it takes more local steps than kernel_run makes
} KernelStepEnd;

// Makes room, once the kernel has its contacts, for so many coordinates and at most so many rows of
// ideal joints; and for islands, or for one kernel whose rows are coupled.
void kernel_step_make_room(KernelStep *step, size_t coordinates, size_t ideal_rows);
void kernel_step_make_islands(KernelStep *step);

// Lets what pushes do change within the steps: how, the adapter writes to these arrays of its own
// in each.
void kernel_step_make_drift(KernelStep *step, const double *rates, const double *drift);
void kernel_step_finish(KernelStep *step);

// Carries all that lives on from step to step, but for the kernel and the time.
void kernel_step_carry(KernelStep *step, Carry *carry);

// Begins the next step where the last one ended; it is then to be taken up to a time, s, at which
// accelerations may have a jump.
void kernel_step_begin(KernelStep *step);
KernelStepEnd kernel_step_take(KernelStep *step);

// Writes what the contacts have done up to a time in the step to speeds and positions, by
// coordinate, from their sums.
void kernel_step_push(const KernelStep *step, double since_s, const KernelSums *sums,
                      double *speeds, double *positions);

// A time in a step that has been taken, as the formula for inside needs it.
typedef struct KernelStepTime {
    double since_s; // since the start
    double half_s;  // with drift, half of that
    double width_s; // of the step
    double share;   // of the step
} KernelStepTime;

static inline KernelStepTime kernel_step_time(const KernelStep *step, double since_s)
{
    return (KernelStepTime){
        .since_s = since_s,
        .half_s = step->has_drift ? 0.5 * since_s : 0.0,
        .width_s = step->width_s,
        .share = since_s / step->width_s,
    };
}

// How fast a coordinate goes then, from its speed at the start and what contacts have done to it;
// and how far it has gone.
static inline double kernel_step_speed(const KernelStep *step, size_t coordinate, KernelStepTime at,
                                       double speed, double pushed)
{
    const double bend = at.half_s * step->free_rate[coordinate];
    return speed + at.since_s * step->free[coordinate] + bend * (at.since_s - at.width_s) + pushed;
}

static inline double kernel_step_way(const KernelStep *step, size_t coordinate, KernelStepTime at,
                                     double speed, double moved)
{
    const double bend = at.half_s * step->free_rate[coordinate];
    return at.since_s * (speed + 0.5 * at.since_s * step->free[coordinate]) + moved +
           bend * at.since_s * (at.since_s / 3.0 - 0.5 * at.width_s) +
           at.share * at.share * step->rest[coordinate];
}

// Its acceleration beside the contacts', linear in time, so many s after mid-step.
static inline double kernel_step_beside(const KernelStep *step, size_t coordinate,
                                        double off_middle_s)
{
    return step->free[coordinate] + off_middle_s * step->free_rate[coordinate];
}
