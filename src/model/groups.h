// The groups of bodies that a driver determines one after the other: each closes on the ground, the
// driven body and the groups before it, and none can be split (Assur's groups).
#pragma once

#include "model/kinematics.h"

typedef struct Group {
    size_t body_count; // its joints are 3/2 of that
    int bodies[KINEMATICS_BODY_MAX];
    size_t joint_count;
    int joints[KINEMATICS_JOINT_MAX]; // that hold them on one another and on what is there already
} Group;

typedef struct Groups {
    size_t count;
    Group groups[KINEMATICS_BODY_MAX / 2];
} Groups;

// Finds the groups of a linkage with a driver and ideal joints, in the order in which they follow
// from the driver. Bodies that belong to none, because more or fewer joints hold them than are
// needed, are left out.
void groups_find(const Linkage *linkage, Groups *groups);
