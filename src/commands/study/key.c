// Whose rows are these?
#include "commands/study/key.h"

#include "commands/study/design.h"
#include "version.h"

#include <inttypes.h>
#include <stdio.h>

void key_make(const Spec *spec, const Layout *layout, StudyKey *key)
{
    snprintf(key->print, sizeof key->print, "%016" PRIx64, spec->print);
    build_print(key->build);
    key->head = (StoreHead){
        .layout = layout,
        .run_count = design_run_count(spec),
        .key_count = 4,
        .keys = {{"study", key->print, "the study file or its case has changed"},
                 {"program", JOINTPLAY_VERSION, "another version of jointplay made it"},
                 {"ode", JOINTPLAY_ODE_VERSION, "it was made with another version of ODE"},
                 {"build", key->build, "another build of jointplay made it"}},
    };
}
