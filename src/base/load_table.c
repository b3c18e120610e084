// Evaluates a load that is given by points.
//
// With h the width of a piece, d its secant and m the slopes at its ends,
//     value = f + m_0 s + (3 d - 2 m_0 - m_1) s^2 / h + (m_0 + m_1 - 2 d) s^3 / h^2
// and at a point between pieces of widths h_0 and h_1, whose secants have one sign,
//     m = 3 (h_0 + h_1) / ((2 h_1 + h_0) / d_0 + (h_1 + 2 h_0) / d_1)
#include "base/load_table.h"

#include <math.h>

const char *const LOAD_SHAPES[] = {
    [LOAD_LINEAR] = "linear", [LOAD_SMOOTH] = "smooth", [LOAD_STEPS] = "steps", NULL};

bool load_table_is_ordered(const LoadTable *table)
{
    for (size_t i = 0; i < table->count; i++) {
        if (!isfinite(table->values[i]) || !isfinite(table->at[i]) ||
            (i > 0 && !(table->at[i] > table->at[i - 1]))) {
            return false;
        }
    }
    if (table->count > 0 && wave_exists(&table->wave) &&
        !(table->count == 1 && isfinite(table->wave.amplitude) && isfinite(table->wave.rate) &&
          isfinite(table->wave.phase))) {
        return false;
    }
    return table->period == 0.0 || table->count == 0 ||
           (table->period > 0.0 && table->at[table->count - 1] - table->at[0] < table->period);
}

static bool repeats(const LoadTable *table)
{
    return table->period > 0.0 && table->count > 1;
}

// From a point to the next one, the first of the next period behind the last.
static double width_of(const LoadTable *table, size_t point)
{
    const bool is_last = point + 1 == table->count;
    return is_last ? table->at[0] + table->period - table->at[point]
                   : table->at[point + 1] - table->at[point];
}

static double secant_of(const LoadTable *table, size_t point)
{
    const size_t next = point + 1 == table->count ? 0 : point + 1;
    return (table->values[next] - table->values[point]) / width_of(table, point);
}

void load_table_settle(LoadTable *table)
{
    for (size_t i = 0; i < table->count; i++) {
        table->slopes[i] = 0.0;
        if (!repeats(table) && (i == 0 || i + 1 == table->count)) {
            continue;
        }
        const size_t before = i == 0 ? table->count - 1 : i - 1;
        const double h0 = width_of(table, before);
        const double h1 = width_of(table, i);
        const double d0 = secant_of(table, before);
        const double d1 = secant_of(table, i);
        if (d0 * d1 > 0.0) {
            table->slopes[i] = 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / d0 + (h1 + 2.0 * h0) / d1);
        }
    }
}

// The piece that begins at a point, which stands at `from` in the present period.
static LoadPiece piece_of(const LoadTable *table, size_t point, double from)
{
    LoadPiece piece = {from, {table->values[point], 0.0, 0.0, 0.0}};
    const size_t next = point + 1 == table->count ? 0 : point + 1;
    const double h = width_of(table, point);
    const double d = secant_of(table, point);
    if (table->shape == LOAD_LINEAR) {
        piece.c[1] = d;
    } else if (table->shape == LOAD_SMOOTH) {
        const double m0 = table->slopes[point];
        const double m1 = table->slopes[next];
        piece.c[1] = m0;
        piece.c[2] = (3.0 * d - 2.0 * m0 - m1) / h;
        piece.c[3] = (m0 + m1 - 2.0 * d) / (h * h);
    }
    return piece;
}

// The last point at or before an argument, with a negative sign before it alone, and what periods
// have gone by then; `count` where there is none.
static size_t point_before(const LoadTable *table, double at, double sign, double *passed)
{
    *passed = 0.0;
    if (repeats(table)) {
        *passed = table->period * floor((at - table->at[0]) / table->period);
    }
    const double own = at - *passed;
    size_t low = 0;
    size_t high = table->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const bool is_before = sign < 0.0 ? table->at[middle] < own : table->at[middle] <= own;
        low = is_before ? middle + 1 : low;
        high = is_before ? high : middle;
    }
    if (low > 0) {
        return low - 1;
    }
    if (repeats(table)) {
        *passed -= table->period;
        return table->count - 1;
    }
    return table->count;
}

