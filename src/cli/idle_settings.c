// Which settings of the command line change nothing?
#include "cli/idle_settings.h"

#include "casefile/casefile.h"
#include "cli/output.h"

#include <stdio.h>
#include <string.h>

// Whether a key of the case format is one that the scenario makes no use of.
static bool is_idle(const Scenario *scenario, const char *key)
{
    CasefileSetting setting;
    for (size_t i = 0; casefile_setting(scenario, i, &setting); i++) {
        if (strcmp(setting.key, key) == 0) {
            return !setting.applies;
        }
    }
    return false; // a group of keys
}

void idle_settings_say(const Scenario *scenario, const char *const *overrides, size_t count)
{
    size_t idle = 0;
    for (size_t i = 0; i < count; i++) {
        char key[CASEFILE_KEY_SIZE];
        snprintf(key, sizeof key, "%.*s", (int)strcspn(overrides[i], "="), overrides[i]);
        if (is_idle(scenario, key)) {
            output_say("%s%s", idle++ == 0 ? "without effect: " : ", ", key);
        }
    }
    if (idle > 0) {
        output_say(" (nothing in %s makes use of %s)\n", scenario->path, idle == 1 ? "it" : "them");
    }
}
