// Finds Sobol's indices of the results of a study.
//
// With the samples A and B of all inputs, and A_i with input i of B and the others of A, over draws
// j
//     first  S_i = (1/n) sum f(B_j) (f(A_i,j) - f(A_j)) / V
//     total  T_i = (1/2n) sum (f(A_j) - f(A_i,j))^2 / V
// V the variance over A and B. Intervals are from resampling the draws.
//
// Sources: Saltelli et al., Comput. Phys. Commun. 181 (2010) 259, table 2 (b) and (f), the latter
// after Jansen (1999); Efron's percentile bootstrap.
#include "commands/study/indices.h"

#include "base/lcg.h"
#include "base/sorted.h"
#include "base/zeroed.h"
#include "commands/study/metrics.h"
#include "write/json_value.h"
#include "write/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RESAMPLES = 400, DRAWS_LEAST = 8, SHOWN = 5 };

// Results as they stand: value of draw j in sample k at [k base + j].
typedef struct Samples {
    const double *results;
    uint64_t base;
    size_t inputs;
    const uint64_t *whole; // draws whose runs all have the result
    uint64_t count;
} Samples;

static double value_of(const Samples *samples, size_t sample, uint64_t draw)
{
    return samples->results[sample * samples->base + draw];
}

// Mean and variance over the draws that are picked, in both samples.
static double variance_of(const Samples *samples, const uint64_t *picked, double *mean)
{
    double sum = 0.0;
    for (uint64_t i = 0; i < samples->count; i++) {
        const uint64_t draw = samples->whole[picked[i]];
        sum += value_of(samples, 0, draw) + value_of(samples, 1, draw);
    }
    *mean = sum / (2.0 * (double)samples->count);
    double squares = 0.0;
    for (uint64_t i = 0; i < samples->count; i++) {
        const uint64_t draw = samples->whole[picked[i]];
        for (size_t sample = 0; sample < 2; sample++) {
            const double off = value_of(samples, sample, draw) - *mean;
            squares += off * off;
        }
    }
    return squares / (2.0 * (double)samples->count - 1.0);
}

// Writes the first and the total index of each input over the draws that are picked.
static double estimate(const Samples *samples, const uint64_t *picked, double *first, double *total)
{
    double mean;
    const double variance = variance_of(samples, picked, &mean);
    for (size_t k = 0; k < samples->inputs; k++) {
        double product = 0.0;
        double squares = 0.0;
        for (uint64_t i = 0; i < samples->count; i++) {
            const uint64_t draw = samples->whole[picked[i]];
            const double moved = value_of(samples, k + 2, draw) - value_of(samples, 0, draw);
            // less the mean, which leaves the sum what it is and its error smaller
            product += (value_of(samples, 1, draw) - mean) * moved;
            squares += moved * moved;
        }
        first[k] = product / ((double)samples->count * variance);
        total[k] = squares / (2.0 * (double)samples->count * variance);
    }
    return variance;
}

// The middle 95 % of resamples, which are put in order.
static IndexEstimate interval(double value, double *resampled)
{
    sorted_make(resampled, RESAMPLES);
    return (IndexEstimate){value, sorted_quantile(resampled, RESAMPLES, 0.025),
                           sorted_quantile(resampled, RESAMPLES, 0.975)};
}

static void resample(const Samples *samples, uint64_t *picked, double *firsts, double *totals)
{
    uint64_t seed = lcg_stirred(1);
    double first[INDICES_INPUTS_MOST];
    double total[INDICES_INPUTS_MOST];
    for (size_t i = 0; i < RESAMPLES; i++) {
        for (uint64_t k = 0; k < samples->count; k++) {
            const double share = 0.5 * (1.0 + lcg_draw(&seed));
            picked[k] = (uint64_t)(share * (double)samples->count);
        }
        estimate(samples, picked, first, total);
        for (size_t k = 0; k < samples->inputs; k++) {
            firsts[k * RESAMPLES + i] = first[k];
            totals[k * RESAMPLES + i] = total[k];
        }
    }
}

