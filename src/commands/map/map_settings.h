// What is asked of a mapping beside the case, as words: by the options of `jointplay map`, and by
// the library of cases.
#pragma once

#include "measure/mapping.h"

typedef struct MapChoices {
    const char *steps; // as given, or NULL; likewise the next four
    const char *maps;
    const char *laws;
    const char *mass;
    const char *speed;
    double step_s;    // the only step; 0 where it was not given
    double at_step_s; // likewise one that cannot be changed
} MapChoices;

// The settings of a mapping of a scenario. Fails with ERR_USAGE.
bool map_settings_read(const MapChoices *choices, const Scenario *scenario,
                       MappingSettings *settings, Err *err);
