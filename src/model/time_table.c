// What is a quantity that is given by points over time?
//
//     f(t) = f_i + (f_i+1 - f_i) (t - t_i) / (t_i+1 - t_i)     t_i <= t < t_i+1
#include "model/time_table.h"

#include <math.h>

bool time_table_is_ordered(const TimeTable *table)
{
    for (size_t i = 0; i < table->count; i++) {
        if (!isfinite(table->values[i]) || !isfinite(table->times[i]) ||
            (i > 0 && !(table->times[i] > table->times[i - 1]))) {
            return false;
        }
    }
    return true;
}

// The line between two points of the table, at a time on it or beyond it.
static double on_line(const TimeTable *table, size_t first, double time_s)
{
    const double width_s = table->times[first + 1] - table->times[first];
    const double share = (time_s - table->times[first]) / width_s;
    return table->values[first] + share * (table->values[first + 1] - table->values[first]);
}

// The first point after a time, and after time zero.
static size_t point_after(const TimeTable *table, double time_s)
{
    size_t after = 0;
    while (after < table->count && table->times[after] <= fmax(time_s, 0.0)) {
        after++;
    }
    return after;
}

double time_table_at(const TimeTable *table, double time_s)
{
    if (table->count == 0) {
        return 0.0;
    }
    const size_t after = point_after(table, time_s);
    return after == 0              ? table->values[0]
           : after == table->count ? table->values[after - 1]
                                   : on_line(table, after - 1, time_s);
}

TimePiece time_table_piece(const TimeTable *table, double time_s)
{
    if (table->count == 0) {
        return (TimePiece){.value = 0.0};
    }
    const size_t after = point_after(table, time_s);
    const size_t first = after == 0 ? 0 : after - 1;
    TimePiece piece = {.time_s = table->times[first], .value = table->values[first]};
    if (after > 0 && after < table->count) {
        piece.slope = (table->values[after] - piece.value) / (table->times[after] - piece.time_s);
    }
    return piece;
}

double time_table_next_bend(const TimeTable *table, double time_s)
{
    for (size_t i = 0; i < table->count; i++) {
        if (table->times[i] > time_s) {
            return table->times[i];
        }
    }
    return INFINITY;
}

double time_table_mean(const TimeTable *table, double from_s, double to_s)
{
    // piece by piece: the mean of a line is its value in the middle
    double sum = 0.0;
    for (double start_s = from_s; start_s < to_s;) {
        const double end_s = fmin(to_s, fmax(time_table_next_bend(table, start_s), 0.0));
        sum += (end_s - start_s) * time_table_at(table, 0.5 * (start_s + end_s));
        start_s = end_s;
    }
    return sum / (to_s - from_s);
}

// Of one piece between two times.
static long double piece_integral(const TimePiece *piece, long double from_s, long double to_s)
{
    const long double middle_s = 0.5L * (from_s + to_s) - piece->time_s;
    return (to_s - from_s) * (piece->value + piece->slope * middle_s);
}

long double time_table_integral(const TimeTable *table, long double time_s)
{
    long double sum = 0.0L;
    double start_s = 0.0;
    double bend_s = time_table_next_bend(table, start_s);
    for (; bend_s < time_s; bend_s = time_table_next_bend(table, start_s)) {
        const TimePiece piece = time_table_piece(table, start_s);
        sum += piece_integral(&piece, start_s, bend_s);
        start_s = bend_s;
    }
    const TimePiece piece = time_table_piece(table, start_s);
    return sum + piece_integral(&piece, start_s, time_s);
}

double time_table_largest(const TimeTable *table)
{
    double largest = 0.0;
    for (size_t i = 0; i < table->count; i++) {
        largest = fabs(table->values[i]) > fabs(largest) ? table->values[i] : largest;
    }
    return largest;
}
