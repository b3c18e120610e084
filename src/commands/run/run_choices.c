// Reads what is chosen on the command line of a case that is run.
#include "commands/run/run_choices.h"
#include "casefile/casefile.h"
#include "measure/chosen_run.h"

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

void run_choices_begin(RunChoices *choices)
{
    text_init(&choices->backends);
}

bool run_choices_end(RunChoices *choices, Err *err)
{
    if (choices->backends.length > 0) {
        text_append(&choices->backends, "]");
        return add_override(choices, "run.backends=[", choices->backends.data, err);
    }
    return true;
}

void run_choices_finish(RunChoices *choices)
{
    for (size_t i = 0; i < choices->owned_count; i++) {
        free(choices->owned[i]);
    }
    text_finish(&choices->backends);
}

// A step is chosen by its error against a reference whose own is known.
static bool check_uncertified(const Scenario *scenario, Err *err)
{
    for (size_t i = 0; i < scenario->run.backend_count; i++) {
        if (backend_run_is_chosen(scenario, scenario->run.backends[i])) {
            return err_set(err, ERR_USAGE,
                           "%s: the step of ode is chosen by its error against the certified "
                           "reference; with --uncertified give --step TIME, or --backend without "
                           "ode",
                           scenario_path(scenario));
        }
    }
    return true;
}

bool run_choices_load(const RunChoices *choices, const char *path, CaseRun *run, Err *err)
{
    run->is_uncertified = choices->is_uncertified;
    return casefile_load(path, choices->common.overrides, choices->common.override_count,
                         &run->scenario, err) &&
           (!run->is_uncertified || check_uncertified(&run->scenario, err));
}
