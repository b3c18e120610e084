// Values of a case into a scenario, in SI.
#pragma once

#include "casefile/entries.h"
#include "casefile/quantity.h"

// Understands the value of one entry and puts it into the scenario. A wrong value is an error with
// its place and what would be allowed.
bool store_value(const Entries *entries, const Entry *entry, Scenario *scenario, Err *err);

// A number as it is written, in SI; of a diameter the diameter.
typedef struct StoredNumber {
    double value;
    ToleratedLength length; // of SCHEMA_TOLERATED
    double exponent;        // of SCHEMA_STIFFNESS
    bool is_in_turns;       // of SCHEMA_SPAN
} StoredNumber;

// Reads the number of a row whose value is one, whatever its range. On failure the complaint says
// why.
bool store_read(const SchemaRow *row, const char *text, StoredNumber *number, Complaint *complaint);

// Appends what a row takes, for messages: its choices, the names of the case, or an example.
void store_describe(const Entries *entries, const SchemaRow *row, Text *text);
