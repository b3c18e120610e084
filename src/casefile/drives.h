// The drives of a case that prescribe a motion: `drive`, and those of `drives`, each named by the
// joint that it turns a body about.
#pragma once

#include "casefile/entries.h"

// Numbers the further drives and their joints: what follows from their names alone.
void drives_prepare(const Entries *entries, Linkage *linkage);

// Lets tables over time repeat and finds what follows from them, once all values are read: a last
// point that is the first of the next period is left out. Fails with ERR_CASE where the points do
// not fit into the period, or a drive does not turn by whole turns in it.
bool drives_complete(const Entries *entries, Linkage *linkage, Err *err);

// Whether a key of a drive says how that one moves: by a speed, or by angles.
bool drives_apply(const SchemaRow *row, const Driver *driver);

// Each drive turns a body about an ideal joint with the ground, and another one each.
bool drives_check(const Entries *entries, const Linkage *linkage, Err *err);

// Refuses the drive of whose motion others leave nothing; false.
bool drives_refuse_redundant(const Entries *entries, const Linkage *linkage, size_t drive,
                             Err *err);
