// The columns and rows of a series.
#pragma once

#include "base/lookup.h"
#include "model/distance.h"
#include "model/trajectory.h"

typedef struct SeriesColumn SeriesColumn;

// What a column is of.
typedef enum SeriesOf {
    SERIES_OF_RUN,
    SERIES_OF_BODY,
    SERIES_OF_JOINT,
    SERIES_OF_POINT,
    SERIES_OF_RATE,
} SeriesOf;

// What a column has, for those who pick some by more than their names.
typedef struct SeriesName {
    const char *name; // as in the head
    SeriesOf of;
    size_t number;    // of the body, joint or point
    const char *what; // "omega_rad_s", "gap": without the body's or joint's name, and without the
                      // unit where it depends on the joint
} SeriesName;

// The columns of a scenario's series, in their order.
typedef struct SeriesColumns {
    const Scenario *scenario; // which must live as long
    DistanceMeasure rates;    // owned
    size_t count;
    size_t room;
    SeriesColumn *columns; // owned
    Lookup names;          // owned; of all columns, those that were not chosen too
} SeriesColumns;

// All columns, with those of the smallest and largest values between samples where they are kept;
// for series_columns_finish.
SeriesColumns series_columns_create(const Scenario *scenario, bool has_ranges);
void series_columns_finish(SeriesColumns *columns);

// Keeps the time and the columns whose names match one of the patterns, which commas separate: a
// name in which * stands for any letters, and ? for one.
void series_columns_choose(SeriesColumns *columns, const char *patterns);

// Fails with ERR_USAGE where a pattern matches no column, and says which name might be
// meant.
bool series_columns_check(const SeriesColumns *columns, const char *patterns, Err *err);

// A column by its number, and its value at a sample of a complete trajectory.
SeriesName series_columns_name(const SeriesColumns *columns, size_t number);
double series_columns_value(const SeriesColumns *columns, const Trajectory *trajectory,
                            size_t sample, size_t number);

// Writes the series with a row a sample, whole or not at all (write/row_file.h, where the file is
// claimed before). The trajectory is complete. Fails as row_file_end does.
bool series_columns_write(const SeriesColumns *columns, const Trajectory *trajectory,
                          const char *path, Err *err);
