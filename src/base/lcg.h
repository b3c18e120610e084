// A handful of random numbers from a seed, the same everywhere.
#pragma once

#include <stdint.h>

// A number in [-1, 1): Knuth's 64-bit linear congruential generator, whose high bits are good
// enough for a handful of draws.
static inline double lcg_draw(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}
