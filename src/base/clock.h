// What time is it, for durations? Counts from an arbitrary start and never goes back.
#pragma once

#include <time.h>

static inline double clock_now_s(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

// What this process has computed so far, s: the same on a busy machine as on an idle one, or
// nearly.
static inline double clock_processor_s(void)
{
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}
