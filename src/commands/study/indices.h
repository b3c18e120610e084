// What part of the variance of a result each input is for: Sobol's indices.
#pragma once

#include "commands/study/study.h"

enum { INDICES_INPUTS_MOST = 64 };

// A number with its 95 % interval.
typedef struct IndexEstimate {
    double value;
    double low;
    double high;
} IndexEstimate;

// Of one result.
typedef struct Indices {
    uint64_t used; // draws all of whose runs have the result
    double variance;
    IndexEstimate
        first[INDICES_INPUTS_MOST]; // 1: the part that goes where the input alone is known
    IndexEstimate total[INDICES_INPUTS_MOST]; // 1: the part that stays where all others are
} Indices;

// Finds the indices from the results of base (inputs + 2) runs in the order of DRAW_SOBOL, NAN
// where a run has none. Returns false where fewer than 8 draws are whole, or the result does not
// vary.
bool indices_find(const double *results, uint64_t base, size_t inputs, Indices *indices);

// Appends a table of the main results of a study by DRAW_SOBOL, nothing of others; or sets
// "indices" of a JSON object. Fail with ERR_FILE.
bool indices_text(const Spec *spec, Store *store, const Style *style, Text *text, Err *err);
bool indices_json(const Spec *spec, Store *store, json_t *object, Err *err);
