// Everything there is to say about a mapping, and the forms in which it is said.
#pragma once

#include "commands/map/penalty_map.h"
#include "measure/mapping.h"
#include "write/fields.h"
#include "write/joint_units.h"

enum { MAPPING_REPORT_LAW_SIZE = 64 };

typedef struct MappingReport {
    const Scenario *scenario;
    const Mapping *mapping;
    const PenaltyMap *penalty; // NULL: not asked for
} MappingReport;

// Whether rows are those of the velocity-level model, which has no law and no maps.
static inline bool mapping_report_is_poisson(const MappingReport *report)
{
    return report->scenario->contact.model == CONTACT_POISSON;
}

// The joint of a contact.
static inline const Joint *mapping_report_joint(const MappingContact *contact)
{
    return &contact->scenario.linkage.joints[contact->joint.joint];
}

// The units of a contact.
static inline const JointUnits *mapping_report_units(const MappingContact *contact)
{
    return joint_units(mapping_report_joint(contact));
}

// The law of a contact for people: a stiffness that the case gives shows its value.
void mapping_report_law(const MappingContact *contact, char law[MAPPING_REPORT_LAW_SIZE]);

// The forms, each of a MappingReport. The CSV is a file of its own, a row a joint, law, map and
// step: ERR_FILE.
void mapping_text_write(const void *report, const Style *style, Text *text);
bool mapping_rows_write_csv(const void *report, const char *path, Err *err);
void mapping_plot_write(const void *report, Text *svg);
json_t *mapping_json_build(const void *report);

// New reference.
json_t *mapping_penalty_json(const PenaltyMap *map);

// Appends a row's map and step, blank where the map is that of the row above.
void mapping_rows_begin(const MappingRow *rows, size_t index, Table *table);

// Parts of the text: the settings of a contact with their verdicts, what is wrong with those that
// are not valid, and what they deliver; the best constants; the paper's penalty.
void mapping_rows_write_table(const MappingRow *rows, size_t count, const Style *style, Text *text);
void mapping_settings_text_write(const MappingReport *report, const MappingContact *contact,
                                 const Style *style, Text *text);
void mapping_held_text(const MappingContact *contact, const Style *style, Text *text);
void mapping_penalty_text_write(const PenaltyMap *map, const Style *style, Text *text);

// The fields of ImpactDelivered, and of the MapImpact that is asked for.
extern const Field DELIVERED_FIELDS[];
extern const Field ASKED_FIELDS[];
