// Everything there is to tell about a comparison: plain pointers, nothing owned.
#pragma once

#include "measure/ladder.h"

typedef struct CompareReport {
    const Scenario *scenario;
    const Ladder *ladder; // concluded
    const char *machine;  // the processor that the times are of
} CompareReport;

// Whether the errors contain more than ODE's own: the reference knows contact by its elastic law
// alone.
static inline bool compare_report_mixes_models(const CompareReport *report)
{
    return report->scenario->contact.model == CONTACT_POISSON &&
           scenario_has_clearance(report->scenario);
}
