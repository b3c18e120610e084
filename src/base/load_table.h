// A load over time, an angle or a position: linear between its points, a monotone cubic through
// them, or steps that hold from each point to the next; constant beyond both ends, or the same
// again in every period.
//
// The cubic has no slope where the points turn or end, so that it never leaves the range of two
// neighbours. Source: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300.
#pragma once

#include "base/wave.h"

#include <stdbool.h>
#include <stddef.h>

enum { LOAD_TABLE_MAX = 400 }; // an indicator diagram by degrees, and some

typedef enum LoadShape { LOAD_LINEAR, LOAD_SMOOTH, LOAD_STEPS, LOAD_SHAPE_COUNT } LoadShape;

extern const char *const LOAD_SHAPES[LOAD_SHAPE_COUNT + 1]; // their words, ending in NULL

typedef struct LoadTable {
    size_t count;                  // of points; one is a constant
    double at[LOAD_TABLE_MAX];     // s, rad or m, increasing
    double values[LOAD_TABLE_MAX]; // N or N m
    double slopes[LOAD_TABLE_MAX]; // of the cubic, by load_table_settle
    double period;                 // in the unit of `at`, more than from first to last; 0: none
    LoadShape shape;
    Wave wave; // over time, added to the one point that there is then
} LoadTable;

// Whether all numbers are finite and the points in order, within one period.
bool load_table_is_ordered(const LoadTable *table);

// Finds the slopes, once points, period and shape are there.
void load_table_settle(LoadTable *table);

// What holds between two neighbouring points: with s = at - from,
//     value = c[0] + c[1] s + c[2] s^2 + c[3] s^3
typedef struct LoadPiece {
    double from;
    double c[4];
} LoadPiece;

// The piece that holds from there on, towards larger arguments, or with a negative sign towards
// smaller ones.
LoadPiece load_table_piece(const LoadTable *table, double at, double sign);

double load_piece_at(const LoadPiece *piece, double at);

// The integral of a piece between two arguments.
double load_piece_integral(const LoadPiece *piece, double from, double to);

// The first point after an argument in that direction; INFINITY with its sign where there is none.
double load_table_next(const LoadTable *table, double at, double sign);

// The mean between two different arguments, exact.
double load_table_mean(const LoadTable *table, double from, double to);

// The value there, its wave with it: of the piece that holds from another argument on in a
// direction.
double load_table_value(const LoadTable *table, double from, double sign, double at);

// The largest size of a value.
double load_table_largest(const LoadTable *table);
