// The problems on which the reference is held against the truth: the paper's four-bar at 1000 rpm,
// K = 6.6e10 N/m^1.5, Lankarani-Nikravesh damping for a restitution of 0.9, pins centred.
#pragma once

#include "quad_mechanism.h"

enum { PROBLEM_COUNT = 6 };

typedef struct ProblemChoice {
    const char *name;
    const char *joints[4]; // with play, up to a NULL
    double clearance;      // m, radial
    double friction;       // 1
    double duration;       // s, the longest of interest
} ProblemChoice;

extern const ProblemChoice PROBLEMS[PROBLEM_COUNT];

Scenario problem_scenario(const ProblemChoice *choice);
