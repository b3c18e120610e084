// Reads the stiffness of a contact as the depth that a force may press it to.
#pragma once

#include "casefile/target.h"

// A depth, m or rad, and the force, N, or torque, N m, at it; with the exponent n of K d^n.
typedef struct StiffnessFor {
    double depth;
    double force;
    double exponent;
} StiffnessFor;

// Reads `0.1 mm at 500 N`, `0.1 mm at 500 N with exponent 1.5`, or of an angle `0.2 deg at 3 N m`.
bool stiffness_for_read(const char *text, bool is_turning, StiffnessFor *read,
                        Complaint *complaint);

// Stores the stiffness of the contact that all joints share, or of a joint.
bool stiffness_for_store(const Target *target, Scenario *scenario);
