// What many starts beside a scenario's own have in common: medians, with their standard errors.
#pragma once

#include "model/kinematics.h"
#include "model/perturb.h"

enum { STARTS_MAX = 256 };

typedef struct Median {
    double value;
    double error; // standard error
} Median;

typedef struct Starts {
    double size;   // 1: of the perturbations, see model/perturb.h
    unsigned seed; // of their directions
    size_t count;  // at most STARTS_MAX
} Starts;

// What a perturbation is relative to: the largest speeds of the reference's run.
void starts_units(const Scenario *scenario, PerturbUnit units[KINEMATICS_BODY_MAX]);

// Up to when a start can be followed, s: to where small perturbations have grown 1e5 times.
Median starts_horizon(const Scenario *scenario, const PerturbUnit *units, Starts starts);

// Largest force, N, and impulse, N s, of a joint in ODE.
void starts_impact(const Scenario *scenario, const PerturbUnit *units, Starts starts, size_t joint,
                   Median *force, Median *impulse);
