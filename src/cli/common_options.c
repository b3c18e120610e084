// What was given of the options that several commands share?
#include "cli/common_options.h"

#include <assert.h>

bool common_options_take(int key, const char *value, CommonOptions *options, Err *err)
{
    switch (key) {
    case COMMON_SET:
        return option_values_take_setting(value, options->overrides, &options->override_count, err);
    case COMMON_SCHEMES:
        options->schemes = value;
        return true;
    case COMMON_JOBS:
        return option_values_read_count("jobs", value, 1, OPTION_JOB_MAX, &options->jobs, err);
    case COMMON_TIME_LIMIT:
        return option_values_read_time("time-limit", value, &options->time_limit_s, err);
    case COMMON_JSON:
        options->is_json = true;
        return true;
    case COMMON_WIDE:
        options->is_wide = true;
        return true;
    case COMMON_OUT:
        options->folder = value;
        return true;
    default:
        // a command that lists any other option takes it itself
        assert(key == COMMON_QUIET);
        options->is_quiet = true;
        return true;
    }
}

bool common_options_take_path(const char *path, CommonOptions *options, const char *allowed,
                              Err *err)
{
    if (options->path != NULL) {
        return err_set(err, ERR_USAGE, "%s, not %s and %s", allowed, options->path, path);
    }
    options->path = path;
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
