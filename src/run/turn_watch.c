// Tells a listener how far the revolutions of a search have come.
#include "run/turn_watch.h"

#include "base/clock.h"

#include <math.h>

TurnWatch turn_watch_begin(RunWatch watch)
{
    return (TurnWatch){
        .watch = watch,
        .started_s = clock_now_s(),
        .computed_s = clock_processor_s(),
    };
}

void turn_watch_count(TurnWatch *watch, bool is_callers)
{
    const size_t turned = atomic_fetch_add(&watch->turned, 1) + 1;
    // only the caller's thread may show anything
    if (is_callers && watch->watch.progress != NULL) {
        const double computed_s = clock_processor_s() - watch->computed_s;
        const double of_budget = watch->budget_s > 0.0 ? computed_s / watch->budget_s : 0.0;
        const double share = fmax((double)turned / (double)watch->most, of_budget);
        watch->watch.progress(fmin(share, 1.0), clock_now_s() - watch->started_s,
                              watch->watch.context);
    }
}
