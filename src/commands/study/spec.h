// A study file: which case, which of its keys vary and how, within which limits.
//
// What varies over lists and ranges makes a grid, every combination of which is run. Each draw is
// run at every point of the grid: the same draws at each, so that points differ only in their own
// values.
#pragma once

#include "casefile/casefile.h"
#include "casefile/keys.h"
#include "casefile/probe.h"
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
    const Unit *given;                    // that its first value is written with; NULL: none
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

// In which order a study follows the settled motion from value to value of a key, and the variable
// that says so where it does both.
typedef enum FollowDirection { FOLLOW_FORWARD, FOLLOW_BACKWARD, FOLLOW_BOTH } FollowDirection;
static const char SPEC_DIRECTION_KEY[] = "direction";

// How each run of a study finds its settled motion.
typedef enum SpecSettle {
    SETTLE_NEIGHBOURS, // most from a neighbour's, commands/study/neighbours.h
    SETTLE_EACH,       // by itself
} SpecSettle;

typedef enum DrawMethod { DRAW_RANDOM, DRAW_LATIN_HYPERCUBE, DRAW_SOBOL } DrawMethod;

typedef struct Spec {
    char *path; // owned, of the study file
    char title[SPEC_TEXT_SIZE];
    char *case_path; // owned: relative to the working folder, or absolute
    char *case_text; // owned: its text when the study was read
    size_t case_size;
    CasefileRepeat *repeat; // owned: it as runs have it, under its name without the folder
    size_t set_count;
    char *set[SPEC_SETTING_MAX]; // owned: KEY=VALUE for every run
    Scenario *base;              // owned: the case with what is set, and with play in the joints
                                 // that have it in the runs: for names, its values are no run's
    size_t variable_count;
    Variable variables[SPEC_VARIABLE_MAX]; // from slow to fast: the grid of what changes the truth,
                                           // what is drawn, the grid of what does not change it
    uint64_t draws; // each of which is run at every point of the grid; 1 where nothing is drawn
    DrawMethod method;
    uint64_t draw_base; // of DRAW_SOBOL: of so many draws each two samples, and one more for each
                        // of the k keys that are drawn; all k + 2 of them are `draws`
    uint64_t seed;
    char follow[CASEFILE_KEY_SIZE]; // the key along which runs start in the motion of the one
                                    // before; empty: each finds its own
    FollowDirection direction;
    SpecSettle settle;
    bool has_neighbours;        // runs are settled that way
    BackendKind backend;        // that makes the runs of no scheme: the reference, or ODE
    bool is_quick;              // it is the reference, and nobody asks for its last digits
    bool has_truth;             // each run is held against the certified reference
    bool has_growth;            // each row says how small changes of its settled motion grow
    const char *const *drivers; // of --driver, by which other engines are run; not owned
    size_t driver_count;
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

// The variable of a key, or NULL.
const Variable *spec_variable(const Spec *spec, const char *key);

// What the parts of reading a study file share.

typedef struct Reading {
    Source source; // the study file
    Probe *probe;  // its case, with every key that the study sets, varies or draws in its place
    Spec *spec;
    const Node *vary;   // NULL where nothing does
    ProbeKey key;       // that is being read, of the case
    Variable *variable; // of that key
    Err *err;
} Reading;

// The mappings of a study file whose keys are those of a table.
typedef enum SpecGroup {
    SPEC_TOP,
    SPEC_LIMITS,
    SPEC_DRAW,
    SPEC_FOLLOW,
    SPEC_RANGE, // from here on of one variable
    SPEC_DISTRIBUTION,
    SPEC_NORMAL,
    SPEC_TRIANGULAR,
    SPEC_GROUP_COUNT,
} SpecGroup;

typedef enum SpecKeyType {
    SPEC_KEY_LINE,       // text on one line -> char[SPEC_TEXT_SIZE]
    SPEC_KEY_FLAG,       // true or false -> bool
    SPEC_KEY_WHOLE,      // whole number -> uint64_t
    SPEC_KEY_CHOICE,     // one of the words -> enumeration, from the number in `low` on
    SPEC_KEY_LIMIT,      // quantity, or none for 0 -> double, or size_t for an amount of memory
    SPEC_KEY_VALUE,      // number that the variable's key takes -> double
    SPEC_KEY_DIFFERENCE, // the same, outside of the key's range as well
    SPEC_KEY_MAP,        // mapping of a group
    SPEC_KEY_PART,       // by a function
} SpecKeyType;

typedef struct SpecKey {
    SpecGroup group;
    const char *name;
    SpecKeyType type;
    bool is_required;
    size_t offset; // in the Spec, or in the Variable
    double low, high;
    Dimension dimension;
    const char *const *words; // of a choice, ends in NULL
    SpecGroup of;             // of SPEC_KEY_MAP
    bool (*read)(Reading *reading, const Node *value);
    const char *what;  // in messages
    const char *value; // how it is written, where the type does not say it
    const char *doc;
} SpecKey;

typedef struct SpecGroupRow {
    const char *path;
    const char *example; // in the message about a missing key
} SpecGroupRow;

// The keys of a study file and the table of them.
extern const SpecKey SPEC_KEYS[];
extern const size_t SPEC_KEY_COUNT;
extern const SpecGroupRow SPEC_GROUPS[SPEC_GROUP_COUNT];

// Reads a mapping by the rows of its group into the spec, or into the variable.
bool spec_keys_read(Reading *reading, SpecGroup group, const Node *map);

// What a study has that says nothing of its limits, draws and truth.
Spec spec_default(void);

// The parts of a study that have no rows of their own. A value is that of the key
// `case`, `set`, ...
bool spec_read_case(Reading *reading, const Node *value);
bool spec_read_set(Reading *reading, const Node *value);

// What varies.
bool spec_read_vary(Reading *reading, const Node *value);

// Along which key runs follow one another.
bool spec_read_follow(Reading *reading, const Node *value);
bool spec_read_follow_key(Reading *reading, const Node *value);

// What is drawn, and the distributions of one key.
bool spec_read_draws(Reading *reading, const Node *value);
bool spec_read_uniform(Reading *reading, const Node *value);
bool spec_read_log_uniform(Reading *reading, const Node *value);
bool spec_read_normal(Reading *reading, const Node *value);
bool spec_read_triangular(Reading *reading, const Node *value);

// What makes the runs where no scheme does: the reference where neither the case nor the study,
// which are read, speaks of ODE, and whether each is compared with a truth where the file does not
// say.
void spec_decide_backend(bool is_truth_said, Spec *spec);

// A number that the variable's key takes: of its unit and, where `is_checked`, in its range.
bool spec_read_number(Reading *reading, const Node *node, bool is_checked, double *number);

// Whether a node is a single value that is there.
bool spec_read_single(const Reading *reading, const Node *node, const char *what,
                      const char *allowed);

// Refuses a node with what is wrong and what would be allowed. False always.
bool spec_read_refuse(const Reading *reading, const Node *node, const char *allowed,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));
