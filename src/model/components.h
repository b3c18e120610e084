// The mechanisms of a linkage that share nothing but the ground, each as a scenario of its own.
#pragma once

#include "model/solver.h"

// One mechanism.
typedef struct Component {
    Scenario *scenario; // with its bodies and joints alone; owned, as are the arrays
    SolverPart part;
    int *bodies; // of the part
    int *joints;
    Sample sample;
    void *state;    // of the solver; closed with the component
    double elastic; // J, at the end of its last record
} Component;

size_t components_count(const Linkage *linkage);

// Makes the components of a scenario, in the order of their first bodies. They share its tables and
// must not outlive it.
Component *components_make(const Scenario *scenario, size_t *count);
void components_free(Component *components, size_t count, const Solver *solver);

// Writes a component's own sample, or its bodies alone, into that of the whole linkage.
void component_show(const Component *component, Sample *sample);
void component_show_bodies(const Component *component, Sample *sample);
void component_show_some(const Component *component, const SolverSome *some, Sample *sample);
