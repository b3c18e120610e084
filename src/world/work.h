// How much does a step take? Counted, so that it is the same on every machine: in operations on one
// pair of rows or bodies.
#pragma once

#include "world/play.h"

// A step of ODE beside what our rows take in it.
double work_of_step(const JpWorld *world);

// The rows of all sides that touch, solved together where their bodies hang together.
double work_of_rows(const JpWorld *world);
