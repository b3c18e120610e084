// What the parts of reading a study file share.
#pragma once

#include "casefile/keys.h"
#include "casefile/probe.h"
#include "commands/study/spec.h"

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

// spec_table.c
extern const SpecKey SPEC_KEYS[];
extern const size_t SPEC_KEY_COUNT;
extern const SpecGroupRow SPEC_GROUPS[SPEC_GROUP_COUNT];

// Appends what a key takes, in words.
void spec_key_allowed(const SpecKey *key, Text *text);

// spec_keys.c: reads a mapping by the rows of its group into the spec, or into the variable.
bool spec_keys_read(Reading *reading, SpecGroup group, const Node *map);

// What a study has that says nothing of its limits, draws and truth.
Spec spec_default(void);

// spec_read.c: the parts of a study that have no rows of their own. A value is that of the key
// `case`, `set`, ...
bool spec_read_case(Reading *reading, const Node *value);
bool spec_read_set(Reading *reading, const Node *value);

// Reads the values of a mapping one after another; each key must stand there once.
bool spec_read_each(Reading *reading, const Node *map,
                    bool (*read)(Reading *reading, const Node *value));

// Begins a new variable of the spec, for the key of a value. False where the key is none of the
// case, the spec has no room, or the study names the key a second time.
bool spec_read_variable(Reading *reading, const Node *value);

// spec_read_vary.c
bool spec_read_vary(Reading *reading, const Node *value);

// spec_read_draw.c: what is drawn, and the distributions of one key.
bool spec_read_draws(Reading *reading, const Node *value);
bool spec_read_uniform(Reading *reading, const Node *value);
bool spec_read_log_uniform(Reading *reading, const Node *value);
bool spec_read_normal(Reading *reading, const Node *value);
bool spec_read_triangular(Reading *reading, const Node *value);

// spec_read_scheme.c: whether the schemes under `vary` are there and have what they need.
bool spec_read_check_schemes(const Reading *reading);

// spec_read_value.c

// A number that the variable's key takes: of its unit and, where `is_checked`, in its range.
bool spec_read_number(Reading *reading, const Node *node, bool is_checked, double *number);

// Whether a node is a single value that is there.
bool spec_read_single(const Reading *reading, const Node *node, const char *what,
                      const char *allowed);

// Refuses a node with what is wrong and what would be allowed. False always.
bool spec_read_refuse(const Reading *reading, const Node *node, const char *allowed,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));

// The value of a key in a mapping; NULL where it is not there.
const Node *spec_read_child(const Node *map, const char *name);

// The values of a list, or a single value, which is a list of one: the first, and the one behind an
// item; NULL behind the last.
const Node *spec_read_first(const Node *list);
const Node *spec_read_next(const Node *list, const Node *item);

// Appends a node as YAML on one line.
void spec_read_write(const Node *node, Text *text);
