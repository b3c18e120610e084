// Signals packed small, for a page to carry: 16 bits a value, differences, deflated, in base64.
//
// A packed page is
//     base64(zlib(length of the JSON, 4 bytes little-endian; the JSON; the signals))
// and a signal of n values is 2 n bytes: the low bytes of its n differences, then the high ones.
// The differences d_i of the codes q_i, modulo 65536, begin with q_0. A code means
//     value_i = low + slope i + step q_i
// but for PACK_NONE, which is no number. A value is off by half a step at most, that is by 1/131068
// of the signal's range, and by 1e-13 of its size where it is constant but for rounding.
#pragma once

#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

enum { PACK_LEVELS = 65534, PACK_NONE = 65535 };

typedef struct Pack {
    unsigned char *bytes; // owned
    size_t length;
    size_t room;
} Pack;

// Where a signal stands in a pack, and what its codes mean.
typedef struct PackedSignal {
    size_t offset; // bytes, from the first signal
    size_t count;
    double low;
    double slope; // a value
    double step;
} PackedSignal;

void pack_finish(Pack *pack);

// Adds a signal. With `is_turning` a straight line is taken away before, so that an angle of many
// turns is as exact as one of few. What is not finite becomes PACK_NONE.
PackedSignal pack_add(Pack *pack, const double *values, size_t count, bool is_turning);

// Appends the whole as base64, in lines.
void pack_write(const Pack *pack, const char *json, Text *text);

// Appends bytes as base64, without line breaks.
void pack_base64(const unsigned char *bytes, size_t count, Text *text);
