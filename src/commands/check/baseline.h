// What the numbers of a case were, how far each may move, and why that far.
#pragma once

#include "commands/check/check_measure.h"
#include "measure/rank_test.h"
#include "write/settings_json.h"

enum {
    BASELINE_WHY_SIZE = 128,
    BASELINE_KEY_SIZE = 160,
    BASELINE_VALUE_SIZE = 320,
    BASELINE_TEXT_SIZE = 64,
    BASELINE_MEMBERS = 16,    // starts whose spread makes a band of rounding
    BASELINE_SAMPLE_SIZE = 32 // starts whose numbers make a distribution
};

// Differences of speeds, as shares of the scale of speeds, between the starts of the two ensembles:
// of the first what rounding amounts to, and somewhat more; of the second so much more that
// rounding does not show beside it, and so little that everything before the horizon stays as it
// is.
extern const double BASELINE_ROUNDING_SHARE;
extern const double BASELINE_SAMPLE_SHARE;

// Why a number may move.
typedef enum BandKind {
    BAND_EXACT,       // it may not
    BAND_ROUNDING,    // other compilers and machines round otherwise
    BAND_STATISTICAL, // it cannot be predicted: its distribution is held against another sample
    BAND_KIND_COUNT,
} BandKind;

extern const char *const BASELINE_BAND_WORDS[BAND_KIND_COUNT];

typedef struct BaselineMetric {
    char name[CHECK_NAME_SIZE];
    CheckKind kind;
    bool is_slow;
    BandKind band_kind;
    uint64_t hash; // of CHECK_HASH
    double value;  // of BAND_STATISTICAL the median of the sample
    double band;   // largest |difference| allowed; of BAND_STATISTICAL the smallest shift of the
                   // whole sample that the test tells
    double mean;   // of BAND_STATISTICAL
    size_t sample_count;
    double sample[BASELINE_SAMPLE_SIZE]; // likewise, ascending
    char why[BASELINE_WHY_SIZE];         // the reason of the band, in words
} BaselineMetric;

// A resolved setting of the case: its key and its value with the unit.
typedef struct BaselineSetting {
    char key[BASELINE_KEY_SIZE];
    char value[BASELINE_VALUE_SIZE];
} BaselineSetting;

// The settled start that the numbers are of: neither compiler nor processor make another of it.
typedef struct BaselineStart {
    size_t revolutions; // that it took; 0: there is none
    size_t period;      // of the motion; 0: it does not repeat
    size_t count;
    double *numbers; // of model/start.h; owned
} BaselineStart;

typedef struct Baseline {
    char case_path[SCENARIO_PATH_SIZE]; // relative to the baseline's folder
    char version[BASELINE_TEXT_SIZE];   // of the program, as the three below of its libraries
    char ode[BASELINE_TEXT_SIZE];
    char ccd[BASELINE_TEXT_SIZE];
    char compiler[BASELINE_TEXT_SIZE];
    char build[BUILD_PRINT_SIZE]; // fingerprint of the program
    CheckPlan plan;
    size_t setting_count;
    BaselineSetting *settings; // owned
    BaselineStart start;
    size_t count;
    BaselineMetric *metrics; // owned
} Baseline;

void baseline_finish(Baseline *baseline);

// Fills versions, compiler, fingerprint and settings for this program and a scenario that is not
// settled yet: settings are what the case says.
void baseline_begin(Baseline *baseline, const Scenario *scenario);

// Takes those over from another baseline.
void baseline_set_head(Baseline *baseline, const Baseline *head, const CheckPlan *plan);

// Keeps the settled start of a scenario that has one.
void baseline_set_start(Baseline *baseline, const Scenario *scenario);

// Gives a scenario that is to settle the start that is kept, if it is one of the same case: all
// settings but those of run. and ode. are the same. Returns whether it has one now.
bool baseline_start_scenario(const Baseline *baseline, const Baseline *now, Scenario *scenario);

// The start of a member of the ensemble of rounding, from 1; and of the sample, from 1 on: a check
// takes its own from behind those of the baseline.
CheckStart baseline_rounding_start(unsigned member);
CheckStart baseline_sample_start(unsigned member);

// Makes the metrics from the unperturbed run and those of the ensemble of rounding, which are
// brought into its order. Fails with ERR_SOLVER where a member lacks one of them.
bool baseline_set_metrics(Baseline *baseline, const CheckMeasure *run, CheckMeasure *members,
                          size_t member_count, Err *err);

// Makes measured values equal to those of a metric's sample from which only the rounding of the
// baseline tells them apart: of a number that nearly all starts share, the rounding would put all
// of one sample on one side of the other's.
void baseline_snap(const BaselineMetric *metric, double *values, size_t count);

// Puts the sample's values into the metrics that are statistical. `rate` is the false-alarm rate of
// one test that the band is for.
bool baseline_set_sample(Baseline *baseline, const CheckMeasure *members, size_t member_count,
                         double rate, Err *err);

// The number of a metric in a measure, or its count. It is looked for at a number first, where it
// is as long as nothing was added or left out.
size_t baseline_find(const CheckMeasure *measure, const char *name, size_t near);

// Baselines as files: one metric a line, so that a change shows in a diff.

// Reads a baseline; the caller finishes it. Fails with ERR_FILE where the file is missing, of
// another format, or damaged - no JSON, a key missing, unknown or doubled, a number that is none or
// not finite, a negative band, a sample that is not that of its median and mean - and says which.
// The baseline is then zeroed.
bool baseline_json_read(const char *path, Baseline *baseline, Err *err);

// Writes it, whole or not at all. ERR_FILE.
bool baseline_json_write(const char *path, const Baseline *baseline, Err *err);
