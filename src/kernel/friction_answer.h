// Whether the frictions of ideal joints, which change what presses in these, have one answer.
#pragma once

#include "base/err.h"
#include "kernel/kernel.h"

#include <stdbool.h>
#include <stddef.h>

// How much each of n frictions grows at most with each other, row by row, 1: frictions have one
// answer where that contracts, which it does where its largest eigenvalue is below 1. Returns -1
// where it is, else the number of a friction that grows with the others too much. `room` is for 2 n
// numbers.
//
// In a weighted maximum norm (A x)_i < x_i for some x > 0 says so (L. Collatz, Math. Z. 48 (1942)
// 221; H. Wielandt, likewise 52 (1950) 642).
int friction_answer_fails(size_t n, const double *matrix, double *room);

// The same of a kernel's frictions of ideal joints, whose answers to its rows are filled in: the
// number of the rub. `room` is for n (n + 2) numbers of its n rubs.
int friction_answer_of_rubs_fails(const Kernel *kernel, double *room);

// Says so of a joint: ERR_SOLVER.
bool friction_answer_refuse(const char *joint, Err *err);
