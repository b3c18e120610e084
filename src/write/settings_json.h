// The versions at work and the resolved settings of a scenario, as JSON.
#pragma once

#include "model/scenario.h"

#include <jansson.h>

// New references: version, ode, ccd; a setting's value in SI.
json_t *settings_json_tool(void);

// Puts "tool", "case", "title", "settings" and "setting_units" into the object of a result: the
// settings that the scenario makes use of, by the key they have in a case file, in SI.
void settings_json_begin(json_t *object, const Scenario *scenario);

// New reference: every setting, used or not, without units.
json_t *settings_json_all(const Scenario *scenario);

// A fingerprint of the very program that runs: another build of one version may give other numbers.

enum { BUILD_PRINT_SIZE = 17 };

// Writes 16 hexadecimal digits.
void build_print(char text[BUILD_PRINT_SIZE]);
