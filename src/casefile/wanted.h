// What a key takes, for messages about one that is missing or wrong.
#pragma once

#include "casefile/entries.h"

// Appends what the row takes, in words: its choices, the names of the case, or an example.
void wanted_describe(const Entries *entries, const SchemaRow *row, Text *text);
