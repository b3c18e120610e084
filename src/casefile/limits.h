// What a case says about the coordinate of a joint: its backlash or stops, and their contact.
#pragma once

#include "casefile/target.h"

// Whether the keys of a joint limit its coordinate.
bool limits_are_given(const Entries *entries, size_t joint);

// Prepares the limits of a joint before values are stored.
Limits limits_prepare(const Entries *entries, size_t joint);

// The dimension of a SCHEMA_DAMPER of a joint whose coordinate is an angle, from that of others.
Dimension limits_turning_damper(Dimension dimension);

// The row of such a key as a value for a joint of that kind has it: that of an angle, or of a
// length. Every other row stays as it is.
SchemaRow limits_row(const SchemaRow *row, JointKind kind, const Node *value);

// Stores a value of a key that depends on what the coordinate of its joint is: an angle or a
// length. Of the kinds SCHEMA_COORDINATE, SCHEMA_DAMPER, SCHEMA_STIFFNESS and SCHEMA_START.
bool limits_store(const Target *target, Joint *joint);

// Centres gaps about where the bodies start, once that is known.
void limits_settle(Linkage *linkage);

// Checks a joint that has limits; with the bodies' starts where the linkage is built.
bool limits_check(const Entries *entries, size_t index, const Scenario *scenario, Err *err);
bool limits_check_starts(const Entries *entries, const Linkage *linkage, Err *err);