// The draws all of whose runs have the result.
static uint64_t find_whole(const double *results, uint64_t base, size_t inputs, uint64_t *whole)
{
    uint64_t count = 0;
    for (uint64_t draw = 0; draw < base; draw++) {
        bool is_whole = true;
        for (size_t sample = 0; sample < inputs + 2; sample++) {
            is_whole = is_whole && isfinite(results[sample * base + draw]);
        }
        whole[count] = draw;
        count += is_whole ? 1 : 0;
    }
    return count;
}

bool indices_find(const double *results, uint64_t base, size_t inputs, Indices *indices)
{
    *indices = (Indices){.used = 0};
    uint64_t *whole = zeroed(base + 1, sizeof *whole);
    uint64_t *picked = zeroed(base + 1, sizeof *picked);
    double *firsts = zeroed(2 * inputs * RESAMPLES, sizeof *firsts);
    double *totals = firsts + inputs * RESAMPLES;
    Samples samples = {results, base, inputs, whole, find_whole(results, base, inputs, whole)};
    bool is_found = samples.count >= DRAWS_LEAST && inputs <= INDICES_INPUTS_MOST;
    if (is_found) {
        double first[INDICES_INPUTS_MOST];
        double total[INDICES_INPUTS_MOST];
        for (uint64_t i = 0; i < samples.count; i++) {
            picked[i] = i;
        }
        indices->used = samples.count;
        indices->variance = estimate(&samples, picked, first, total);
        is_found = indices->variance > 0.0;
        resample(&samples, picked, firsts, totals);
        for (size_t k = 0; is_found && k < inputs; k++) {
            indices->first[k] = interval(first[k], firsts + k * RESAMPLES);
            indices->total[k] = interval(total[k], totals + k * RESAMPLES);
        }
    }
    free(whole);
    free(picked);
    free(firsts);
    return is_found;
}

// The main results of all runs of a study, one after another.
typedef struct Results {
    uint64_t runs;
    size_t count;
    size_t columns[RECORD_RESULT_MAX]; // among the results
    double *values;                    // owned
} Results;

static bool take_results(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)err;
    Results *results = context;
    for (size_t i = 0; i < results->count && record->run < results->runs; i++) {
        RecordField field;
        // behind the run, the settings, the outcome and the reason
        const size_t number = 3 + layout->setting_count + results->columns[i];
        const bool is_there =
            record->outcome == RUN_OUTCOME_OK && record_field(layout, number, &field);
        results->values[i * results->runs + record->run] =
            is_there ? record_number(record, &field) : NAN;
    }
    return true;
}

static bool read_results(const Spec *spec, Store *store, Results *results, Err *err)
{
    const Layout *layout = store_layout(store);
    *results = (Results){.runs = spec->draws};
    for (size_t i = 0; i < layout->result_count; i++) {
        if (metrics_is_main(layout->results[i].name)) {
            results->columns[results->count++] = i;
        }
    }
    const size_t size = results->count * (size_t)results->runs;
    results->values = zeroed(size, sizeof *results->values);
    for (size_t i = 0; i < size; i++) {
        results->values[i] = NAN;
    }
    return store_each(store, take_results, results, err);
}

static size_t drawn_keys(const Spec *spec, const char *keys[INDICES_INPUTS_MOST])
{
    size_t count = 0;
    for (size_t i = 0; i < spec->variable_count && count < INDICES_INPUTS_MOST; i++) {
        if (spec->variables[i].is_drawn) {
            keys[count++] = spec->variables[i].key;
        }
    }
    return count;
}

static void write_estimate(Table *table, const IndexEstimate *estimate)
{
    table_cell(table, "%.2f", estimate->value);
    table_cell(table, "%.2f to %.2f", estimate->low, estimate->high);
}

