// A quantity over time: linear between its points, constant before the first and after the last, or
// the same again in every period, with a line from its last point to the first of the next.
//
// A run may look a little behind time zero. There the piece that holds at and after time zero goes
// on, so that no bend lies in its past.
#pragma once

#include "base/wave.h"

#include <stdbool.h>
#include <stddef.h>

enum { TIME_TABLE_MAX = 32 };

typedef struct TimeTable {
    size_t count;                  // of points; 0: there is no table, and every value is 0
    double times[TIME_TABLE_MAX];  // s, increasing
    double values[TIME_TABLE_MAX]; // in the quantity's unit
    double period_s;               // longer than from the first point to the last; 0: none
    Wave wave;                     // added to the one point that there is then
} TimeTable;

// A piece of a table: value + slope (t - time_s).
typedef struct TimePiece {
    double time_s;
    double value;
    double slope; // of the value, per s
    size_t from;  // the point at which it begins, and the next
    size_t to;
    long period;    // the how manieth period the first is of, from 0
    double width_s; // from one to the other; 0: nothing changes
} TimePiece;

// Whether all numbers are finite, and the times increase and lie within one period.
bool time_table_is_ordered(const TimeTable *table);

double time_table_at(const TimeTable *table, double time_s);

// The piece that holds from a time on: at a bend the one after it; without the wave.
TimePiece time_table_piece(const TimeTable *table, double time_s);

// The piece from a point to the next, in the first period; there must be a next one.
TimePiece time_table_between(const TimeTable *table, size_t from);

// The first time after the one given at which the table bends, s; INFINITY after the last.
double time_table_next_bend(const TimeTable *table, double time_s);

// Whether it changes: by points or by a wave.
bool time_table_changes(const TimeTable *table);

// The mean between two different times, the earlier one first.
double time_table_mean(const TimeTable *table, double from_s, double to_s);

// The integral from time zero to a time, of a table with points.
long double time_table_integral(const TimeTable *table, long double time_s);

// The value of the largest size, with its sign; 0 without points.
double time_table_largest(const TimeTable *table);
