// Dampers of joints with play that act in the gap, too, as an oil film does.
#pragma once

#include "model/coordinate.h"

enum { GAP_DAMPING_ROWS = 2 }; // of a joint, at most

// One row of such a damper, whose drag is its coefficient times its rate.
typedef struct GapDampingRow {
    JointRow row;   // on the bodies of the joint
    double rate;    // m/s or rad/s
    double damping; // N s/m or N m s/rad
    bool is_turn;   // whether it turns the bodies against each other; else it is a force on a line
} GapDampingRow;

// Writes the rows of a joint at the motions given. Returns how many; 0 where it has no such damper.
size_t gap_damping_rows(const Linkage *linkage, const Motion *motions, int joint,
                        GapDampingRow rows[GAP_DAMPING_ROWS]);

// The point of a body, in the world, that is on the line of a row's force.
Vec2 gap_damping_point(const GapDampingRow *row, const Motion *motions, int side, int body);
