// Packs signals for a page.
#include "commands/report/report_pack.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static const double SIGNAL_ROUNDING = 1e-13; // 1, of the size of a signal

void pack_finish(Pack *pack)
{
    free(pack->bytes);
    *pack = (Pack){0};
}

// Room for so many bytes more.
static unsigned char *pack_grow(Pack *pack, size_t count)
{
    if (pack->length + count > pack->room) {
        pack->room = 2 * (pack->length + count);
        pack->bytes = realloc(pack->bytes, pack->room);
        assert(pack->bytes != NULL);
    }
    unsigned char *grown = pack->bytes + pack->length;
    pack->length += count;
    return grown;
}

// The slope from the first value to the last.
static double slope_of(const double *values, size_t count)
{
    const double slope = count > 1 ? (values[count - 1] - values[0]) / (double)(count - 1) : 0.0;
    return isfinite(slope) ? slope : 0.0;
}

PackedSignal pack_add(Pack *pack, const double *values, size_t count, bool is_turning)
{
    PackedSignal signal = {.offset = pack->length, .count = count};
    signal.slope = is_turning ? slope_of(values, count) : 0.0;
    double low = INFINITY;
    double high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double value = values[i] - signal.slope * (double)i;
        low = isfinite(value) ? fmin(low, value) : low;
        high = isfinite(value) ? fmax(high, value) : high;
    }
    signal.low = low <= high ? low : 0.0;
    // what varies by rounding alone is a constant, and takes next to no room
    const bool varies =
        high - low > SIGNAL_ROUNDING * (fabs(low) + fabs(signal.slope) * (double)count);
    signal.step = varies ? (high - low) / PACK_LEVELS : 0.0;
    unsigned char *bytes = pack_grow(pack, 2 * count);
    uint16_t before = 0;
    for (size_t i = 0; i < count; i++) {
        const double above = values[i] - signal.slope * (double)i - signal.low;
        uint16_t code = 0;
        if (!isfinite(above)) {
            code = PACK_NONE;
        } else if (signal.step > 0.0) {
            code = (uint16_t)fmin(round(above / signal.step), PACK_LEVELS);
        }
        const uint16_t difference = (uint16_t)(code - before);
        bytes[i] = (unsigned char)(difference & 0xff);
        bytes[count + i] = (unsigned char)(difference >> 8);
        before = code;
    }
    return signal;
}

static const char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

void pack_base64(const unsigned char *bytes, size_t count, Text *text)
{
    for (size_t i = 0; i < count; i += 3) {
        const size_t left = count - i;
        const unsigned group = (unsigned)bytes[i] << 16 |
                               (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0) |
                               (left > 2 ? bytes[i + 2] : 0u);
        const char digits[4] = {
            DIGITS[group >> 18],
            DIGITS[group >> 12 & 63],
            left > 1 ? DIGITS[group >> 6 & 63] : '=',
            left > 2 ? DIGITS[group & 63] : '=',
        };
        text_append_bytes(text, digits, sizeof digits);
    }
}

enum { LINE_BYTES = 3 * 4096 }; // of a line of base64: editors and mail dislike longer ones

void pack_write(const Pack *pack, const char *json, Text *text)
{
    // the JSON before the signals
    const size_t json_length = strlen(json);
    const size_t size = 4 + json_length + pack->length;
    unsigned char *whole = malloc(size);
    assert(whole != NULL);
    for (int i = 0; i < 4; i++) {
        whole[i] = (unsigned char)(json_length >> 8 * i);
    }
    memcpy(whole + 4, json, json_length);
    if (pack->length > 0) {
        memcpy(whole + 4 + json_length, pack->bytes, pack->length);
    }
    uLongf packed_size = compressBound((uLong)size);
    unsigned char *packed = malloc(packed_size);
    assert(packed != NULL);
    const int status = compress2(packed, &packed_size, whole, (uLong)size, Z_BEST_COMPRESSION);
    assert(status == Z_OK);
    for (size_t i = 0; i < packed_size; i += LINE_BYTES) {
        const size_t left = packed_size - i;
        pack_base64(packed + i, left < LINE_BYTES ? left : LINE_BYTES, text);
        text_append(text, "\n");
    }
    free(packed);
    free(whole);
}
