// Numbers in a table for spreadsheets.
#pragma once

#include <math.h>
#include <stdio.h>

// With 17 digits, which read back as the very same number. One that does not exist, an infinity or
// NaN, leaves its cell empty: JSON has null there.
static inline void csv_number_write(FILE *stream, double value)
{
    if (isfinite(value)) {
        fprintf(stream, "%.17g", value);
    }
}
