// Do the runs of a case keep within the limits that it sets itself?
#include "commands/check/check_limits.h"

#include "commands/check/expect_value.h"

#include <math.h>
#include <stdio.h>

static CheckLimit judge(const Expectation *expectation, const char *backend, double value)
{
    CheckLimit limit = {.expectation = expectation, .value = value};
    snprintf(limit.name, sizeof limit.name, "%s%s%s", backend, backend[0] != '\0' ? "." : "",
             expectation->path);
    limit.off = isfinite(value) ? expect_value_off(expectation, value) : NAN;
    limit.verdict = !isfinite(value) ? CHECK_GONE : limit.off == 0.0 ? CHECK_WITHIN : CHECK_OUT;
    return limit;
}

size_t check_limits_judge(const Scenario *scenario, const CheckMeasure *run, CheckLimit *limits)
{
    size_t count = 0;
    for (size_t i = 0; i < scenario->expectation_count; i++) {
        const Expectation *expectation = &scenario->expectations[i];
        const size_t before = count;
        for (size_t k = 0; k < scenario->run.backend_count; k++) {
            const BackendKind backend = scenario->run.backends[k];
            if (expect_value_concerns(expectation, scenario, backend)) {
                limits[count++] =
                    judge(expectation, OPTIONS_BACKENDS[backend], run->expected[i][backend]);
            }
        }
        if (count == before) {
            const bool is_named = expectation->backend != EXPECTATION_ANY_BACKEND;
            limits[count++] =
                judge(expectation, is_named ? OPTIONS_BACKENDS[expectation->backend] : "", NAN);
        }
    }
    return count;
}
