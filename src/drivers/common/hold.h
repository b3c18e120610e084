// Rows in which drivers hold a mechanism whose contacts are integrated within the step: loops of
// ideal joints that the tree leaves over, and drives that are not one at a constant speed.
//
// With J the rows' Jacobian in the coordinates of the tree and A what a unit force in each does to
// the accelerations, as the engine says,
//     a + A f,   J (a + A f) = r,   J A f = r - J a
// r of a loop is -J' v, of a drive its acceleration less that. Engines close loops by constraints
// that are soft or iterated; these rows close them to a rounding, the same way in each engine.
#pragma once

#include "drivers/common/tree.h"

typedef struct Hold {
    const Tree *tree;
    size_t rows;
    int *joints; // of the loops, two rows each; owned, as all arrays
    size_t loops;
    double *jacobian;      // row by row
    double *columns;       // A, column by column
    double *matrix;        // room: rows by rows
    double *right;         // by row: the forces that were found last
    double *rates;         // room, by coordinate
    DriverMotion *motions; // room
    Vec2 *bends;           // room
} Hold;

Hold hold_make(const Tree *tree);
void hold_finish(Hold *hold);

// What a unit force in a row does to the bodies.
void hold_push(const Hold *hold, size_t row, const DriverMotion *motions, double value,
               DriverAction *actions);

// Finds the Jacobian where the bodies are.
void hold_place(Hold *hold, const DriverMotion *motions);

// Adds to accelerations what the rows do, with which they hold at those positions and rates. A
// drive's piece is that which holds from a time on, s.
void hold_accelerate(Hold *hold, const double *q, const double *v, double from_s, double time_s,
                     double *a);

// Takes from an acceleration, or from what is like one, what the rows do not let it have.
void hold_restrain(Hold *hold, double *a);

// Puts coordinates and rates onto the rows at a time.
void hold_settle(Hold *hold, double from_s, double time_s, double *q, double *v);
