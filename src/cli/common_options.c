// Carries out the options that several commands share.
#include "cli/common_options.h"

#include "casefile/casefile.h"
#include "cli/progress.h"
#include "run/settle.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

size_t common_options_count_jobs(void)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    const long most = OPTION_JOB_MAX;
    return cores < 1 ? 1 : (size_t)(cores < most ? cores : most);
}

bool common_options_read(const CommonOptions *options, Scenario *scenario, Err *err)
{
    return casefile_load(options->path, options->overrides, options->override_count, scenario, err);
}

void common_options_settle(const CommonOptions *options, Scenario *scenario)
{
    Progress progress;
    progress_begin(&progress, options->is_quiet);
    settle_scenario(scenario, progress_watch(&progress, SETTLE_DOING));
    progress_end(&progress);
}

bool common_options_load(const CommonOptions *options, Scenario *scenario, Err *err)
{
    if (!common_options_read(options, scenario, err)) {
        return false;
    }
    common_options_settle(options, scenario);
    return true;
}

bool common_options_check_step(const CommonOptions *options, double step_s, Err *err)
{
    const char *overrides[OPTION_SETTING_MAX + 1];
    char step[64];
    snprintf(step, sizeof step, "run.step=%.17g s", step_s);
    memcpy(overrides, options->overrides, options->override_count * sizeof *overrides);
    overrides[options->override_count] = step;
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    const bool is_right =
        casefile_load(options->path, overrides, options->override_count + 1, scenario, err);
    scenario_destroy(scenario);
    return is_right;
}

bool common_options_driver(const char *driver, BackendKind *backend, Err *err)
{
    char name[ENGINE_NAME_SIZE];
    if (!engine_given_name(driver, name, err)) {
        return false;
    }
    *backend = BACKEND_DRIVER;
    for (int i = 0; i < BACKEND_COUNT; i++) {
        *backend = strcmp(OPTIONS_BACKENDS[i], name) == 0 ? (BackendKind)i : *backend;
    }
    return true;
}

bool common_options_take_driver(const char *driver, Scenario *scenario, BackendKind *backend,
                                Err *err)
{
    if (!common_options_driver(driver, backend, err)) {
        return false;
    }
    if (scenario->engines[*backend].driver != NULL) {
        return err_set(err, ERR_USAGE, "--driver names two programs for the backend '%s'",
                       OPTIONS_BACKENDS[*backend]);
    }
    scenario->engines[*backend].driver = driver;
    return true;
}

void common_options_limit_drivers(double time_limit_s, Scenario *scenario)
{
    for (int i = 0; i < BACKEND_COUNT; i++) {
        scenario->engines[i].time_limit_s = time_limit_s;
    }
}

bool common_options_take_drivers(const CommonOptions *options, Scenario *scenario, Err *err)
{
    const char *const *drivers = options->drivers;
    common_options_limit_drivers(options->time_limit_s, scenario);
    for (size_t i = 0; i < options->driver_count; i++) {
        BackendKind backend;
        if (!common_options_take_driver(drivers[i], scenario, &backend, err)) {
            return false;
        }
        bool is_used = false;
        for (size_t k = 0; k < scenario->run.backend_count; k++) {
            is_used = is_used || scenario->run.backends[k] == backend;
        }
        if (!is_used) {
            return err_set(err, ERR_USAGE,
                           "--driver %s is not used: '%.*s' is not among the backends", drivers[i],
                           (int)strcspn(drivers[i], "="), drivers[i]);
        }
    }
    return true;
}

bool common_options_list_schemes(const CommonOptions *options, const Scenario *scenario,
                                 Scheme schemes[SCHEME_MAX], size_t *count, Err *err)
{
    *count = scheme_list(scenario, schemes);
    if (options->schemes == NULL) {
        scheme_keep_usual(schemes, count);
        return true;
    }
    return scheme_filter(options->schemes, schemes, count, err);
}
