// Where does a function of one variable cross zero, and where is it smallest?
#include "base/root.h"

#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>
#include <gsl/gsl_roots.h>
#include <math.h>

// bisection alone would need about 1100 halvings from the widest bracket of doubles to the last
// bit; Brent's method never needs more than a small multiple of that and in practice below 20
enum { ROOT_ITERATION_MAX = 4000 };

bool root_find(RootFunction f, void *context, double low, double high, double x_tolerance,
               double *x)
{
    const double at_low = f(low, context);
    const double at_high = f(high, context);
    if (at_low == 0.0 || at_high == 0.0) {
        *x = at_low == 0.0 ? low : high;
        return true;
    }
    if (!isfinite(at_low) || !isfinite(at_high) || (at_low > 0.0) == (at_high > 0.0)) {
        return false;
    }
    gsl_error_handler_t *former = gsl_set_error_handler_off();
    gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    gsl_function function = {.function = f, .params = context};
    int status = gsl_root_fsolver_set(solver, &function, low, high);
    bool is_found = false;
    for (int i = 0; status == GSL_SUCCESS && !is_found && i < ROOT_ITERATION_MAX; i++) {
        status = gsl_root_fsolver_iterate(solver);
        const double a = gsl_root_fsolver_x_lower(solver);
        const double b = gsl_root_fsolver_x_upper(solver);
        const double last_bit = 2.0 * DBL_EPSILON * fmax(fabs(a), fabs(b));
        is_found = b - a <= fmax(x_tolerance, last_bit) || a == b;
    }
    if (is_found) {
        *x = gsl_root_fsolver_root(solver);
    }
    gsl_root_fsolver_free(solver);
    gsl_set_error_handler(former);
    return is_found;
}

bool root_minimum(RootFunction f, void *context, double low, double middle, double high, double *x)
{
    // a minimum's place is known to the root of the rounding only
    const double width = sqrt(DBL_EPSILON) * (high - low);
    gsl_error_handler_t *former = gsl_set_error_handler_off();
    gsl_min_fminimizer *minimizer = gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent);
    gsl_function function = {.function = f, .params = context};
    int status = gsl_min_fminimizer_set(minimizer, &function, middle, low, high);
    const bool is_enclosed = status == GSL_SUCCESS;
    for (int i = 0; status == GSL_SUCCESS && i < ROOT_ITERATION_MAX; i++) {
        status = gsl_min_fminimizer_iterate(minimizer);
        const double a = gsl_min_fminimizer_x_lower(minimizer);
        const double b = gsl_min_fminimizer_x_upper(minimizer);
        if (b - a <= width) {
            break;
        }
    }
    if (is_enclosed) {
        *x = gsl_min_fminimizer_x_minimum(minimizer);
    }
    gsl_min_fminimizer_free(minimizer);
    gsl_set_error_handler(former);
    return is_enclosed;
}
