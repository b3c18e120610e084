// How much the bushings of a run bore.
#pragma once

#include "model/trajectory.h"

// The largest of a bushing's numbers at the samples that are reported, by amount, and when each
// was.
typedef struct BushingExtremes {
    Extreme force;      // N, springs and dampers of both axes together
    Extreme torque;     // N m
    Extreme deflection; // m
    Extreme angle;      // rad, from where it is relaxed
} BushingExtremes;

// N, of both axes together, at a sample.
double bushing_force_at(const Trajectory *run, size_t sample, size_t number);

BushingExtremes bushing_extremes(const Trajectory *run, size_t number);
