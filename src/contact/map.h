// From stiffness, damping and step to ODE's ERP and CFM, back, and what they will deliver.
//
// One contact row of ODE, with F >= 0: v_out + CFM F = (ERP / h) d, v_out the separating speed
// after the step; positions then move with the new speed.
#pragma once

#include "model/options.h"

typedef struct ErpCfm {
    double erp;  // 1; ODE does not clamp a contact's soft_erp, so it may exceed 1
    double cfm;  // m/(N s)
    double rest; // 1: 1 - erp, with the digits that are lost where erp rounds to 1
} ErpCfm;

// The row of an ERP and a CFM that come from elsewhere: what 1 - erp has lost is lost.
ErpCfm map_row(double erp, double cfm);

// A contact as the map finds it at the start of a step. Not every map looks at all of it.
typedef struct MapContact {
    double stiffness; // k, N/m: force over depth
    double damping;   // c, N s/m; it or the stiffness must be > 0
    double step;      // h, s
    double mass;      // m, kg: effective along the normal
    double depth;     // d, m, > 0
    double closing;   // m/s, rate of the depth before the step
} MapContact;

typedef struct Map {
    double stability_limit; // 1: omega h must stay below it; infinite where it always holds
    double stand_in_share;  // 1: of h k, the damper that stands in for none; 0 for no need
    bool needs_mass;        // whether it looks at the effective mass
    ErpCfm (*convert)(const MapContact *contact);
    // Fills in the stiffness and damping of a contact whose row this is; what else the map looks at
    // is given. Returns false, the contact untouched, where no spring k >= 0 and damper c >= 0 make
    // that row. Relative to the larger of what they are and what the map takes them from, right to
    // rounding; docs/mapping.md says where that is not enough.
    bool (*invert)(ErpCfm row, MapContact *contact);
} Map;

// Whether a spring and damper at a step are such: no number below 0, not both 0, and finite.
bool map_contact_is_sound(const MapContact *contact);

// Of every map but ODE_MAP_IMPULSE, which makes no rows.
const Map *map_get(OdeMap kind);

// The CFM, m/(N s), of the velocity-level penalty F = p d', p in N s/m > 0, may be infinite.
double map_poisson_cfm(double penalty);

// The restitution that ODE's bounce delivers beside a CFM: (e - r) / (1 + r), r = CFM m / h, from
// the one asked for, the effective mass, kg, and the step, s. Negative: the row lets the body in.
double map_bounce_delivered(double restitution, double cfm, double mass, double step);
