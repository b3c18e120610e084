// Evaluates a quantity that is given by points over time.
//
//     f(t) = f_i + (f_i+1 - f_i) (t - t_i) / (t_i+1 - t_i)     t_i <= t < t_i+1
//     f(t + T) = f(t)                                          with a period T
#include "base/time_table.h"

#include <math.h>

bool time_table_is_ordered(const TimeTable *table)
{
    for (size_t i = 0; i < table->count; i++) {
        if (!isfinite(table->values[i]) || !isfinite(table->times[i]) ||
            (i > 0 && !(table->times[i] > table->times[i - 1]))) {
            return false;
        }
    }
    if (table->count > 0 && wave_exists(&table->wave) &&
        !(table->count == 1 && isfinite(table->wave.amplitude) && isfinite(table->wave.rate) &&
          isfinite(table->wave.phase))) {
        return false;
    }
    const size_t last = table->count - 1;
    return table->period_s == 0.0 || table->count == 0 ||
           (isfinite(table->period_s) && table->times[last] - table->times[0] < table->period_s);
}

// Points are numbered from 0. Those of a table that repeats go on in both directions: number 0 is
// the first of the table, at time zero or later.

// The number of the period that a point is of.
static long period_of(const TimeTable *table, long point)
{
    const long count = (long)table->count;
    return point >= 0 ? point / count : -((count - 1 - point) / count);
}

static size_t place_of(const TimeTable *table, long point)
{
    return (size_t)(point - period_of(table, point) * (long)table->count);
}

static double time_of(const TimeTable *table, long point)
{
    return (double)period_of(table, point) * table->period_s + table->times[place_of(table, point)];
}

// Whether there is a point of that number.
static bool is_there(const TimeTable *table, long point)
{
    return table->period_s > 0.0 || (point >= 0 && point < (long)table->count);
}

// From a point to the next one, by their places in the table: the first follows the last.
static double width_of(const TimeTable *table, size_t from, size_t to)
{
    const double width_s = table->times[to] - table->times[from];
    return to > from ? width_s : width_s + table->period_s;
}

// The first point after a time, and after time zero.
static long point_after(const TimeTable *table, double time_s)
{
    const double from_s = fmax(time_s, 0.0);
    long after = 0;
    if (table->period_s > 0.0) {
        // rounding may make it one period too many
        const double periods = floor((from_s - table->times[0]) / table->period_s);
        after = ((long)periods - 1) * (long)table->count;
    }
    while (is_there(table, after) && time_of(table, after) <= from_s) {
        after++;
    }
    return after;
}

static void end_piece(const TimeTable *table, size_t to, TimePiece *piece)
{
    piece->to = to;
    piece->width_s = width_of(table, piece->from, to);
    piece->slope = (table->values[to] - piece->value) / piece->width_s;
}

TimePiece time_table_piece(const TimeTable *table, double time_s)
{
    if (table->count == 0) {
        return (TimePiece){.value = 0.0};
    }
    const long after = point_after(table, time_s);
    const long first = is_there(table, after - 1) ? after - 1 : 0;
    const size_t from = place_of(table, first);
    TimePiece piece = {.time_s = time_of(table, first),
                       .value = table->values[from],
                       .from = from,
                       .to = from,
                       .period = period_of(table, first)};
    if (first < after && is_there(table, after)) {
        end_piece(table, place_of(table, after), &piece);
    }
    return piece;
}

TimePiece time_table_between(const TimeTable *table, size_t from)
{
    TimePiece piece = {.time_s = table->times[from], .value = table->values[from], .from = from};
    end_piece(table, from + 1 < table->count ? from + 1 : 0, &piece);
    return piece;
}

bool time_table_changes(const TimeTable *table)
{
    return table->count > 1 || wave_exists(&table->wave);
}

double time_table_at(const TimeTable *table, double time_s)
{
    if (table->count == 0) {
        return 0.0;
    }
    if (wave_exists(&table->wave)) {
        return table->values[0] + wave_at(&table->wave, time_s);
    }
    const long after = point_after(table, time_s);
    const TimePiece piece = time_table_piece(table, time_s);
    if (!is_there(table, after) || !is_there(table, after - 1)) {
        return piece.value;
    }
    const size_t from = place_of(table, after - 1);
    const size_t to = place_of(table, after);
    const double share = (time_s - piece.time_s) / width_of(table, from, to);
    return piece.value + share * (table->values[to] - piece.value);
}

double time_table_next_bend(const TimeTable *table, double time_s)
{
    if (table->period_s > 0.0 && table->count > 0) {
        return time_of(table, point_after(table, time_s));
    }
    for (size_t i = 0; i < table->count; i++) {
        if (table->times[i] > time_s) {
            return table->times[i];
        }
    }
    return INFINITY;
}

double time_table_mean(const TimeTable *table, double from_s, double to_s)
{
    if (wave_exists(&table->wave)) {
        return table->values[0] + wave_mean(&table->wave, from_s, to_s);
    }
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

// From time zero to a time in the first period.
static long double integral_to(const TimeTable *table, long double time_s)
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

long double time_table_integral(const TimeTable *table, long double time_s)
{
    const long double period_s = table->period_s;
    if (wave_exists(&table->wave)) {
        const Wave *wave = &table->wave;
        const long double half = 0.5L * wave->rate * time_s;
        return time_s * table->values[0] +
               2.0L * wave->amplitude / wave->rate * sinl(wave->phase + half) * sinl(half);
    }
    if (!(period_s > 0.0L && time_s > period_s)) {
        return integral_to(table, time_s);
    }
    const long double periods = floorl(time_s / period_s);
    return periods * integral_to(table, period_s) + integral_to(table, time_s - periods * period_s);
}

double time_table_largest(const TimeTable *table)
{
    double largest = 0.0;
    for (size_t i = 0; i < table->count; i++) {
        largest = fabs(table->values[i]) > fabs(largest) ? table->values[i] : largest;
    }
    return wave_exists(&table->wave) ? largest + copysign(table->wave.amplitude, largest) : largest;
}
