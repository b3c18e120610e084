// How the bodies move inside a step of few rows, as polynomials in time that are worked out once a
// step: samples and parts of the step are then looked up at the cost of a few products.
//
// With t since the step's start, s since its middle, and by row the contacts' impulse P, its
// integral Q, that one's R and the force f at t (kernel/kernel.h),
//     q = position + speed t + bend t^2 + rate t^3 / 6 + sum of A Q + A' (s Q - 2 R)
//     v = speed + acceleration t + rate t^2 / 2        + sum of A P + A' (s P - Q)
//     a = acceleration + rate t                        + sum of (A + B s + C s^2) f
// The rows of a place at which a joint touches go likewise (kernel/motion.c),
//     u  = position + speed t + bend t^2 + rate t^3 / 6 + sum of (W + W' s) Q - 2 S^T R
//     u' = speed + acceleration t + rate t^2 / 2        + sum of (W + W' s) P + (S - S^T) Q
#pragma once

#include "base/double2.h"
#include "kernel/step.h"
#include "model/linkage.h"

enum {
    IMPULSE_FEW_ROWS = 16, // so many at most: working out what each does takes as their square
};

// The freedoms of one body: x and y in m; the angle in rad, and nothing.
enum { IMPULSE_HALVES = 2 };

// Two coordinates beside the contacts.
typedef struct ImpulseCurve {
    Double2 position;
    Double2 speed;
    Double2 bend;
    Double2 acceleration;
    Double2 rate;
} ImpulseCurve;

// What 1 N s in a row does to the speeds of a body.
typedef struct ImpulseColumn {
    Double2 middle[IMPULSE_HALVES]; // A, at mid-step
    Double2 rate[IMPULSE_HALVES];   // A', its rate of change there (model/response_drift.h)
    Double2 slope[IMPULSE_HALVES];  // B and C: with A the parabola through this step and the two
    Double2 bend[IMPULSE_HALVES];   // before
} ImpulseColumn;

// What it does to the first two rows of a place.
typedef struct ImpulsePlaceColumn {
    Double2 middle; // W
    Double2 rate;   // W'
    Double2 late;   // S - S^T
    Double2 second; // -2 S^T
} ImpulsePlaceColumn;

typedef struct ImpulseCurves {
    const Linkage *linkage; // whose driven bodies are left alone
    size_t body_count;
    size_t row_count;
    size_t place_count;
    double width_s;                    // of the step
    ImpulseCurve *bodies;              // by body IMPULSE_HALVES; owned, as all arrays
    ImpulseColumn *columns;            // of a body those of all rows, body by body
    ImpulseCurve *places;              // of the first two rows of each place
    ImpulsePlaceColumn *place_columns; // of a place those of all rows, place by place
} ImpulseCurves;

// Room for curves of so many places and rows, and of the bodies of a linkage, which must outlive
// it.
ImpulseCurves impulse_curves_create(const Linkage *linkage, size_t place_count, size_t row_count);
void impulse_curves_finish(ImpulseCurves *curves);
void impulse_curves_carry(ImpulseCurves *curves, Carry *carry);

// Sets how a body moves beside the contacts: from its motion at the start of a step of so many s,
// its mean acceleration, how that changes, 1/s of it, and what its position at the end has beyond
// these; three numbers each.
void impulse_curves_set_body(ImpulseCurves *curves, size_t body, const Motion *before,
                             const double *mean, const double *rate, const double *rest);

// Sets what the rows do: by row and body three numbers, in this step and the two before, the last
// of them first, and when these had their middles, s; and how it changes in this step.
void impulse_curves_set_columns(ImpulseCurves *curves, double *const columns[KERNEL_COLUMNS_KNOWN],
                                const double middles_s[KERNEL_COLUMNS_KNOWN], const double *rates);

// Sets how the places go, from a kernel that has run.
void impulse_curves_set_places(ImpulseCurves *curves, const Kernel *kernel);

// Writes where the first two rows of a place are at a time since the step's start, m, and how fast
// they go, with the contacts' sums up to then.
void impulse_curves_place_at(const ImpulseCurves *curves, size_t place, double since_s,
                             const KernelSums *sums, double position[2], double speed[2]);

// Writes how the bodies move at a time since the step's start, with the contacts' sums up to then.
void impulse_curves_at(const ImpulseCurves *curves, double since_s, const KernelSums *sums,
                       Motion *motions);

// Writes what forces in the rows do to the speeds of all bodies, per second, three each, at a time
// since mid-step, s.
void impulse_curves_press(const ImpulseCurves *curves, double off_s, const double *forces,
                          double *rates);
