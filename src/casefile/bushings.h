// Reads bushings, and checks that they go with the rest of a case.
#pragma once

#include "casefile/target.h"

// Names the bushings, whose values come later; notes which are placed at two points.
void bushings_prepare(const Entries *entries, Linkage *linkage);

// Stores one number for both axes, or [x, y]; and the points of a force or torque over deflection.
bool bushings_store_pair(const Target *target, Vec2 *pair);
bool bushings_store_curve(const Target *target, ForceCurve *curve);

// Moves what the case gives in the world at time zero into the bodies' frames.
void bushings_place(Linkage *linkage, const Motion *motions);

// A bushing of which the case does not say at which angle it is relaxed is so at time zero.
void bushings_relax(const Entries *entries, const Motion *motions, Linkage *linkage);

// Whether a key says how a bushing is.
bool bushings_apply(const SchemaRow *row, const Bushing *bushing);

// Fails where a bushing's keys do not go together, or it does nothing.
bool bushings_check(const Entries *entries, const Linkage *linkage, Err *err);
