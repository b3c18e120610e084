// Reads what is chosen on the command line of a case that is run.
#include "commands/run/run_choices.h"
#include "casefile/casefile.h"

#include <stdlib.h>
#include <string.h>

static bool add_override(RunChoices *choices, const char *key, const char *value, Err *err)
{
    CommonOptions *common = &choices->common;
    if (common->override_count == OPTION_SETTING_MAX) {
        return err_set(err, ERR_USAGE, "more than %d settings on one command line",
                       OPTION_SETTING_MAX);
    }
    Text text;
    text_init(&text);
    text_append(&text, "%s%s", key, value);
    // the text's memory now belongs to the list
    choices->owned[choices->owned_count++] = text.data;
    common->overrides[common->override_count++] = text.data;
    return true;
}

bool run_choices_read_backend(const char *names, void *choices, Err *err)
{
    Text *backends = &((RunChoices *)choices)->backends;
    if (names[strspn(names, " \t")] == '\0') {
        return err_set(err, ERR_USAGE, "--backend names no backend; such as --backend ode");
    }
    text_append(backends, "%s%s", backends->length > 0 ? ", " : "", names);
    return true;
}

bool run_choices_read_step(const char *step, void *choices, Err *err)
{
    return add_override(choices, "run.step=", step, err);
}

bool run_choices_read_budget(const char *budget, void *choices, Err *err)
{
    return add_override(choices, "run.budget=", budget, err);
}

void run_choices_begin(RunChoices *choices)
{
    text_init(&choices->backends);
}

// What stands in a case for a backend of the command line: a driver that is no engine's has any
// name there, and is `driver` in the case.
static const char *backend_word(const CommonOptions *common, const char *name)
{
    for (size_t i = 0; i < common->driver_count; i++) {
        BackendKind backend;
        Err unused;
        const size_t length = strcspn(common->drivers[i], "=");
        if (strlen(name) == length && strncmp(common->drivers[i], name, length) == 0 &&
            common_options_driver(common->drivers[i], &backend, &unused)) {
            return OPTIONS_BACKENDS[backend];
        }
    }
    return name;
}

// The setting of the backends that were named.
static bool set_backends(RunChoices *choices, Err *err)
{
    Text words;
    text_init(&words);
    char *rest = NULL;
    for (const char *name = strtok_r(choices->backends.data, ", \t", &rest); name != NULL;
         name = strtok_r(NULL, ", \t", &rest)) {
        text_append(&words, "%s%s", words.length > 0 ? ", " : "",
                    backend_word(&choices->common, name));
    }
    text_append(&words, "]");
    const bool is_added = add_override(choices, "run.backends=[", words.data, err);
    text_finish(&words);
    return is_added;
}

bool run_choices_end(RunChoices *choices, Err *err)
{
    return choices->backends.length == 0 || set_backends(choices, err);
}

void run_choices_finish(RunChoices *choices)
{
    for (size_t i = 0; i < choices->owned_count; i++) {
        free(choices->owned[i]);
    }
    text_finish(&choices->backends);
}

bool run_choices_load(const RunChoices *choices, const char *path, CaseRun *run, Err *err)
{
    const CommonOptions *common = &choices->common;
    run->is_uncertified = choices->is_uncertified;
    run->is_quick = choices->is_quick;
    run->path = path;
    run->as_read.overrides = common->overrides;
    run->as_read.override_count = common->override_count;
    return casefile_load(path, common->overrides, common->override_count, &run->scenario, err) &&
           common_options_take_drivers(common, &run->scenario, err) && case_run_check(run, err);
}
