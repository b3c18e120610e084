// The paper's Tables I to III, recomputed cell by cell.
#pragma once

#include "contact/penalty.h"
#include "measure/printed.h"

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
