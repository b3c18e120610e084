// Decides what makes the runs of a study, and what is asked of it, where the file does not say so.
#include "commands/study/spec.h"

#include <string.h>

// Keys whose paths begin so are of ODE and other engines.
static const char *const OF_ENGINES[] = {"ode.", "engines.", "run.step", "run.tolerance",
                                         "run.budget"};

static bool has_reference(const RunOptions *run)
{
    bool has = false;
    for (size_t i = 0; i < run->backend_count; i++) {
        has = has || run->backends[i] == BACKEND_REFERENCE;
    }
    return has;
}

// Whether runs of no scheme are of the reference: nobody speaks of a step or setting of ODE, or
// asks how far it is off.
static bool is_of_reference(const Spec *spec)
{
    bool speaks = spec->has_truth || !has_reference(&spec->base->run);
    for (size_t i = 0; i < sizeof OF_ENGINES / sizeof *OF_ENGINES; i++) {
        speaks = speaks || casefile_gives(spec->base, OF_ENGINES[i]);
    }
    for (size_t i = 0; i < spec->variable_count; i++) {
        speaks = speaks || !spec->variables[i].changes_truth;
    }
    return !speaks;
}

void spec_decide_backend(bool is_truth_said, Spec *spec)
{
    spec->has_truth = spec->has_truth && is_truth_said;
    spec->backend = is_of_reference(spec) ? BACKEND_REFERENCE : BACKEND_ODE;
    spec->has_truth = spec->has_truth || (!is_truth_said && spec->backend == BACKEND_ODE);
    spec->is_quick = spec->backend == BACKEND_REFERENCE &&
                     !casefile_gives(spec->base, "reference.tolerance") &&
                     spec_variable(spec, "reference.tolerance") == NULL;
    spec->has_neighbours = spec->settle == SETTLE_NEIGHBOURS && !spec->has_truth &&
                           spec->follow[0] == '\0' && scenario_settles(spec->base);
}
