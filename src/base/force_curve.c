// Evaluates a force over a deflection that is given by points.
//
// With h the width of a piece, d its secant, m the slopes at its ends and s from its first point,
//     value = f + m_0 s + (3 d - 2 m_0 - m_1) s^2 / h + (m_0 + m_1 - 2 d) s^3 / h^2
// and at a point between pieces of widths h_0 and h_1, whose secants have one sign,
//     m = 3 (h_0 + h_1) / ((2 h_1 + h_0) / d_0 + (h_1 + 2 h_0) / d_1)
#include "base/force_curve.h"

#include "base/load_table.h"

#include <assert.h>
#include <math.h>

const char *const FORCE_CURVE_SHAPES[] = {
    [FORCE_CURVE_LINEAR] = "linear", [FORCE_CURVE_SMOOTH] = "smooth", NULL};

static double width_of(const ForceCurve *curve, size_t piece)
{
    return curve->at[piece + 1] - curve->at[piece];
}

static double secant_of(const ForceCurve *curve, size_t piece)
{
    return (curve->values[piece + 1] - curve->values[piece]) / width_of(curve, piece);
}

void force_curve_settle(ForceCurve *curve, ForceCurveShape shape)
{
    curve->is_smooth = shape == FORCE_CURVE_SMOOTH;
    if (curve->count < 2) {
        return;
    }
    const size_t last = curve->count - 1;
    curve->slopes[0] = secant_of(curve, 0);
    curve->slopes[last] = secant_of(curve, last - 1);
    for (size_t i = 1; i < last; i++) {
        const double h0 = width_of(curve, i - 1);
        const double h1 = width_of(curve, i);
        const double d0 = secant_of(curve, i - 1);
        const double d1 = secant_of(curve, i);
        curve->slopes[i] =
            d0 * d1 > 0.0 ? 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / d0 + (h1 + 2.0 * h0) / d1) : 0.0;
    }
}

// The piece that begins at a point.
static LoadPiece piece_of(const ForceCurve *curve, size_t piece)
{
    const double h = width_of(curve, piece);
    const double d = secant_of(curve, piece);
    const double m0 = curve->is_smooth ? curve->slopes[piece] : d;
    const double m1 = curve->is_smooth ? curve->slopes[piece + 1] : d;
    return (LoadPiece){
        curve->at[piece],
        {curve->values[piece], m0, (3.0 * d - 2.0 * m0 - m1) / h, (m0 + m1 - 2.0 * d) / (h * h)}};
}

// The line on which the curve goes on beyond its first or last point.
static LoadPiece end_of(const ForceCurve *curve, size_t point)
{
    return (LoadPiece){curve->at[point], {curve->values[point], curve->slopes[point], 0.0, 0.0}};
}

double force_curve_at(const ForceCurve *curve, double deflection)
{
    assert(curve->count >= 2);
    const size_t last = curve->count - 1;
    size_t low = 0;
    size_t high = curve->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const bool is_before = curve->at[middle] <= deflection;
        low = is_before ? middle + 1 : low;
        high = is_before ? high : middle;
    }
    const LoadPiece piece = low == 0     ? end_of(curve, 0)
                            : low > last ? end_of(curve, last)
                                         : piece_of(curve, low - 1);
    return load_piece_at(&piece, deflection);
}

// The integral from the first point to a deflection.
static double integral_from_first(const ForceCurve *curve, double deflection)
{
    const size_t last = curve->count - 1;
    LoadPiece piece = end_of(curve, 0);
    if (deflection <= curve->at[0]) {
        return load_piece_integral(&piece, curve->at[0], deflection);
    }
    double sum = 0.0;
    for (size_t i = 0; i < last && curve->at[i] < deflection; i++) {
        piece = piece_of(curve, i);
        sum += load_piece_integral(&piece, curve->at[i], fmin(deflection, curve->at[i + 1]));
    }
    piece = end_of(curve, last);
    return deflection > curve->at[last]
               ? sum + load_piece_integral(&piece, curve->at[last], deflection)
               : sum;
}

double force_curve_energy(const ForceCurve *curve, double deflection)
{
    assert(curve->count >= 2);
    return integral_from_first(curve, deflection) - integral_from_first(curve, 0.0);
}

double force_curve_steepest(const ForceCurve *curve)
{
    double steepest = 0.0;
    for (size_t i = 0; i + 1 < curve->count; i++) {
        steepest = fmax(steepest, fabs(secant_of(curve, i)));
    }
    return steepest;
}
