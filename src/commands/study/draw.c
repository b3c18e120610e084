// Which value does a variable have in a draw?
//
// Random numbers come from a counter: three rounds of a 64-bit mixer, over seed, stream and
// position. Each round is a bijection in which every bit of what goes in flips every bit of what
// comes out with a chance of a half (Stafford's variant 13 of MurmurHash3's finaliser, as in
// Steele, Lea and Flood, Fast splittable pseudorandom number generators, OOPSLA 2014).
//
// A Latin hypercube of n draws takes draw i of a variable from the share
//     u = (s(i) + r) / n,
// s an order of 0 to n-1 and r from 0 to 1. s is a Feistel network over the next power of four: two
// halves of a number's bits, each in turn changed by a random function of the other. That is a
// bijection whatever the function; a result beyond n is put in again until it is not (Black and
// Rogaway, Ciphers with arbitrary finite domains, CT-RSA 2002), at most four times on the average.
// The network makes even permutations alone: half of the time the first two positions are swapped.
//
// Values follow from shares by the inverse of their distribution:
//     uniform      low + u (high - low)
//     log-uniform  low (high / low)^u
//     normal       mean + deviation z(u), z of the standard normal distribution between its limits
//     triangular   low + sqrt(u (high - low) (mode - low)) up to the mode, the same from above
#include "commands/study/draw.h"

#include "base/hash.h"
#include "commands/study/normal.h"

#include <assert.h>
#include <math.h>
#include <string.h>

// two rounds a half would do for large numbers; small ones have few bits to mix with
enum { ROUND_COUNT = 10 };

// What keeps the numbers of one purpose apart from another's.
typedef enum Purpose { PURPOSE_SHARE, PURPOSE_POSITION } Purpose;

static uint64_t mix(uint64_t bits)
{
    bits += HASH_START; // so that 0 is no fixed point
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    return bits ^ (bits >> 31);
}

static uint64_t random_bits(uint64_t seed, uint64_t stream, Purpose purpose, uint64_t position)
{
    return mix(mix(mix(seed) ^ (stream + (uint64_t)purpose)) ^ position);
}

double draw_share(uint64_t seed, uint64_t stream, uint64_t position)
{
    // 52 bits and a half: the ends 0 and 1 are out of reach
    return ((double)(random_bits(seed, stream, PURPOSE_SHARE, position) >> 12) + 0.5) * 0x1p-52;
}

uint64_t draw_position(uint64_t seed, uint64_t stream, uint64_t count, uint64_t item)
{
    assert(item < count);
    unsigned half = 1;
    while (count >> (2 * half) != 0) {
        half++;
    }
    const uint64_t mask = ((uint64_t)1 << half) - 1;
    const uint64_t own = random_bits(seed, stream, PURPOSE_POSITION, count);
    uint64_t position = item;
    do {
        uint64_t left = position >> half;
        uint64_t right = position & mask;
        for (uint64_t round = 0; round < ROUND_COUNT; round++) {
            const uint64_t next = left ^ (mix(own ^ (right * ROUND_COUNT + round)) & mask);
            left = right;
            right = next;
        }
        position = left << half | right;
        position ^= position < 2 ? own >> 63 : 0;
    } while (position >= count);
    return position;
}

uint64_t draw_stream(const char *key)
{
    return hash_bytes(HASH_START, key, strlen(key));
}

double draw_variable_share(const Spec *spec, const Variable *variable, uint64_t draw)
{
    const uint64_t stream = draw_stream(variable->key);
    const double share = draw_share(spec->seed, stream, draw);
    if (spec->method == DRAW_RANDOM) {
        return share;
    }
    const double position = (double)draw_position(spec->seed, stream, spec->draws, draw);
    // what rounding would lift into the next share stays in its own
    return fmin(position + share, nextafter(position + 1.0, 0.0)) / (double)spec->draws;
}

static double normal_value(const Variable *variable, double share)
{
    const double low = (variable->low - variable->centre) / variable->deviation;
    const double high = (variable->high - variable->centre) / variable->deviation;
    return variable->centre + variable->deviation * normal_quantile(share, low, high);
}

static double triangular_value(const Variable *variable, double share)
{
    const double width = variable->high - variable->low;
    const double below = variable->centre - variable->low;
    if (share * width <= below) {
        return variable->low + sqrt(share * width * below);
    }
    return variable->high - sqrt((1.0 - share) * width * (variable->high - variable->centre));
}

// Each whole number from the lowest to the highest has the same share.
static double whole_value(const Variable *variable, double share)
{
    return variable->low + floor(share * (variable->high - variable->low + 1.0));
}

double draw_value(const Variable *variable, double share)
{
    double value = NAN;
    switch (variable->kind) {
    case VARIABLE_UNIFORM:
        value = variable->is_whole ? whole_value(variable, share)
                                   : variable->low + share * (variable->high - variable->low);
        break;
    case VARIABLE_LOG_UNIFORM:
        value = variable->low * pow(variable->high / variable->low, share);
        break;
    case VARIABLE_NORMAL:
        value = normal_value(variable, share);
        break;
    case VARIABLE_TRIANGULAR:
        value = triangular_value(variable, share);
        break;
    case VARIABLE_LIST:
    case VARIABLE_LINEAR:
    case VARIABLE_LOGARITHMIC:
        assert(false);
    }
    return fmin(fmax(value, variable->low), variable->high);
}
