// The solution that errors are measured against, with its own uncertainty and how far it holds.
#pragma once

#include "run/run.h"

typedef struct Truth {
    Trajectory *trajectory;      // owned; complete, unless its message says why there is none
    double uncertainty;          // 1: as the error of a run, up to the horizon, from two
                                 // further runs; above 0; INFINITY where unknown
    double horizon_s;            // up to when trajectories may be compared: where neither these two
                                 // nor the fastest of all starts 1e-10 beside is too far away
    double growth;               // 1: by how much that one's distance grew up to the horizon
    bool is_limited;             // whether the horizon ends before the run does
    bool is_uncertified;         // because it was not requested
    char message[ERR_TEXT_SIZE]; // why it is not certified; empty where it is
} Truth;

// The truth of a scenario: the reference, certified by two tighter runs and perturbed ones.
// With ideal joints alone it is the closed form, certified by the reference. A truth that cannot be
// had holds an incomplete trajectory with the reason. The watch sees the runs in the caller's
// thread.
Truth truth_make(const Scenario *scenario, RunWatch watch);

// The same on so many threads, with the same numbers.
Truth truth_make_on(const Scenario *scenario, RunWatch watch, size_t threads);

// The first run of it alone: its uncertainty and horizon are not known, as its message says.
Truth truth_make_uncertified(const Scenario *scenario, RunWatch watch);
void truth_finish(Truth *truth);

// The scenario with another tolerance of the reference: ten times looser, or tighter where no run
// is as loose.
Scenario truth_at_other_tolerance(const Scenario *scenario);

// How sure a certified truth is of what a tolerance is of, up to a time, s: of motion as it says
// itself; of forces and peaks by how far a run of the reference at another tolerance is off, 1.
// INFINITY where that run fails.
double truth_uncertainty_of(const Truth *truth, const Scenario *scenario, ToleranceOf kind,
                            double until_s, RunWatch watch);

// The backend that errors of a scenario are taken against.
BackendKind truth_backend(const Scenario *scenario);

// A truth as one flat piece of memory, so that a child can make it and its parent have it.

// Bytes that the truth of a scenario takes, whatever becomes of it.
size_t truth_pack_size(const Scenario *scenario);

// Copies the truth into that many bytes.
void truth_pack_write(const Truth *truth, void *packed);

// The truth that was packed, of the same scenario. The caller finishes it.
Truth truth_pack_read(const Scenario *scenario, const void *packed);
