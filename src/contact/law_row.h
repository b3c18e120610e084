// The row that a step makes of a contact by its law, for whichever world: a case's or a caller's.
// What differs between these is who knows the mass.
#pragma once

#include "contact/map.h"
#include "kernel/force_law.h"

// A contact as a step finds it. Of an angle torques and inertias are meant.
typedef struct LawRow {
    double depth;        // m, > 0
    double closing;      // m/s, rate of the depth before the step
    double impact_speed; // m/s, with which the contact began
    double share;        // 1, of the step in which it overlaps
    double mass;         // kg, effective; of maps that need it
} LawRow;

// Its secant spring, and its damper, which acts for its share of the step.
MapContact law_row_contact(const ForceLaw *law, const LawRow *row, double step_s);

// Whether the step is within a map's limit for a slope of the law over a mass, 1/s^2.
bool law_row_is_stable(const Map *map, double slope_by_mass, double step_s);

// The row by a map, or by the textbook's where that is beyond its limit.
ErpCfm law_row_soft(const Map *map, bool falls_back, const MapContact *contact);
