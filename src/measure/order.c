// At which power of the step does an error fall, and over which steps?
//
//     p_i = ln(e_i / e_i+1) / ln(h_i / h_i+1)                      from step i to the next
//     p = sum (x - <x>)(y - <y>) / sum (x - <x>)^2,  x = ln h, y = ln e     over the range
#include "measure/order.h"

#include <math.h>

// orders of one and two must never be taken as one range; errors taken as a maximum over samples
// scatter by some 0.1
static const double ORDER_AGREEMENT = 0.25;
// a slower fall is none: a bias that a finer step does not take away
static const double ORDER_LEAST = 0.25;
enum { POINTS_LEAST = 3 };

static bool is_above(double error, double floor)
{
    return isfinite(error) && error > floor && error > 0.0;
}

static double local_order(const double *steps, const double *errors, size_t index)
{
    return log(errors[index] / errors[index + 1]) / log(steps[index] / steps[index + 1]);
}

// The longest range that begins at a step; its spread. One point where nothing agrees.
static size_t extend(size_t count, const double *steps, const double *errors, double floor,
                     size_t first, double *spread)
{
    double low = INFINITY;
    double high = -INFINITY;
    size_t last = first;
    *spread = 0.0;
    while (last + 1 < count && is_above(errors[last], floor) && is_above(errors[last + 1], floor)) {
        const double order = local_order(steps, errors, last);
        low = fmin(low, order);
        high = fmax(high, order);
        if (!(high - low <= ORDER_AGREEMENT) || !(low >= ORDER_LEAST)) {
            break;
        }
        *spread = high - low;
        last++;
    }
    return last;
}

static double slope(size_t first, size_t last, const double *steps, const double *errors)
{
    const double count = (double)(last - first + 1);
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (size_t i = first; i <= last; i++) {
        mean_x += log(steps[i]) / count;
        mean_y += log(errors[i]) / count;
    }
    double mixed = 0.0;
    double square = 0.0;
    for (size_t i = first; i <= last; i++) {
        const double x = log(steps[i]) - mean_x;
        mixed += x * (log(errors[i]) - mean_y);
        square += x * x;
    }
    return mixed / square;
}

Order order_fit(size_t count, const double *steps, const double *errors, double floor)
{
    Order best = {.is_known = false};
    for (size_t first = 0; first < count; first++) {
        double spread;
        const size_t last = extend(count, steps, errors, floor, first, &spread);
        const bool is_long = last - first + 1 >= POINTS_LEAST;
        if (is_long && (!best.is_known || last - first >= best.last - best.first)) {
            best = (Order){.is_known = true, .first = first, .last = last, .spread = spread};
        }
    }
    if (best.is_known) {
        best.order = slope(best.first, best.last, steps, errors);
        best.points = best.last - best.first + 1;
        best.from_s = steps[best.first];
        best.to_s = steps[best.last];
    }
    return best;
}
