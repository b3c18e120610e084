// How each number of model/number_list.h is had from a run.
#pragma once

#include "measure/error.h"
#include "measure/truth.h"
#include "measure/wear.h"
#include "model/numbers.h"

// What numbers are taken from. What is NULL has none.
typedef struct NumberSource {
    const Scenario *scenario;
    const Trajectory *run;
    const TrajectoryError *error;
    const Truth *truth;
    bool is_at_samples;       // extremes are those of the samples, and not of every step
    const SignalSpike *spike; // whose numbers are asked for; NULL: the strongest
    const Spike *contact;     // likewise
    const Wear *wear;         // of the member, where its sums are there already; else NULL
} NumberSource;

// A number of a member: of a body, of a joint, 0 of the run as a whole. SI; NAN where the run does
// not have it, as where its solver models no play.
Extreme number_find(NumberId id, const NumberSource *of, size_t member);

// Whether a linkage has a number of a member, by its traits: of play, of what slides or turns, of
// loads, in space. A body that is driven has none.
bool number_is_of(const Number *number, const Linkage *linkage, size_t member);

// The unit that numbers of a member have.
NumberTurn number_turn(NumberOwner owner, const Linkage *linkage, size_t member);

// How many members have a number each, and the name of one; empty of the run as a whole.
size_t number_member_count(NumberOwner owner, const Linkage *linkage);
const char *number_member(NumberOwner owner, const Linkage *linkage, size_t member);

// The extremes of a body at the samples of a run.
BodyExtremes number_extremes_at_samples(const Trajectory *run, size_t body);
