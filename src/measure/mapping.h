// Which ERP, CFM and step for this joint, and what do they deliver: every joint with play, contact
// law, map and step, predicted, judged and measured.
#pragma once

#include "measure/constants.h"

enum {
    MAPPING_STEP_MAX = 32,
    MAPPING_LAW_MAX = LAW_COUNT + 1, // all of the family and the stiffness that a case gives
};

typedef struct MappingSettings {
    size_t step_count;
    double steps[MAPPING_STEP_MAX]; // s, the longest first
    size_t map_count;
    OdeMap maps[MAPPING_MAP_COUNT];
    size_t law_count; // 0: the case's own
    LawKind laws[MAPPING_LAW_MAX];
    MappingSource mass_source;
    MappingSource speed_source;
    bool is_held; // to its only step: the best constants there are wanted
    double mass;  // kg, where given
    double speed; // m/s, where given
} MappingSettings;

typedef struct Mapping {
    const Scenario *scenario; // of the case
    MappingSettings settings;
    size_t contact_count;
    MappingContact *contacts; // owned
    size_t row_count;
    MappingRow *rows; // owned
} Mapping;

// Who watches: of the world steps that all rows make, before the first of them, and before each row
// of what has been done and what there is to do.
typedef struct MappingWatch {
    void (*plan)(double steps, void *context);             // may be NULL
    void (*row)(size_t done, size_t total, void *context); // may be NULL
    RunWatch run;                                          // of the reference
    void *context;
} MappingWatch;

// Works it all out. Fails with ERR_CASE where no joint has play, with ERR_USAGE where mass or speed
// are neither given nor to be had from a run, with ERR_SOLVER where the reference fails or where no
// law has such an impact: one joint or law of several that has none says so and hides no other. A
// row that could not be run says so too and is no failure. mapping_finish accepts a zeroed mapping.
bool mapping_make(const Scenario *scenario, const MappingSettings *settings, MappingWatch watch,
                  Mapping *mapping, Err *err);
void mapping_finish(Mapping *mapping);
