// A handful of random numbers from a seed, the same everywhere.
#pragma once

#include <stdint.h>

// The seed that a small number stands for: the first draws of neighbouring numbers are alike in
// nothing once the seed has been stirred.
static inline uint64_t lcg_stirred(unsigned number)
{
    uint64_t seed = number;
    for (int i = 0; i < 4; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
    }
    return seed;
}

// A number in [-1, 1): Knuth's 64-bit linear congruential generator, whose high bits are good
// enough for a handful of draws.
static inline double lcg_draw(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}
