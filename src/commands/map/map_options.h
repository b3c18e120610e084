// What `jointplay map` was asked for.
#pragma once

#include "cli/common_options.h"
#include "measure/mapping.h"

typedef struct MapOptions {
    CommonOptions common; // without a path where a row alone is to be read
    const char *steps;    // as given, or NULL; likewise the next eight
    const char *maps;
    const char *laws;
    const char *mass;
    const char *speed;
    const char *stiffness; // of a contact without a case
    const char *restitution;
    const char *damping;
    const char *clearance;
    bool with_penalty;
    bool is_inverse;       // ERP and CFM, or kp and kd, are to be read
    bool has_erp, has_cfm; // which of them were given
    bool has_kp, has_kd;   //
    double erp, cfm;       // 1, m/(N s)
    double kp, kd;         // N/m, N s/m
    double step_s;         // of --step; 0 where it was not given
    double at_step_s;      // of --at-step, likewise
    const char *csv;
    const char *plot;
} MapOptions;

extern const Arguments MAP_ARGUMENTS;

// The settings that the options ask for. Fails with ERR_USAGE.
bool map_options_settings(const MapOptions *options, const Scenario *scenario,
                          MappingSettings *settings, Err *err);

// Makes the scenario of one pin at its wall from the options, with the same words and checks as a
// case file, and puts mass, speed and steps into the settings. Without --clearance the hole is as
// wide as the steps need. Fails with ERR_USAGE.
bool map_lone_make(const MapOptions *options, Scenario *scenario, MappingSettings *settings,
                   Err *err);
