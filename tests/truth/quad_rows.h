// Quadruple precision in the plane, and the rows of the ideal joints of a mechanism.
#pragma once

#include "model/kinematics.h"
#include "quad_mechanism.h"

enum { QUAD_ROW_MAX = 2 * KINEMATICS_JOINT_MAX };

// One side of a row: what it takes of the body's x, y and angle.
typedef struct QuadRow {
    Quad x;
    Quad y;
    Quad turn;
} QuadRow;

// The rows of the joints taken as ideal, at one position, ready to be solved.
typedef struct QuadRows {
    size_t joint_count;
    size_t joints[KINEMATICS_JOINT_MAX];
    QuadRow row[QUAD_ROW_MAX][2];            // of body a, of body b
    Quad factor[QUAD_ROW_MAX][QUAD_ROW_MAX]; // L and D of J M^-1 J^T
} QuadRows;

Quad quad_dot(QuadVec a, QuadVec b);
QuadVec quad_difference(QuadVec a, QuadVec b);

// From a body's centre of mass to a point of its frame, in the world; the point for the ground.
QuadVec quad_arm(const Quad *position, int body, QuadVec local);

// A point at an arm from a body's centre of mass, and its velocity.
QuadVec quad_point(const Quad *position, int body, QuadVec arm);
QuadVec quad_point_velocity(const Quad *velocity, int body, QuadVec arm);

// The unit vector along a direction in a body's frame, and how fast a body turns, rad/s.
QuadVec quad_along(const Quad *position, int body, Quad direction);
Quad quad_omega(const Quad *velocity, int body);

// Adds to coordinates what a force at an arm from a body's centre of mass gives: M^-1 times it.
// A body that does not move freely takes nothing.
void quad_push(const QuadProblem *problem, int body, QuadVec arm, QuadVec force, Quad *coordinates);

// The rows of every ideal joint but the driver's; with play, of the joints with play as well.
QuadRows quad_rows_make(const QuadProblem *problem, const Quad *position, bool with_play);

// What the rows make of velocities or accelerations, and by how much the rates of the rows change
// while the coordinates' rates are steady.
void quad_rows_of(const QuadProblem *problem, const QuadRows *rows, const Quad *coordinates,
                  Quad *values);
void quad_rows_bias(const QuadProblem *problem, const QuadRows *rows, const Quad *position,
                    const Quad *velocity, Quad *values);

// Adds M^-1 J^T lambda to coordinates, with (J M^-1 J^T) lambda = right; right is overwritten.
void quad_rows_apply(const QuadProblem *problem, const QuadRows *rows, Quad *right,
                     Quad *coordinates);

// Moves the free bodies onto those rows, positions and velocities. Returns the largest distance, m,
// by which a joint stood open before.
Quad quad_rows_project(const QuadProblem *problem, bool with_play, Quad *position, Quad *velocity);
