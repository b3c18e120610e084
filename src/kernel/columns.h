// What impulses in the rows of contacts do to the coordinates of bodies within a step: the formulas
// that all share who integrate contacts inside a step (kernel/step.h, the library's worlds, the
// drivers of other engines).
//
// Arrays by row and coordinate have the coordinates of the first row first. A is what an impulse of
// 1 in a row does to the speeds at mid-step, A' its rate; P, Q and R are the contacts' impulses,
// their integrals over time and those of these, as KernelSums has them.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { KERNEL_COLUMNS_KNOWN = 3 }; // steps of which A is kept: a parabola in time

typedef struct KernelColumns {
    size_t rows;
    size_t coordinates;
    const double *columns; // A
    const double *rates;   // A', 1/s of it; NULL where A is taken as constant
} KernelColumns;

// Adds what the contacts have done to speeds and positions, so many s after mid-step, from their
// impulses by row, and their integrals by row and those of these.
void kernel_columns_push(const KernelColumns *of, double off_middle_s, const double *impulse,
                         const double *moment, double *speeds, double *positions);

// Adds what the turning of the rows does to the speeds in a whole step.
void kernel_columns_turn(const KernelColumns *of, double width_s, const double *impulse,
                         const double *moment, double *speeds);

// How much further a coordinate is at the end of a step than the mean of its speeds at the start
// and after the world's own step says: moved and pushed are what the contacts did to it, turned the
// part of the rows' turning, which the world's step has not.
static inline double kernel_columns_late(double half_s, double moved, double pushed, double turned)
{
    return moved - half_s * (pushed - turned);
}

// The polynomial in time through what is known at some times, at most KERNEL_COLUMNS_KNOWN, of
// which no two are the same: its value and its rate at a time are sums over what is known, of these
// shares.
typedef struct KernelShares {
    double value[KERNEL_COLUMNS_KNOWN];
    double rate[KERNEL_COLUMNS_KNOWN]; // 1/s
} KernelShares;

KernelShares kernel_columns_shares(const double *times_s, size_t known, double time_s);

// Writes the free accelerations of rows behind a step's impulses, which have changed them by 2 S P
// (kernel/motion.c); of no impulses (NULL) as they were. Returns whether that is so little that
// the next ones tell how they change by themselves.
bool kernel_columns_free_after(size_t rows, const double *drift, const double *impulse,
                               const double *free, double *free_after);
