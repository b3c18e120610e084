// How many of a test's seeded trials are made: all, or where JOINTPLAY_SAMPLE=N stands in the
// environment one of N. .ci/run sets it by day for the build with sanitizers, when the user's build
// has made them all; at night that makes them all, too.
#pragma once

#include <stdlib.h>

// N: every so many of trials in a row is made.
static inline size_t sample_stride(void)
{
    const char *words = getenv("JOINTPLAY_SAMPLE");
    const long stride = words != NULL ? strtol(words, NULL, 10) : 1;
    return stride > 1 ? (size_t)stride : 1;
}

// So many of a count of trials are made.
static inline size_t sample_size(size_t count)
{
    return (count + sample_stride() - 1) / sample_stride();
}
