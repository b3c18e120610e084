// Tells a listener how far the revolutions of a search have come.
#include "run/turn_watch.h"

#include "base/clock.h"

TurnWatch turn_watch_begin(RunWatch watch)
{
    return (TurnWatch){.watch = watch, .started_s = clock_now_s()};
}

void turn_watch_count(TurnWatch *watch, bool is_callers)
{
    const size_t turned = atomic_fetch_add(&watch->turned, 1) + 1;
    // only the caller's thread may show anything
    if (is_callers && watch->watch.progress != NULL) {
        watch->watch.progress((double)turned / (double)watch->most,
                              clock_now_s() - watch->started_s, watch->watch.context);
    }
}
