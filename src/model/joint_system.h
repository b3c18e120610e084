// The rows of the ideal joints and the drive of a linkage of any size, for what asks for one
// solution of them: positions that close the joints, speeds that keep them closed, and how many
// rows are independent. With J the rows and M the masses and inertias, J M^-1 J' is zero but where
// two joints share a body; its factor takes memory and time in proportion to the joints of chains,
// trees and loops.
#pragma once

#include "base/sparse.h"
#include "model/linkage.h"

// The rows of a joint, two, or of the drive, one.
typedef struct JointBlock {
    size_t first_row;
    size_t row_count;
    int bodies[2];           // LINKAGE_GROUND: none
    double entries[2][2][3]; // by row, side and x, y, angle: over the root of the mass, in parts of
                             // the row's length
    double lengths[2];       // of the rows, with columns over the root of the mass
} JointBlock;

typedef struct JointSystem {
    const Linkage *linkage;
    size_t row_count;
    size_t block_count;
    JointBlock *blocks; // owned
    double *scales;     // root of the mass, by column; owned
    Sparse products;    // of the rows
} JointSystem;

// Finds the rows at given positions, of the joints for which `include` is true (all where it is
// NULL; a stop has none), then of the driver if there is one and `with_driver` is set; and factors
// their products. For joint_system_finish.
void joint_system_init(const Linkage *linkage, const Motion *motions, const bool *include,
                       bool with_driver, JointSystem *system);
void joint_system_finish(JointSystem *system);

// How many rows are independent.
size_t joint_system_rank(const JointSystem *system);

// The least change, three numbers a body, in the norm of the masses, that changes what the rows say
// by what is wanted. Of redundant rows that do not agree: the nearest to it.
void joint_system_least_change(const JointSystem *system, const double *wanted, double *change);