// The inputs of a result, those with the largest total index first.
static void write_rows(Table *table, const char *result, const char *const *keys, size_t inputs,
                       const Indices *indices)
{
    bool is_shown[INDICES_INPUTS_MOST] = {false};
    for (size_t row = 0; row < inputs && row < SHOWN; row++) {
        size_t largest = inputs;
        for (size_t k = 0; k < inputs; k++) {
            if (!is_shown[k] &&
                (largest == inputs || indices->total[k].value > indices->total[largest].value)) {
                largest = k;
            }
        }
        is_shown[largest] = true;
        table_cell(table, "%s", row == 0 ? result : "");
        table_cell(table, "%s", keys[largest]);
        write_estimate(table, &indices->first[largest]);
        write_estimate(table, &indices->total[largest]);
    }
}

// What is done with the indices of a result.
typedef void (*IndicesTaker)(const char *result, const char *const *keys, size_t inputs,
                             const Indices *indices, void *context);

// Passes on the indices of each main result that has them.
static bool each_result(const Spec *spec, Store *store, IndicesTaker take, void *context, Err *err)
{
    const char *keys[INDICES_INPUTS_MOST];
    const size_t inputs = drawn_keys(spec, keys);
    Results results;
    const bool is_read = read_results(spec, store, &results, err);
    for (size_t i = 0; is_read && i < results.count; i++) {
        Indices indices;
        if (indices_find(results.values + i * results.runs, spec->draw_base, inputs, &indices)) {
            take(store_layout(store)->results[results.columns[i]].name, keys, inputs, &indices,
                 context);
        }
    }
    free(results.values);
    return is_read;
}

// The table, and how many draws tell its rows, at most.
typedef struct IndicesTable {
    Table *table;
    uint64_t used;
} IndicesTable;

static void take_rows(const char *result, const char *const *keys, size_t inputs,
                      const Indices *indices, void *context)
{
    IndicesTable *rows = context;
    write_rows(rows->table, result, keys, inputs, indices);
    rows->used = indices->used > rows->used ? indices->used : rows->used;
}

bool indices_text(const Spec *spec, Store *store, const Style *style, Text *text, Err *err)
{
    static const SectionHead HEADS[] = {
        {"result", "", TABLE_LEFT},  {"input", "", TABLE_LEFT},
        {"alone", "", TABLE_RIGHT},  {"of 95 %", "", TABLE_RIGHT | TABLE_MINOR},
        {"in all", "", TABLE_RIGHT}, {"of 95 %", "", TABLE_RIGHT | TABLE_MINOR}};
    if (spec->method != DRAW_SOBOL) {
        return true;
    }
    IndicesTable rows = {
        section_begin("What part of a result's variance each input is for", 6, HEADS, style, text),
        0};
    const bool is_read = each_result(spec, store, take_rows, &rows, err);
    section_end(rows.table, text);
    text_append(
        text,
        "  Of %llu draws. Alone: of the input by itself (first index); in all: with what it\n"
        "  does together with others (total index); 95 %% intervals by resampling: --wide.\n",
        (unsigned long long)rows.used);
    return is_read;
}

static json_t *estimate_json(const IndexEstimate *estimate)
{
    return json_pack("[o, o, o]", json_value_real(estimate->value), json_value_real(estimate->low),
                     json_value_real(estimate->high));
}

static void take_json(const char *result, const char *const *keys, size_t inputs,
                      const Indices *indices, void *context)
{
    json_t *of = json_object();
    for (size_t k = 0; k < inputs; k++) {
        json_object_set_new(of, keys[k],
                            json_pack("{s:o, s:o}", "first", estimate_json(&indices->first[k]),
                                      "total", estimate_json(&indices->total[k])));
    }
    json_object_set_new(context, result, of);
}

bool indices_json(const Spec *spec, Store *store, json_t *object, Err *err)
{
    if (spec->method != DRAW_SOBOL) {
        return true;
    }
    json_t *all = json_object();
    json_object_set_new(object, "indices", all);
    return each_result(spec, store, take_json, all, err);
}
