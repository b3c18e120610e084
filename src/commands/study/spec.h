// A study file: which case, which of its keys vary and how, within which limits.
//
// What varies over lists and ranges makes a grid, every combination of which is run. Each draw is
// run at every point of the grid: the same draws at each, so that points differ only in their own
// values.
#pragma once

#include "casefile/casefile.h"
#include "commands/study/record.h"
#include "measure/child.h"
#include "measure/scheme.h"

enum {
    SPEC_VARIABLE_MAX = RECORD_SETTING_MAX,
    SPEC_SETTING_MAX = 64,
    SPEC_VALUE_MAX = 1000, // of one list
    SPEC_TEXT_SIZE = 256,
};

// In place of a key of the case: the way to run it, by the names of measure/scheme.h.
static const char SPEC_SCHEME_KEY[] = "scheme";

typedef enum VariableKind {
    VARIABLE_LIST,        // of numbers or words
    VARIABLE_LINEAR,      // `count` numbers, evenly from first to last
    VARIABLE_LOGARITHMIC, // the same in the logarithm
    VARIABLE_UNIFORM,     // drawn between low and high
    VARIABLE_LOG_UNIFORM, // the same in the logarithm
    VARIABLE_NORMAL,      // drawn with mean and deviation, cut off at low and high
    VARIABLE_TRIANGULAR,  // drawn between low and high, most often at the mode
} VariableKind;

typedef struct Variable {
    char key[CASEFILE_KEY_SIZE];          // of the case file, or `scheme`
    char unit[CASEFILE_UNIT_SIZE];        // SI unit that a number is handed to the case file with
    char column_unit[CASEFILE_UNIT_SIZE]; // SI unit as a column names it: of a plain number, too
    VariableKind kind;
    bool is_drawn;
    bool is_word;
    bool is_whole;
    bool changes_truth; // false for the keys of ODE and of the step: the physics stays the same
    uint64_t count;     // of VARIABLE_LIST, LINEAR and LOGARITHMIC
    double *numbers;    // owned; of a list of numbers, SI
    char (*words)[RECORD_WORD_SIZE]; // owned; of a list of words
    double low;                      // SI: first of a range, lower bound of a draw, or -INFINITY
    double high;                     // SI: last of a range, upper bound of a draw, or INFINITY
    double centre;                   // SI: mean of VARIABLE_NORMAL, mode of VARIABLE_TRIANGULAR
    double deviation;                // SI: of VARIABLE_NORMAL, before it is cut off
} Variable;

typedef enum DrawMethod { DRAW_RANDOM, DRAW_LATIN_HYPERCUBE } DrawMethod;

typedef struct Spec {
    char *path; // owned, of the study file
    char title[SPEC_TEXT_SIZE];
    char *case_path; // owned: relative to the working folder, or absolute
    char *case_text; // owned: its text when the study was read
    size_t case_size;
    size_t set_count;
    char *set[SPEC_SETTING_MAX]; // owned: KEY=VALUE for every run
    Scenario *base;              // owned: the case with what is set, and with play in the joints
                                 // that have it in the runs: for names, its values are no run's
    size_t variable_count;
    Variable variables[SPEC_VARIABLE_MAX]; // from slow to fast: the grid of what changes the truth,
                                           // what is drawn, the grid of what does not change it
    uint64_t draws; // each of which is run at every point of the grid; 1 where nothing is drawn
    DrawMethod method;
    uint64_t seed;
    bool has_truth;     // each run is held against the certified reference
    ChildLimits limits; // of one run; a truth may take the time of several
    uint64_t print;     // fingerprint of all that decides what the runs are: not of the limits,
                        // the title, or how the file is laid out
} Spec;

// Reads a study file and the case it names. Fails with ERR_FILE or ERR_CASE, pointing at the
// place; the spec is then empty. A study that could have no run is an error.
bool spec_read(const char *path, Spec *spec, Err *err);

// Appends what may stand in a study file and which columns its runs have, for people: for a
// terminal, or as a page of the documentation.
void spec_describe(bool is_markdown, Text *text);

// Accepts a zeroed spec.
void spec_finish(Spec *spec);

// The same for a spec of its own; NULL on failure. Closing accepts NULL.
Spec *spec_open(const char *path, Err *err);
void spec_close(Spec *spec);

// What a study does with a key: the variable that it is, or NULL; whether it is set for all runs.
const Variable *spec_variable(const Spec *spec, const char *key);
bool spec_sets(const Spec *spec, const char *key);

// The fingerprint of all that decides what the runs are, which stands in the spec as well.
uint64_t spec_print(const Spec *spec);
