// The table of the numbers of a joint (joint_number_list.h), and how each is had from a run.
#pragma once

#include "model/joint_number_list.h"
#include "model/trajectory.h"

typedef struct JointNumber {
    const char *name;
    JointNumberKind kind;
    bool is_of_play;       // of joints with play alone
    bool is_timed;         // it has a time at which it stood
    bool is_detail;        // its column is left out where there is no room
    const char *format;    // for people; NULL: four digits
    const char *titles[2]; // of its column; [1] where limits turn the joint, as in the two below
    const char *keys[2];   // name and unit, SI
    const char *units[2];  // for people
    const char *crank_key; // of the crank's angle at that time
    const char *check_end; // what a metric of check has behind the key
    const char *meaning;
} JointNumber;

extern const JointNumber JOINT_NUMBERS[JOINT_NUMBER_COUNT];

// The number of a joint in a run, SI; NAN where it is of play and the run lets none happen.
Extreme joint_numbers_find(JointNumberId id, const Trajectory *run, size_t joint);
