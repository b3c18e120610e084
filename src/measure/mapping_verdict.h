// Is a setting right, what is wrong with it, and what would be right?
#pragma once

#include "measure/mapping_contact.h"

// What an impact may be off by, of what the law asks, for a setting to be called valid.
extern const double MAPPING_VALID_SHARE;

typedef enum VerdictKind {
    VERDICT_VALID,
    VERDICT_TOO_FINE,     // more steps than are tried
    VERDICT_PAST_END,     // the pin goes past the end of the law
    VERDICT_UNSTABLE,     // omega h beyond the map's limit: rows fall back to the textbook's
    VERDICT_STICKS,       // the contact does not end
    VERDICT_TOO_COARSE,   // fewer steps than a contact can be seen in
    VERDICT_GAINS,        // more speed after the impact than before it
    VERDICT_OVER_DAMPED,  // less restitution than asked for
    VERDICT_UNDER_DAMPED, // more
    VERDICT_PEAK,         // another peak force
    VERDICT_DEPTH,        // another depth
    VERDICT_SCATTERS,     // right in the mean, but not wherever the steps fall
    VERDICT_COUNT,
} VerdictKind;

extern const char *const VERDICT_NAMES[VERDICT_COUNT]; // one word each

enum { VERDICT_TEXT_SIZE = 192 };

typedef struct MappingRow {
    const MappingContact *contact;
    OdeMap map;
    const char *map_name; // "poisson" of CONTACT_POISSON, which has no map
    OdeStepping stepping;
    double step_s;
    ErpCfm soft;            // of the row at the law's deepest point; NAN of ODE_MAP_IMPULSE
    double stability_limit; // 1, of omega h; NAN where there is none, as the next two
    double steps_a_contact; // 1, Tc / h
    double omega_h;         // 1, at the deepest point
    ImpactFigures predicted;
    VerdictKind verdict;           // from the prediction
    char words[VERDICT_TEXT_SIZE]; // with advice where it is not valid
    ImpactDelivered delivered;
} MappingRow;

// What figures, predicted or delivered, are to be called beside what the law asks.
VerdictKind verdict_judge(const MappingContact *contact, OdeMap map, double step_s,
                          const ImpactFigures *figures);

// Fills in the contact's longest valid steps, found by trying predictions.
void verdict_find_steps(MappingContact *contact);

// Words for a row whose prediction and verdict stand in it.
void verdict_describe(const MappingContact *contact, MappingRow *row);

// Of CONTACT_POISSON: the smallest penalty, N s/m, that is valid at a step, s.
double verdict_least_penalty(const MappingContact *contact, double step_s);
