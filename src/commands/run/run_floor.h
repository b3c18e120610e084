// Below which size is a number of a run nothing but rounding?
#pragma once

#include "commands/run/run_report.h"

// Of each quantity what one rounding is of the largest that the mechanism has of it, or gravity
// makes of it: tables for people show what is below as 0. Files keep their numbers.
typedef struct RunFloor {
    double turning;      // rad/s
    double spinning_up;  // rad/s^2
    double length;       // m
    double speed;        // m/s
    double acceleration; // m/s^2
    double force;        // N
    double energy;       // J, and N m
} RunFloor;

// Of every run of a report, all zero of one that is not complete; the caller frees it.
RunFloor *run_floor_list(const RunReport *report);

// The value, or 0 where it is below the floor.
double run_floor_cut(double value, double floor);

// The numbers of a body, a joint and of the energy of a run as tables show them.
BodyExtremes run_floor_body(const BodyExtremes *body, const RunFloor *floor);
RunJoint run_floor_joint(const RunJoint *joint, bool is_torsional, const RunFloor *floor);
Energy run_floor_energy(const Energy *energy, const RunFloor *floor);
