// Comparing numbers in tests: a failure shows both and how far they are apart.
#pragma once

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

// Fails unless |value - truth| <= tolerance; a NaN fails.
#define assert_near(value, truth, tolerance)                                                       \
    close_check((value), (truth), (tolerance), #value, __FILE__, __LINE__)

// Fails unless value is within a share of the truth.
#define assert_close(value, truth, share)                                                          \
    close_check((value), (truth), (share)*fabs(truth), #value, __FILE__, __LINE__)

static inline void close_check(double value, double truth, double tolerance, const char *what,
                               const char *file, int line)
{
    if (!(fabs(value - truth) <= tolerance)) {
        print_error("%s = %.17g is not %.17g to within %.3g\n", what, value, truth, tolerance);
        _fail(file, line);
    }
}
