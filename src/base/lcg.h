// A handful of random numbers from a seed, the same everywhere.
#pragma once

#include <stdint.h>

// The seed that a number stands for, by the finalizer of SplitMix64 (Steele, Lea and Flood, 2014).
// It must not be affine, as the generator is: else the k-th draws of neighbouring numbers are a
// lattice, which for some k rises steadily over a whole sample.
static inline uint64_t lcg_stirred(unsigned number)
{
    uint64_t seed = number + 0x9e3779b97f4a7c15u;
    seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9u;
    seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebu;
    return seed ^ (seed >> 31);
}

// A number in [-1, 1): Knuth's 64-bit linear congruential generator, whose high bits are good
// enough for a handful of draws.
static inline double lcg_draw(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}
