// The mathematical library chooses its functions by the processor, with fused multiplications where
// it has them: their last digits differ, and with them every hash of a run.
#include "commands/check/fingerprint.h"
#include "base/hash.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Enough that functions which differ in one argument of a hundred differ in some of these.
enum { ARGUMENTS = 2000 };

static uint64_t add(uint64_t hash, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return hash_word(hash, bits);
}

static uint64_t mathematics(uint64_t hash)
{
    for (int i = 1; i <= ARGUMENTS; i++) {
        const double x = (double)i * 0.6180339887498949;
        const double values[] = {sin(x),
                                 cos(x),
                                 tan(x),
                                 exp(x / ARGUMENTS),
                                 log(x),
                                 atan(x),
                                 pow(x, 10.0 / 9.0),
                                 atan2(x, 1.7),
                                 asin(i / (double)ARGUMENTS)};
        for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
            hash = add(hash, values[k]);
        }
    }
    return hash;
}

void fingerprint_print(char text[BUILD_PRINT_SIZE])
{
    build_print(text);
    snprintf(text, BUILD_PRINT_SIZE, "%016" PRIx64, mathematics(strtoull(text, NULL, 16)));
}
