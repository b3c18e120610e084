// Which of many points are worth their time?
//
// From the fastest point to the slowest, one belongs to the frontier (Pareto's) where its error is
// below 0.99 times the least so far. Some hundred points: the next one is looked for among all.
#include "measure/frontier.h"

#include <math.h>

// two solvers that agree in all but rounding are equally accurate
static const double TIE = 0.01;

static bool is_point(double time, double error)
{
    return isfinite(time) && isfinite(error);
}

// Whether a point comes before another: faster, or as fast and more accurate, or first in the list.
static bool comes_before(const double *times, const double *errors, size_t a, size_t b)
{
    if (times[a] != times[b]) {
        return times[a] < times[b];
    }
    return errors[a] != errors[b] ? errors[a] < errors[b] : a < b;
}

// The first point behind another (behind none where that is `count`), or `count`.
static size_t next_point(size_t count, const double *times, const double *errors, size_t last)
{
    size_t next = count;
    for (size_t i = 0; i < count; i++) {
        if (is_point(times[i], errors[i]) &&
            (last == count || comes_before(times, errors, last, i)) &&
            (next == count || comes_before(times, errors, i, next))) {
            next = i;
        }
    }
    return next;
}

void frontier_mark(size_t count, const double *times, const double *errors, bool *is_on_frontier)
{
    for (size_t i = 0; i < count; i++) {
        is_on_frontier[i] = false;
    }
    double least = INFINITY;
    for (size_t i = next_point(count, times, errors, count); i < count;
         i = next_point(count, times, errors, i)) {
        if (errors[i] < (1.0 - TIE) * least) {
            is_on_frontier[i] = true;
            least = errors[i];
        }
    }
}

size_t frontier_cheapest(size_t count, const double *times, const double *errors,
                         double uncertainty, double target)
{
    size_t best = count;
    for (size_t i = 0; i < count; i++) {
        if (!is_point(times[i], errors[i]) || !(errors[i] + uncertainty <= target)) {
            continue;
        }
        if (best == count || times[i] < times[best] ||
            (times[i] == times[best] && errors[i] < errors[best])) {
            best = i;
        }
    }
    return best;
}
