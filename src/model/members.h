// The mechanisms of a linkage that share nothing but the ground, each as a scenario of its own.
#pragma once

#include "model/solver.h"

// One mechanism.
typedef struct Member {
    Scenario *scenario; // with its bodies and joints alone; owned, as are the arrays
    SolverPart part;
    int *bodies; // of the part
    int *joints;
    Sample sample;
    void *state;    // of the solver; closed with the member
    double elastic; // J, at the end of its last record
} Member;

size_t members_count(const Linkage *linkage);

// Makes the members of a scenario, in the order of their first bodies. They share its tables and
// must not outlive it.
Member *members_make(const Scenario *scenario, size_t *count);
void members_free(Member *members, size_t count, const Solver *solver);

// Writes a member's own sample, or its bodies alone, into that of the whole linkage.
void member_show(const Member *member, Sample *sample);
void member_show_bodies(const Member *member, Sample *sample);
