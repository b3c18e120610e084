// A force over a deflection, given by points: straight lines between them or a monotone cubic
// through them, and beyond the first and the last the straight line on which the curve ends there.
// Points on one line give that line. Source of the cubic's slopes: Fritsch and Butland, SIAM J.
// Sci. Stat. Comput. 5 (1984) 300; at the ends they are the secants'.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { FORCE_CURVE_MAX = 64 };

typedef enum ForceCurveShape {
    FORCE_CURVE_LINEAR,
    FORCE_CURVE_SMOOTH,
    FORCE_CURVE_SHAPE_COUNT,
} ForceCurveShape;

extern const char *const FORCE_CURVE_SHAPES[FORCE_CURVE_SHAPE_COUNT + 1]; // words, ending in NULL

typedef struct ForceCurve {
    size_t count;                   // of points, at least 2; 0: there is no curve
    double at[FORCE_CURVE_MAX];     // m or rad, increasing
    double values[FORCE_CURVE_MAX]; // N or N m
    double slopes[FORCE_CURVE_MAX]; // of the cubic, by force_curve_settle
    bool is_smooth;                 // whether it is the cubic
} ForceCurve;

// Finds the slopes, once the points are there.
void force_curve_settle(ForceCurve *curve, ForceCurveShape shape);

// Its value at a deflection, and the integral of it from 0 to there, N m.
double force_curve_at(const ForceCurve *curve, double deflection);
double force_curve_energy(const ForceCurve *curve, double deflection);

// Its steepest slope between points, N/m or N m/rad, by amount.
double force_curve_steepest(const ForceCurve *curve);
