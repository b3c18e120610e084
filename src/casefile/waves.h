// A sinusoid as a case writes it: {mean: 1 N, amplitude: 3 N, frequency: 50 Hz, phase: 30 deg}.
#pragma once

#include "base/wave.h"
#include "casefile/entries.h"

// Whether an entry, resolved, is one.
bool waves_is_one(const Entry *entry);

// What a sinusoid has for its mean and its swing, in SI.
typedef struct WaveRead {
    bool has_mean;
    double mean; // 0 where there is none
    Wave wave;
} WaveRead;

// Reads an entry that is one: with what overrides its parts, in the dimension that its values have.
// What it reaches at most lies within the range of the row, once it is multiplied by the scale.
bool waves_read(const Entries *entries, const Entry *entry, Dimension dimension, double scale,
                WaveRead *read, Err *err);

// The node of a part of a value, with what overrides it; NULL where it is not given. The entry is
// the value's own, which may be the name of a signal.
const Node *waves_part(const Entries *entries, const Entry *own, EntryPart part);

// The dimension of a part, or of the whole: of mean and amplitude that of the value, which of a
// signal is that of a key that uses it.
Dimension waves_dimension(const Entries *entries, const Entry *own, EntryPart part);

// Refuses a signal that nothing uses.
bool waves_check_used(const Entries *entries, Err *err);
