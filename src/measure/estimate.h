// The paper's Tables I to III, recomputed cell by cell.
#pragma once

#include "contact/penalty.h"
#include "model/numbers.h"

#include <stdbool.h>

// What the paper prints: its tables, cell by cell, and the joint it prints them for.

enum {
    PRINTED_SPEED_COUNT = 15, // 100 to 1500 rpm
    PRINTED_PIN_COUNT = 2,
    PRINTED_TABLE_COUNT = 3,    // Tables I to III
    PRINTED_QUANTITY_COUNT = 8, // the columns of Tables VII and VIII, side by side
};

typedef enum PrintedPin { PRINTED_CRANK_COUPLER, PRINTED_COUPLER_FOLLOWER } PrintedPin;

extern const char *const PRINTED_PIN_NAMES[PRINTED_PIN_COUNT]; // as joints of a four-bar

// One of Tables I to III: a row a speed, a column a pin.
typedef struct PrintedTable {
    const char *name;
    const char *title;
    const char *unit;
    int decimals; // behind the point, in every cell
    double cells[PRINTED_SPEED_COUNT][PRINTED_PIN_COUNT];
} PrintedTable;

extern const PrintedTable PRINTED_TABLES[PRINTED_TABLE_COUNT];

// The input speed of a row, rpm.
double printed_speed_rpm(int row);

typedef enum PrintedRow {
    PRINTED_IDEAL_NOMINAL,
    PRINTED_IDEAL_STACKUP,
    PRINTED_POISSON,
    PRINTED_IMPACT,
    PRINTED_IDEAL_ANALYTICAL,
    PRINTED_ROW_COUNT,
} PrintedRow;

// A column of Tables VII and VIII together: a number of a body, and the digits behind the point of
// its cells.
typedef struct PrintedColumn {
    const char *body;
    NumberId number;
    int decimals;
} PrintedColumn;

extern const PrintedColumn PRINTED_COLUMNS[PRINTED_QUANTITY_COUNT];

enum { PRINTED_WORDS_SIZE = 64 };

// The key of a column, "coupler_omega_max_rad_s", and its heading, "coupler omega max".
void printed_column_key(size_t column, char key[PRINTED_WORDS_SIZE]);
void printed_column_title(size_t column, char title[PRINTED_WORDS_SIZE]);

// A row of them, SI.
typedef struct PrintedExtremes {
    const char *name;
    double values[PRINTED_QUANTITY_COUNT];
} PrintedExtremes;

extern const PrintedExtremes PRINTED_EXTREMES[PRINTED_ROW_COUNT];

// Whether a value rounded to so many decimals is the number printed.
bool printed_agrees(double value, double printed, int decimals);

// The clearance joint: Table IV (largest hole, smallest pin; diameters) and Table VI.
extern const double PRINTED_HOLE_DIAMETER; // m
extern const double PRINTED_PIN_DIAMETER;  // m
extern const double PRINTED_PIN_WIDTH;     // m

typedef struct EstimateCell {
    double printed; // in the table's unit, like the next two
    double value;   // from the formula
    double rounded; // to the table's decimals
    bool is_as_printed;
} EstimateCell;

typedef struct EstimateTable {
    EstimateCell cells[PRINTED_SPEED_COUNT][PRINTED_PIN_COUNT];
    int cell_count;
    int as_printed;        // cells that come out as printed
    double difference_max; // largest |rounded - printed|, in the table's unit
} EstimateTable;

// What goes into the tables: the reading, the largest |alpha| at each pin at 1000 rpm, rad/s^2,
// and the effective modulus, Pa.
typedef struct EstimateInputs {
    PenaltyReading reading;
    double alpha_max[PRINTED_PIN_COUNT];
    double effective_modulus;
} EstimateInputs;

// The inputs that stand in the paper: its own alphas (Table VIII) and its steel (Table V).
EstimateInputs estimate_inputs_printed(void);

void estimate_compute(const EstimateInputs *inputs, EstimateTable tables[PRINTED_TABLE_COUNT]);
