// The paper's numbers: printed, recomputed, and what physics gives.
#pragma once

#include "commands/paper/extremes.h"
#include "commands/paper/physical.h"
#include "measure/estimate.h"
#include "write/fields.h"

// Where in the output a slip is named.
typedef enum TypoPlace {
    TYPO_TABLE_1,
    TYPO_TABLE_2,
    TYPO_TABLE_3,
    TYPO_TABLES_7_8,
    TYPO_MODEL, // of no one table
} TypoPlace;

typedef struct Typo {
    TypoPlace place;
    const char *where;    // in the paper
    const char *printed;  // what stands there
    const char *reading;  // what it is taken for
    const char *evidence; // why, and what follows
} Typo;

extern const Typo TYPOS[];
extern const size_t TYPOS_COUNT;

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

// Recomputes everything. The watch follows the two ODE runs, which take nearly all the time.
// Fails where an embedded case cannot be loaded or solved in closed form.
bool paper_compute(PaperResult *result, RunWatch watch, Err *err);

// Fails with ERR_DIFFERS where the result is not the paper's: a cell of Tables I to III that does
// not come out as printed, or an ideal row of Tables VII and VIII more than 0.03 % off.
bool paper_check(const PaperResult *result, Err *err);

// The fields of PhysicalPin; beside Tables I to III stand those of PAPER_TABLE << 0 to 2.
enum { PAPER_TABLE = FIELD_OWN };
extern const Field PAPER_PIN_FIELDS[];

// What `jointplay paper` prints of a PaperResult: each table with its recomputed numbers, what
// physics gives, and the typos that concern it; or JSON, a new reference, with units in the keys.
void paper_text_write(const void *result, const Style *style, Text *text);
json_t *paper_json_make(const void *result);
