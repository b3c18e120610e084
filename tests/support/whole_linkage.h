// The equations of motion of a linkage with play, written out whole, as a truth for what solves
// them in parts:
//     [ M  -J' ] [ v ]   [ loads ]
//     [ J   0  ] [ y ] = [ rates ]
// v three values a body, y impulses or forces of the ideal joints. J is taken from the velocities
// of the joints' ends, one unit velocity after the other.
#pragma once

#include "model/kinematics.h"
#include "model/response.h"

enum { WHOLE_COLUMN_MAX = 3 * KINEMATICS_BODY_MAX };

// Rows: two of each ideal joint but the driven one, then two of each joint with play, or four with
// the turns of its two bodies.
typedef struct WholeLinkage {
    const Linkage *linkage;
    const Motion *motions;
    bool with_turns;
    bool with_driven; // the driven body's columns are filled, too
    size_t columns;
    size_t ideal_rows;
    size_t row_count;
    double jacobian[RESPONSE_ROW_MAX][WHOLE_COLUMN_MAX];
} WholeLinkage;

// Keeps the pointers.
WholeLinkage whole_build(const Linkage *linkage, const Motion *motions, bool with_turns,
                         bool with_driven);

// Solves for v and y under loads on the bodies, the ideal rows going at the rates given. The driven
// body's values are its loads. The equations must not be singular.
void whole_solve(const WholeLinkage *whole, const double *loads, const double *rates,
                 double *values, double *reactions);

// The rate of a row at three values a body.
double whole_rate(const WholeLinkage *whole, size_t row, const double *values);

// Writes what impulses in the rows of play are on the bodies, three a body.
void whole_load(const WholeLinkage *whole, const double *impulses, double *loads);

// Writes the rows' accelerations when no free body is accelerated, right to 1e-8 of them: dJ/dt v
// and the driven body's own.
void whole_given(const WholeLinkage *whole, double *accelerations);
