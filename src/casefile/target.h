// One value of a case: its key, what stands there, and what the key takes.
#pragma once

#include "casefile/entries.h"
#include "casefile/quantity.h"

// One value of a case on its way into a scenario.
typedef struct Target {
    const Entries *entries;
    const Entry *entry;
    char path[SCHEMA_PATH_SIZE]; // of the key, for messages
    void *field;
    Err *err;
} Target;

// A number as it is written, in SI; of a diameter the diameter.
typedef struct TargetNumber {
    double value;
    double exponent;  // of SCHEMA_STIFFNESS
    bool is_in_turns; // of SCHEMA_SPAN
} TargetNumber;

// Reads the number of a row whose value is one, whatever its range. On failure the complaint says
// why.
bool target_read(const SchemaRow *row, const char *text, TargetNumber *number,
                 Complaint *complaint);

// Appends what a row takes, for messages: its choices, the names of the case, or an example.
void target_describe(const Entries *entries, const SchemaRow *row, Text *text);

// Refuses a node with what its row takes.
bool target_refuse(const Target *target, Span span, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// Whether a node is one value; a missing one is shown at its key.
bool target_check_scalar(const Target *target, const Node *node);

// One number, from its node or from one of a pair, in the range of its row.
bool target_number(const Target *target, const Node *node, TargetNumber *number);

// One quantity of a dimension of its own, whatever its range.
bool target_quantity(const Target *target, const Node *node, Dimension dimension, double *number);

// The two items of a list of two; false for anything else.
bool target_pair(const Node *node, const Node *pair[2]);