LoadPiece load_table_piece(const LoadTable *table, double at, double sign)
{
    double passed;
    if (table->count <= 1) {
        return (LoadPiece){at, {table->count == 0 ? 0.0 : table->values[0], 0.0, 0.0, 0.0}};
    }
    const size_t point = point_before(table, at, sign, &passed);
    if (point == table->count) {
        return (LoadPiece){at, {table->values[0], 0.0, 0.0, 0.0}};
    }
    if (point + 1 == table->count && !repeats(table)) {
        return (LoadPiece){at, {table->values[point], 0.0, 0.0, 0.0}};
    }
    return piece_of(table, point, passed + table->at[point]);
}

double load_piece_at(const LoadPiece *piece, double at)
{
    const double s = at - piece->from;
    const double *c = piece->c;
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
}

// Where a point stands, those before and behind the present period counted on; infinite where there
// is none.
static double place_of(const LoadTable *table, long point, double passed)
{
    const long count = (long)table->count;
    if (point < 0) {
        return repeats(table) ? passed - table->period + table->at[point + count] : -INFINITY;
    }
    if (point >= count) {
        return repeats(table) ? passed + table->period + table->at[point - count] : INFINITY;
    }
    return passed + table->at[point];
}

double load_table_next(const LoadTable *table, double at, double sign)
{
    const long step = sign < 0.0 ? -1 : 1;
    double passed;
    if (table->count <= 1) {
        return step < 0 ? -INFINITY : INFINITY;
    }
    const size_t before = point_before(table, at, sign, &passed);
    long point = before == table->count ? -1 : (long)before;
    point += step > 0 ? 1 : 0;
    double next = place_of(table, point, passed);
    // rounding of the period may put a point that has been reached behind it
    while ((double)step * (next - at) <= 0.0) {
        point += step;
        next = place_of(table, point, passed);
    }
    return next;
}

double load_piece_integral(const LoadPiece *piece, double from, double to)
{
    const double *c = piece->c;
    const double a = from - piece->from;
    const double b = to - piece->from;
    const double upper = b * (c[0] + b * (c[1] / 2.0 + b * (c[2] / 3.0 + b * c[3] / 4.0)));
    const double lower = a * (c[0] + a * (c[1] / 2.0 + a * (c[2] / 3.0 + a * c[3] / 4.0)));
    return upper - lower;
}

double load_table_value(const LoadTable *table, double from, double sign, double at)
{
    const LoadPiece piece = load_table_piece(table, from, sign);
    const double value = load_piece_at(&piece, at);
    return wave_exists(&table->wave) ? value + wave_at(&table->wave, at) : value;
}

double load_table_mean(const LoadTable *table, double from, double to)
{
    if (wave_exists(&table->wave)) {
        return table->values[0] + wave_mean(&table->wave, from, to);
    }
    const double sign = to < from ? -1.0 : 1.0;
    double sum = 0.0;
    double at = from;
    while (sign * (to - at) > 0.0) {
        const LoadPiece piece = load_table_piece(table, at, sign);
        const double next = load_table_next(table, at, sign);
        const double end = sign * (next - to) < 0.0 ? next : to;
        sum += load_piece_integral(&piece, at, end);
        at = end;
    }
    return sum / (to - from);
}

double load_table_largest(const LoadTable *table)
{
    double largest = 0.0;
    for (size_t i = 0; i < table->count; i++) {
        largest = fmax(largest, fabs(table->values[i]));
    }
    return largest + (wave_exists(&table->wave) ? fabs(table->wave.amplitude) : 0.0);
}
