// The period after which all that acts on a linkage as time goes by is the same again: drives,
// torques, loads. Only with one there is a motion that a mechanism settles in.
#pragma once

#include "model/linkage.h"

enum { COMMON_PERIOD_TEXT_SIZE = 256 };

typedef struct CommonPeriod {
    double period_s;  // 0: there is none
    bool is_mismatch; // because two periods have none in common, or only a very long one
    char why[COMMON_PERIOD_TEXT_SIZE]; // there is none, for people, as the end of a sentence
} CommonPeriod;

// What is constant has every period, and a load over a position, or over the angle of a crank whose
// motion nothing prescribes, is the mechanism's own and sets none. The period is at least that of
// the drive (linkage_period), which it holds a whole number of times.
CommonPeriod common_period_find(const Linkage *linkage);
