// The truth that the reference solver is held against: the same mechanism and contact, integrated
// in quadruple precision by another method from another formulation.
#pragma once

#include "quad_mechanism.h"

typedef struct TruthOptions {
    double tolerance;   // m/s, of the velocities in one step
    size_t steps_max;   // after which the run fails
    double seconds_max; // of processor time, after which it fails; 0: none
} TruthOptions;

// One body at one sample.
typedef struct TruthSample {
    Quad x; // m, of the centre of mass
    Quad y;
    Quad angle;  // rad
    Quad x_rate; // m/s
    Quad y_rate;
    Quad omega; // rad/s
} TruthSample;

typedef struct TruthFigures {
    size_t samples;     // written
    double reached_s;   // time of the last of them, s
    size_t steps;       // accepted
    size_t solves;      // of one step's equations, accepted or not
    size_t evaluations; // of the accelerations
    size_t onsets;      // of contact
    size_t ends;        // of contact
    size_t clamps;      // of a contact's force at zero
    double drift_max;   // m, largest opening of an ideal joint before it was closed again
    double depth_max;   // m, largest penetration seen at a node
    Quad onset_s;       // time of the last onset
    Quad onset_speed;   // d' there, m/s
    Quad end_s;         // time of the last end
    Quad end_speed;     // -d' there, m/s
    Quad energy;        // at the last sample, J, of the bodies that are not driven
} TruthFigures;

// A tolerance of 1e-18 m/s and a million steps.
TruthOptions truth_options_default(void);

// Integrates from time zero and writes samples[k * body_count + body] at rising times, s, the
// first >= 0. Returns false where a step cannot be made; figures may be NULL.
bool truth_run(const QuadProblem *problem, const TruthOptions *options, size_t count,
               const double *times, TruthSample *samples, TruthFigures *figures);
