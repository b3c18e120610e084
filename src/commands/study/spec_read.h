// What the parts of reading a study file share.
#pragma once

#include "casefile/keys.h"
#include "casefile/probe.h"
#include "commands/study/spec.h"

typedef struct Reading {
    Source source; // the study file
    Probe *probe;  // its case, with every key that the study sets, varies or draws in its place
    Spec *spec;
    Err *err;
} Reading;

// Reads the keys under `vary`, and those under `draw` with what else stands there.
bool spec_read_vary(Reading *reading, const Node *vary);
bool spec_read_draw(Reading *reading, const Node *draw);

// Whether the schemes under `vary`, which may be NULL, are there and have what they need.
bool spec_read_check_schemes(const Reading *reading, const Node *vary);

// A new variable of the spec, for the key of a value; NULL where the key is none of the case, the
// spec has no room, or the study names the key a second time.
Variable *spec_read_variable(Reading *reading, const Node *value, ProbeKey *key);

// A number that the variable's key takes: of its unit and, where `is_checked`, in its range.
bool spec_read_number(const Reading *reading, const ProbeKey *key, const Node *node,
                      bool is_checked, Variable *variable, double *number);

// Whether a node is a single value that is there.
bool spec_read_single(const Reading *reading, const Node *node, const char *what,
                      const char *allowed);

// A whole number within limits, and one of some words, which end in NULL. `what` it is for stands
// in messages.
bool spec_read_whole(const Reading *reading, const Node *node, const char *what, double low,
                     double high, uint64_t *number);
bool spec_read_word(const Reading *reading, const Node *node, const char *what,
                    const char *const *words, size_t *number);

// Whether the values that a mapping must have are all there; else the first one is missing.
bool spec_read_has_all(const Reading *reading, const Node *map, const char *const *names,
                       const Node *const *values, size_t count, const char *allowed);

// Refuses a node with what is wrong and what would be allowed. False always.
bool spec_read_refuse(const Reading *reading, const Node *node, const char *allowed,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));

// Appends a node as YAML on one line.
void spec_read_write(const Node *node, Text *text);
