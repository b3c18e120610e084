// A 64-bit fingerprint of a stream of numbers: equal bits in equal order give an equal hash.
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

static const uint64_t HASH_START = 0x9e3779b97f4a7c15u; // the golden ratio's bits: any odd constant

// Mixes 64 bits into the hash (one round of a multiply-xorshift permutation).
static inline uint64_t hash_word(uint64_t hash, uint64_t bits)
{
    hash = (hash ^ bits) * 0xff51afd7ed558ccdu;
    return hash ^ (hash >> 32);
}

static inline uint64_t hash_number(uint64_t hash, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return hash_word(hash, bits);
}

static inline uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t count)
{
    const unsigned char *byte = (const unsigned char *)bytes;
    for (size_t i = 0; i < count; i++) {
        hash = hash_number(hash, byte[i]);
    }
    return hash;
}
