// The paper's numbers: printed, recomputed, and what physics gives.
#pragma once

#include "commands/paper/extremes.h"
#include "commands/paper/physical.h"
#include "commands/paper/typos.h"
#include "measure/estimate.h"

typedef struct PaperResult {
    EstimateInputs inputs;                     // of Tables I to III
    EstimateTable tables[PRINTED_TABLE_COUNT]; // Tables I to III
    int cell_count;                            // of them
    int as_printed;                            // cells that come out as printed
    Physical physical;                         // the counterpart of Tables I to III
    ExtremesRow extremes[PRINTED_ROW_COUNT];   // Tables VII and VIII
    double ideal_difference_max;               // 1, relative, over the ideal rows
    int ideal_cell_count;                      // of the ideal rows
    int ideal_as_printed;                      // cells of them that round to the printed number
} PaperResult;

// Recomputes everything. The watch is told of the two ODE runs, which take nearly all the time.
// Fails where an embedded case cannot be loaded or solved in closed form.
bool paper_compute(PaperResult *result, RunWatch watch, Err *err);

// Fails with ERR_DIFFERS where the result is not the paper's: a cell of Tables I to III that does
// not come out as printed, or an ideal row of Tables VII and VIII more than 0.03 % off.
bool paper_check(const PaperResult *result, Err *err);
