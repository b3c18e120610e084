// Computes SHA-256 as FIPS 180-4 describes it: blocks of 64 bytes, each mixed into eight words in
// 64 rounds. Ch, Maj, Sigma and sigma are the standard's names.
#include "commands/report/report_sha256.h"

#include <stdint.h>
#include <string.h>

enum { BLOCK_SIZE = 64, ROUNDS = 64, WORDS = 8 };

// the first 32 bits of the fractional parts of the cube roots of the first 64 primes
static const uint32_t K[ROUNDS] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2,
};

static uint32_t turned(uint32_t x, int bits)
{
    return x >> bits | x << (32 - bits);
}

static void mix_block(uint32_t state[WORDS], const unsigned char *block)
{
    // the message schedule
    uint32_t w[ROUNDS];
    for (int t = 0; t < 16; t++) {
        w[t] = (uint32_t)block[4 * t] << 24 | (uint32_t)block[4 * t + 1] << 16 |
               (uint32_t)block[4 * t + 2] << 8 | block[4 * t + 3];
    }
    for (int t = 16; t < ROUNDS; t++) {
        const uint32_t sigma_0 = turned(w[t - 15], 7) ^ turned(w[t - 15], 18) ^ w[t - 15] >> 3;
        const uint32_t sigma_1 = turned(w[t - 2], 17) ^ turned(w[t - 2], 19) ^ w[t - 2] >> 10;
        w[t] = sigma_1 + w[t - 7] + sigma_0 + w[t - 16];
    }
    // the rounds: a to h are v[0] to v[7]
    uint32_t v[WORDS];
    memcpy(v, state, sizeof v);
    for (int t = 0; t < ROUNDS; t++) {
        const uint32_t Sigma_1 = turned(v[4], 6) ^ turned(v[4], 11) ^ turned(v[4], 25);
        const uint32_t Ch = (v[4] & v[5]) ^ (~v[4] & v[6]);
        const uint32_t Sigma_0 = turned(v[0], 2) ^ turned(v[0], 13) ^ turned(v[0], 22);
        const uint32_t Maj = (v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]);
        const uint32_t T_1 = v[7] + Sigma_1 + Ch + K[t] + w[t];
        memmove(v + 1, v, (WORDS - 1) * sizeof *v);
        v[4] += T_1;
        v[0] = T_1 + Sigma_0 + Maj;
    }
    for (int i = 0; i < WORDS; i++) {
        state[i] += v[i];
    }
}

void report_sha256(const void *bytes, size_t count, unsigned char digest[SHA256_SIZE])
{
    // of the square roots of the first eight primes
    uint32_t state[WORDS] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                             0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    const unsigned char *at = bytes;
    size_t left = count;
    for (; left >= BLOCK_SIZE; left -= BLOCK_SIZE, at += BLOCK_SIZE) {
        mix_block(state, at);
    }
    // the rest, a one, zeros, and the number of bits in the last eight bytes
    unsigned char last[2 * BLOCK_SIZE] = {0};
    memcpy(last, at, left);
    last[left] = 0x80;
    const size_t size = left + 9 > BLOCK_SIZE ? 2 * BLOCK_SIZE : BLOCK_SIZE;
    for (int i = 0; i < 8; i++) {
        last[size - 1 - i] = (unsigned char)((uint64_t)count * 8 >> 8 * i);
    }
    for (size_t i = 0; i < size; i += BLOCK_SIZE) {
        mix_block(state, last + i);
    }
    for (int i = 0; i < SHA256_SIZE; i++) {
        digest[i] = (unsigned char)(state[i / 4] >> (24 - 8 * (i % 4)));
    }
}
