// The kind of a joint, which follows from the keys that a case gives of it.
#pragma once

#include "casefile/entries.h"

JointKind joint_kind_find(const Entries *entries, size_t joint);

// Whether every key of every joint is one of its kind. Fails with the first that is not.
bool joint_kind_check(const Entries *entries, Err *err);
