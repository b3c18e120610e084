// Random numbers by their position: what a draw of a variable is follows from its number alone, so
// that no list of draws is ever held, and any machine can make any of them.
#pragma once

#include "commands/study/spec.h"

// A number above 0 and below 1 of a stream, independent of all other positions and streams.
double draw_share(uint64_t seed, uint64_t stream, uint64_t position);

// The position of an item, below count, in an order of the items 0 to count - 1 that is as good as
// shuffled: another for each stream. Needs no memory. The count is 1 to 2^53.
uint64_t draw_position(uint64_t seed, uint64_t stream, uint64_t count, uint64_t item);

// The stream of a variable: that of its key, so that one variable more changes no other's draws.
uint64_t draw_stream(const char *key);

// The share, above 0 and below 1, of a variable's distribution below the value that it has in a
// draw. Of a Latin hypercube the draws of each variable fall one into each of `draws` equal shares.
double draw_variable_share(const Spec *spec, const Variable *variable, uint64_t draw);

// The value that has the share of a drawn variable's distribution below it; a whole number where
// the variable is.
double draw_value(const Variable *variable, double share);
