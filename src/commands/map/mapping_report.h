// Everything there is to tell about a mapping: plain pointers, nothing owned.
#pragma once

#include "commands/map/penalty_map.h"
#include "measure/mapping.h"

#include <stdio.h>
#include <string.h>

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
static inline const Joint *mapping_report_joint(const MappingReport *report,
                                                const MappingContact *contact)
{
    return &report->scenario->linkage.joints[contact->joint.joint];
}

// What a row's map is called; POISSON rows have none.
static inline const char *mapping_report_map(const MappingReport *report, const MappingRow *row)
{
    return mapping_report_is_poisson(report) ? "poisson" : OPTIONS_ODE_MAPS[row->map];
}

// The law of a contact for people: a stiffness that the case gives shows its value.
static inline void mapping_report_law(const MappingContact *contact,
                                      char law[MAPPING_REPORT_LAW_SIZE])
{
    const ForceLaw *built = &contact->impact.law;
    if (strcmp(contact->law_name, "stiffness") == 0) {
        snprintf(law, MAPPING_REPORT_LAW_SIZE, "K = %.4g N/m^%.3g", built->stiffness,
                 built->exponent);
    } else {
        snprintf(law, MAPPING_REPORT_LAW_SIZE, "%s", contact->law_name);
    }
}
