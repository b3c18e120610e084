// Which program is this?
#include "write/build_print.h"

#include "base/hash.h"

#include <inttypes.h>
#include <stdio.h>

enum { CHUNK_WORDS = 1 << 13 };

void build_print(char text[BUILD_PRINT_SIZE])
{
    uint64_t chunk[CHUNK_WORDS] = {0};
    uint64_t hash = HASH_START;
    FILE *stream = fopen("/proc/self/exe", "rb");
    size_t count;
    while (stream != NULL && (count = fread(chunk, 1, sizeof chunk, stream)) > 0) {
        // by words, for the program has millions of bytes; those behind the last are of the chunk
        // before
        for (size_t i = 0; i < (count + sizeof *chunk - 1) / sizeof *chunk; i++) {
            hash = hash_word(hash, chunk[i]);
        }
    }
    if (stream != NULL) {
        fclose(stream);
    }
    snprintf(text, BUILD_PRINT_SIZE, "%016" PRIx64, hash);
}
