// The parts in which a step with contacts integrated inside it is handed on: they end where a
// contact begins, ends, or shows a maximum, so that no peak is missed whatever the step. In the
// plane and in space.
#pragma once

#include "model/solver.h"
#include "ode/marks.h"

typedef struct ImpulsePart {
    Marks marks; // of the step
    size_t most_rows;
    double start_s;
    double end_s;
    bool is_last;    // of its step
    KernelSums sums; // at its end; of these only the impulses are zero when a step begins
    KernelSums before;
    double *omega; // by body; owned, as are all arrays
    double *alpha;
    double *impulse; // by joint
    double *approach;
    double *since_s; // s, of the contact that is told
    bool *is_known;
    StepRecord record;
} ImpulsePart;

// For a kernel of so many rows.
void impulse_part_init(ImpulsePart *part, const Linkage *linkage, size_t rows);

// Whether the next part begins a new step, which is then to be taken and given to
// impulse_part_begin.
bool impulse_part_needs_step(const ImpulsePart *part);

// Begins a step that has been taken, at a time.
void impulse_part_begin(ImpulsePart *part, const Kernel *kernel, double start_s);

// Goes on to the next part of a step that began and ends then; returns the mark at its end.
const Mark *impulse_part_next(ImpulsePart *part, const Kernel *kernel, double step_start_s,
                              double step_end_s);

// Fills in the record, but for turning and joints, and what the joints do beside the contacts,
// whose states at the end of the part are given.
void impulse_part_record(ImpulsePart *part, const Linkage *linkage, const JointState *joints);

// Adds the contacts to the record: by joint their impulses and the speeds at which they began, of
// the place that touches since the shortest time; what is stored in them. By place: how deep it is,
// m, and whether it counts as a contact of its joint (NULL: all do).
void impulse_part_add_contacts(ImpulsePart *part, const Kernel *kernel, const Mark *mark,
                               const double *depths, const bool *counts);

// Adds one place with the impulse, N s, that came of it in the part.
void impulse_part_add_place(ImpulsePart *part, const KernelContact *place, bool is_touching,
                            double pushed);

void impulse_part_finish(ImpulsePart *part);
