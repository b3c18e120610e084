// Marks onset, largest force, deepest point and end of every contact of a run, and some instants
// between.
#pragma once

#include "model/solver.h"

typedef struct Marking Marking;

// For a trajectory, which receives the marks; NULL where the scenario does not ask for them
// (run.keeps_marks).
Marking *marking_start(const Scenario *scenario, Trajectory *trajectory);

// Takes in a step of a joint with play, by its place in the record, and the largest force and depth
// that are known of it there. Does nothing without a marking, like the next two.
void marking_add(Marking *marking, const StepRecord *step, size_t index, const JointPeak *top);

// Takes in a state at a time in the last step, of a part or of all (NULL).
void marking_see(Marking *marking, const SolverPart *part, size_t joint, const Sample *sample);

// Takes in a force at a time in the last step of which nothing else is known.
void marking_raise(Marking *marking, size_t joint, double force, double time_s);

// Ends the contacts under way, hands the marks to the trajectory and frees the marking, which may
// be NULL.
void marking_finish(Marking *marking);
